"""The band of the effective width: other widths are run, and told beside the run."""

from dataclasses import replace

import numpy as np
import pytest

from rockshed.analyses.shed import band as analysis
from rockshed.core.errors import InputRefused
from rockshed.metrics import comparison, names
from rockshed.metrics.headlines import headlines
from rockshed.metrics.width_band import width_band_table
from rockshed.reports.of_run import _effective_width
from rockshed.runs import batch
from rockshed.runs.batch import COLUMNS, COMPLETE, FAILED, Outcome, Task, slim
from rockshed.runs.building import silent
from rockshed.runs.request import Request
from rockshed.runs.run import Run
from tests.unit.test_headlines import made_up

DESIGN = {
    "rock": {"radius": 0.5},
    "cushion": {"thickness": 1.0, "effective_width": 2.0},
    "roof": {"kind": "girders", "spacing": 2.0},
}


def run_of(design):
    made = made_up()
    return Run(**{**vars(made), "provenance": {**made.provenance, "design": design}})


def carried_out(tasks, **options):
    """Outcomes whose peak force is proportional to the width."""
    widths = {task.key: task.request.values[analysis.FIELD] for task in tasks}
    return {
        key: Outcome(key, COMPLETE, metrics={names.PEAK_ROCK: 1e3 * width})
        for key, width in widths.items()
    }


def test_a_project_is_run_with_the_smallest_and_the_largest_width(monkeypatch):
    asked = []
    monkeypatch.setattr(
        analysis, "run_all", lambda tasks, **o: (asked.extend(tasks), carried_out(tasks))[1]
    )
    request = Request("shed.toml", {"cushion.thickness": "1 m"}, in_process=True)
    found = analysis.width_band(run_of(DESIGN), request)
    assert {name: entry["width"] for name, entry in found.items()} == pytest.approx(
        {"low": 1.65, "run": 2.0, "high": 3.0}
    )
    assert found["high"]["metrics"] == {names.PEAK_ROCK: 3e3}
    assert {metric.name for metric in headlines(made_up())} <= set(found["run"]["metrics"])
    assert all(task.request.values["cushion.thickness"] == "1 m" for task in asked)
    assert not any(task.request.in_process for task in asked)
    assert {"sand.*", "rock.*", "beam.*"} == set(asked[0].columns)


def test_the_other_widths_record_what_the_run_has_recorded(monkeypatch):
    asked = []
    monkeypatch.setattr(
        analysis, "run_all", lambda tasks, **o: (asked.extend(tasks), carried_out(tasks))[1]
    )
    run = run_of(DESIGN)
    run.provenance["system"] = {**run.provenance["system"], "record": ["beam.*", "rock.x"]}
    analysis.width_band(run, Request("shed.toml"))
    assert asked[0].columns == ("beam.*", "rock.x")


def test_a_width_of_the_run_itself_is_not_run_again(monkeypatch):
    asked = []
    monkeypatch.setattr(
        analysis, "run_all", lambda tasks, **o: (asked.extend(tasks), carried_out(tasks))[1]
    )
    design = {**DESIGN, "cushion": {"thickness": 1.0, "effective_width": 3.0}}
    found = analysis.width_band(run_of(design), Request("shed.toml"))
    assert len(asked) == 1
    assert found["high"] == found["run"]


def test_the_band_is_a_table_of_all_headlines_and_utilisations():
    """Every number of the run's own table, in the first of its units."""
    roof = {"criteria": [{"name": "deflection", "limit": 0.01, "unit": "m"}]}
    bent = made_up(**{"beam.midspan.deflection": np.linspace(0.0, 0.02, 401)})
    run = replace(bent, provenance={**bent.provenance, "design": roof})
    values = {metric.name: metric.value for metric in headlines(run)}
    entry = {"width": 2.0, "metrics": values}
    doubled = {name: 2.0 * value for name, value in values.items()}
    band = {"high": {"width": 3.0, "metrics": doubled}, "run": entry}
    run.provenance["band"] = {**band, "low": {"width": 1.5, "metrics": {}}}
    rows = {row["quantity"]: row for row in width_band_table(run)}
    deflection = rows["peak midspan deflection"]
    assert list(deflection)[2:] == ["1.50 m", "2.00 m (this run)", "3.00 m"]
    own, high = (float(deflection[title]) for title in list(deflection)[3:])
    assert high == pytest.approx(2.0 * own, rel=1e-2)
    assert deflection["1.50 m"] == ""
    own_table = [row.label for row in comparison.rows(run, {}) if row.label]
    full = [name for name in own_table if not name.startswith((" ", "coupling"))]
    assert {"peak force on the rock", "utilisation: deflection", *full} <= set(rows)
    assert len(rows) == len(own_table) - sum(name.startswith("coupling") for name in own_table)
    (chapter,) = _effective_width(run)
    assert len(chapter.tables[0]) == len(rows)
    assert len(width_band_table(made_up())) == 0
    assert list(_effective_width(made_up())) == []


def test_a_run_of_a_batch_is_compared_with_its_own_design():
    """The plastic moment of a wider strip is that of more girders."""
    project = {
        "rock": {"mass": 400.0, "drop_height": 8.0},
        "cushion": {"thickness": 0.5},
        "roof": {"section": "H-200x200x8x12", "span": 3.0, "spacing": 1.0},
    }
    limits = []
    for width in (1.0, 2.0):
        request = Request("project", {analysis.FIELD: width}, project=project, in_process=True)
        order = batch._order(Task(request), silent)
        limits.append(
            {entry["name"]: entry["limit"] for entry in order.facts["design"]["criteria"]}
        )
    assert limits[1]["plastic moment"] == pytest.approx(2.0 * limits[0]["plastic moment"])


def test_a_run_without_a_design_has_no_band():
    with pytest.raises(InputRefused, match="no run of a project"):
        analysis.width_band(run_of({}), Request("girders-8"))


def test_a_width_that_has_no_result_is_told(monkeypatch):
    def lost(tasks, **options):
        return {task.key: Outcome(task.key, FAILED, "the sand left the box") for task in tasks}

    monkeypatch.setattr(analysis, "run_all", lost)
    with pytest.raises(InputRefused, match="the sand left the box"):
        analysis.width_band(run_of(DESIGN), Request("shed.toml"))


def test_a_task_records_the_columns_of_studies_unless_it_names_others():
    assert Task(Request("lab-impact")).columns == COLUMNS
    assert slim.__defaults__ == (COLUMNS,)

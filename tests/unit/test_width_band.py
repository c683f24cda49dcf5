"""The band of the effective width: other widths are run, and told beside the run."""

from dataclasses import replace

import pytest

from rockshed.analyses.shed import band as analysis
from rockshed.core.errors import InputRefused
from rockshed.metrics import names
from rockshed.metrics.width_band import width_band_table
from rockshed.reports.of_run import _effective_width
from rockshed.runs.batch import COLUMNS, COMPLETE, FAILED, Outcome, Task, slim
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
    assert all(task.request.values["cushion.thickness"] == "1 m" for task in asked)
    assert not any(task.request.in_process for task in asked)
    assert "beam.moment[*]" in asked[0].columns


def test_a_width_of_the_run_itself_is_not_run_again(monkeypatch):
    asked = []
    monkeypatch.setattr(
        analysis, "run_all", lambda tasks, **o: (asked.extend(tasks), carried_out(tasks))[1]
    )
    design = {**DESIGN, "cushion": {"thickness": 1.0, "effective_width": 3.0}}
    found = analysis.width_band(run_of(design), Request("shed.toml"))
    assert len(asked) == 1
    assert found["high"] == found["run"]


def test_the_band_is_a_table_of_the_headlines():
    entry = {"width": 2.0, "metrics": {names.PEAK_ROCK: 1.5e6}}
    facts = {
        "band": {"low": {**entry, "width": 1.5}, "run": entry, "high": {**entry, "width": 3.0}}
    }
    run = replace(made_up(), provenance={**made_up().provenance, **facts})
    (row,) = width_band_table(run)
    assert row == {
        "quantity": names.PEAK_ROCK,
        "unit": "kN",
        "1.50 m": "1,500",
        "2.00 m (this run)": "1,500",
        "3.00 m": "1,500",
    }
    (chapter,) = _effective_width(run)
    assert len(chapter.tables[0]) == 1
    assert len(width_band_table(made_up())) == 0
    assert list(_effective_width(made_up())) == []


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

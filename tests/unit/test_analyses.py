"""Analyses from Python: objects with tables, metrics and figures, and nothing printed."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rockshed
from rockshed.analyses.pile.run import pile
from rockshed.analyses.rockfall.run import rockfall
from rockshed.core.errors import InputRefused
from rockshed.sites.rockfall.site import SlopeSite
from rockshed.sites.source import site_source

EXAMPLES = Path(rockshed.__file__).parent / "examples"
SLOPE = {
    "name": "bank",
    "rock": {"radius": 0.5, "density": 2600},
    "start": {"x": 1.0},
    "limit_speed": {"mean": 12.0, "deviation": 2.0},
    "profile": {"points": [(0, 40, "rock"), (30, 10, "soil"), (60, 5)]},
    "line": [{"name": "road", "x": 40.0}],
}
ROD = {
    "name": "rod",
    "segments": 10,
    "hammer": {"mass": 63.5, "drop": 0.75},
    "rod": [{"length": 10.0, "area": 5.8e-4, "modulus": 2.06e11, "density": 7850.0}],
    "toe": {"resistance": 20e3},
    "bearing": {"resistances": [10e3, 40e3]},
}


@pytest.fixture(scope="module")
def campaign():
    return rockfall(SLOPE, trials=100)


@pytest.fixture(scope="module")
def blows():
    return pile(ROD)


@pytest.fixture(params=["campaign", "blows"])
def result(request):
    return request.getfixturevalue(request.param)


def test_nothing_is_printed_or_written(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    rockfall(SLOPE, trials=10)
    pile(ROD)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_a_site_may_be_a_file_a_mapping_or_data(campaign):
    same = rockfall(SlopeSite.model_validate(SLOPE), trials=100)
    np.testing.assert_array_equal(same.records.outcomes, campaign.records.outcomes)
    file = rockfall(str(EXAMPLES / "slope.toml"), trials=10, seed=2)
    assert (file.name, file.campaign.seed) == ("slope", 2)


def test_what_is_wrong_with_a_mapping_is_told_by_its_keys():
    with pytest.raises(InputRefused) as refusal:
        rockfall({**SLOPE, "rock": {"radius": -1, "density": 2600}, "lines": []})
    assert [str(problem) for problem in refusal.value.problems] == [
        "site: rock.radius: must be greater than 0 (given: -1)",
        "site: lines: there is no such key; did you mean line?",
    ]


def test_metrics_have_identifiers_and_units(campaign, blows):
    assert campaign.metrics["trials"].value == 100
    assert campaign.metrics["line_road_energy_p50"].unit == "J"
    assert blows.metrics["blow_1_set"].value > 0.0
    assert blows.metrics["bearing_10000_set"].value > blows.metrics["bearing_40000_set"].value
    with pytest.raises(KeyError, match=r"did you mean .*line_road_energy_p50"):
        campaign.metrics["line_road_energy_p5"]


def test_tables_figures_and_notes(result):
    assert all(len(table) for table in result.tables())
    figures = result.figures()
    assert set(figures) >= {"envelopes"}
    assert all(isinstance(figure, Figure) for figure in figures.values())
    assert result.notes
    assert result.status == "complete"
    assert all(isinstance(text, str) for text in result.warnings)


def test_the_main_table_carries_units(campaign, blows):
    assert campaign.to_arrow().num_rows == 100
    assert campaign.to_arrow().schema.field("road.energy").metadata[b"unit"] == b"J"
    assert blows.to_arrow().schema.field("head.zv").metadata[b"unit"] == b"N"


def test_pandas_has_the_main_table_too(campaign):
    pytest.importorskip("pandas")
    frame = campaign.to_pandas()
    assert len(frame) == 100
    assert frame.attrs["units"]["road.energy"] == "J"


def test_reprs_are_short_and_for_notebooks(campaign, blows):
    assert repr(campaign).startswith("<RockfallResult bank: 100 trials, ")
    assert repr(blows).startswith("<PileResult rod: 1 blow, penetration ")
    assert "<table>" in campaign._repr_html_()


def test_a_result_is_saved_later_or_at_once(result, tmp_path):
    seen = []
    folder = result.save(tmp_path / "later", progress=lambda *stage: seen.append(stage))
    assert result.folder == folder
    assert json.loads((folder / "run.json").read_text())["kind"] == result.kind
    assert {file.stem for file in result.pictures} == set(result.figures())
    assert all(file.is_file() for file in (*result.files, *result.pictures))
    assert seen[-1] == ("drawing", len(result.pictures), len(result.pictures))
    assert f", in {folder}" in repr(result)


def test_a_folder_asked_for_is_written_without_pictures(tmp_path):
    seen = []
    folder = tmp_path / "out"
    made = rockfall(SLOPE, trials=10, folder=folder, progress=lambda *stage: seen.append(stage))
    assert (made.folder, made.pictures) == (folder, [])
    assert not (folder / "figures").exists()
    assert seen == [("trials", 0, 10), ("trials", 10, 10)]
    with pytest.raises(InputRefused, match=r"cannot be written|no folder of a run"):
        rockfall(SLOPE, trials=10, folder=tmp_path)


def test_a_trial_replays_and_others_do_not(campaign):
    assert campaign.replay(3).end in campaign.ends
    with pytest.raises(InputRefused, match="choose one from 0 to 99"):
        campaign.replay(100)


def test_a_site_without_a_name_has_that_of_its_file(tmp_path):
    text = (EXAMPLES / "spt.toml").read_text(encoding="utf-8").replace('name = "spt"', "")
    (tmp_path / "rod.toml").write_text(text, encoding="utf-8")
    assert site_source(tmp_path / "rod.toml").name == "rod"
    assert site_source({}).name == "site"

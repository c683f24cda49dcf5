"""Drivability, limits, formulas and the last blow of a bearing graph, as a user meets them."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.saved import saved_result
from rockshed.commands.app import app

SITE = {
    "name": "short",
    "blows": 2,
    "segments": 30,
    "time": 0.08,
    "hammer": {"mass": 3000.0, "drop": 1.0, "efficiency": 0.8, "rate": 0.5},
    "cushion": {"material": "oak", "thickness": 0.2, "area": 0.16},
    "helmet": {"mass": 400.0},
    "pile_cushion": {"material": "fir plywood", "thickness": 0.1, "area": 0.12},
    "rod": [{"length": 12.0, "width": 0.35, "modulus": 3.6e10, "density": 2400.0}],
    "ground": {
        "penetration": 9.0,
        "layers": [
            {"soil": "mud", "to": 4.0},
            {"soil": "sand", "to": 9.5},
            {"soil": "rock", "to": 12.0},
        ],
    },
    "soil": {
        "mud": {"friction": 2e3, "toe": 2e4},
        "sand": {"friction": 20e3, "friction_growth": 4e3, "toe": 3e6},
        "rock": {"friction": 60e3, "toe": 1e8},
    },
    "bearing": {"resistances": [4e5, 8e5, 1.2e6, 8e6]},
    "drivability": {"penetrations": [2.0, 5.0, 7.0, 9.0, 11.0], "per": 0.3},
    "limits": {"compression": 5e6},
}


@pytest.fixture(scope="module")
def result():
    return rockshed.pile(SITE)


def test_a_pile_sinks_in_mud_is_driven_in_sand_and_stops_on_rock(result):
    sinks, *driven, stuck = result.stages
    assert sinks.blow is None
    assert sinks.count == 0.0
    counts = [stage.count for stage in driven]
    assert counts == sorted(counts)
    assert stuck.count is None
    assert stuck.driven is None
    assert any("not driven on with the toe at 11 m" in text for text in result.warnings)


def test_blows_and_time_are_the_area_under_the_blow_counts(result):
    depths = np.array([stage.penetration for stage in result.stages[:-1]])
    density = np.array([stage.count / 0.3 for stage in result.stages[:-1]])
    assert result.stages[-2].driven == pytest.approx(np.trapezoid(density, depths))
    assert result.stages[-2].time == pytest.approx(2.0 * np.trapezoid(density, depths))


def test_a_penetration_has_the_blows_of_a_pile_that_stands_there(result):
    there = {**SITE, "ground": {**SITE["ground"], "penetration": 7.0}}
    there = {key: value for key, value in there.items() if key not in ("bearing", "drivability")}
    blows = rockshed.pile(there).blows
    assert result.stages[2].blow.set == blows[-1].set
    assert result.stages[2].blow.compression.max() == blows[-1].compression.max()


def test_stresses_above_a_limit_are_told_with_place_and_blow(result):
    (text, deeper) = [text for text in result.warnings if "exceeds the limit of 5 MPa" in text]
    assert text.startswith("compression of ")
    assert "with blow " in text
    assert "m below the head" in text
    assert "with a toe at " in deeper


def test_the_account_closes_with_helmet_and_cushions(result):
    assert max(abs(blow.unbalanced) / blow.impact_energy for blow in result.every_blow) < 1e-6


def test_the_last_blow_of_the_graph_is_that_of_the_pile_itself(result):
    """For the resistance that the soil has, the second blow of the graph is the pile's own."""
    own = {**SITE, "bearing": {"resistances": [result.pile.resistance, 2e6]}}
    own.pop("drivability")
    again = rockshed.pile(own)
    assert again.graph[0].last.set == pytest.approx(again.blows[1].set, rel=1e-9)
    assert again.graph[0].first.set == pytest.approx(again.blows[0].set, rel=1e-9)
    assert again.graph[0].first.set != again.graph[0].last.set


def test_formulas_stand_beside_the_graph(result):
    (table,) = [table for table in result.tables() if table.title.startswith("dynamic formulas")]
    assert [row["R_u (kN)"] for row in table] == ["400", "800", "1200", "8000"]
    assert all(float(row["Hiley (kN)"]) > 0.0 for row in table)
    assert "FHWA" in table.notes[1]


def test_files_and_pictures_have_all_of_it_and_are_read_again(tmp_path):
    short = {**SITE, "blows": 1, "bearing": {"resistances": [4e5, 8e6]}}
    short["drivability"] = {"penetrations": [2.0, 9.0]}
    result = rockshed.pile(short, folder=tmp_path / "made", pictures=True)
    table = pyarrow.parquet.read_table(tmp_path / "made" / "drivability.parquet")
    assert table["penetration"].to_pylist() == [2.0, 9.0]
    assert table["set"].to_pylist()[0] is None
    assert table.schema.field("time").metadata[b"unit"] == b"s"
    assert {file.name for file in result.pictures} >= {"drivability.png", "bearing.png"}
    again = saved_result(tmp_path / "made")
    assert again.stages[1].blow.set == result.stages[1].blow.set


def test_the_table_names_refusal_and_own_weight(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "250")
    text = (Path(rockshed.__file__).parent / "examples" / "pile_ground.toml").read_text("utf-8")
    text = text.replace("blows = 2", "blows = 1").partition("[bearing]")[0]
    text += '[drivability]\npenetrations = ["2 m", "12 m"]\n'
    Path("ground.toml").write_text(text, "utf-8")
    shown = CliRunner().invoke(app, ["pile", "ground.toml", "--quiet", "--no-figures"])
    assert shown.exit_code == 0, shown.output
    assert "own weight" in shown.output
    assert "the source of its values could not be read" in shown.output.replace("\n", " ")
    as_json = CliRunner().invoke(app, ["pile", "ground.toml", "--quiet", "--json", "--no-figures"])
    names = {metric["name"] for metric in json.loads(as_json.stdout)["metrics"]}
    assert "drivability.12.blows_per_way" in names

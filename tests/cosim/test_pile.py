"""``rockshed pile`` as a user meets it, and what is behind it."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from PIL import Image
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.pile.blows import bearing_graph, drive
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.sites.pile.preparation import prepare

EXAMPLES = Path(rockshed.__file__).parent / "examples"
SPT = (EXAMPLES / "spt.toml").read_text(encoding="utf-8")


@pytest.fixture
def site(tmp_path):
    """Write a site and prepare it."""

    def prepared(text, *replaced):
        for old, new in replaced:
            assert old in text
            text = text.replace(old, new)
        file = tmp_path / "site.toml"
        file.write_text(text, encoding="utf-8")
        return prepare(file)

    return prepared


@pytest.fixture(scope="module")
def spt():
    return prepare(EXAMPLES / "spt.toml")


@pytest.fixture(scope="module")
def graph(spt):
    return [point.first for point in bearing_graph(spt)]


def test_the_bearing_graph_of_the_spt_rod_is_monotone_and_its_energy_closed(graph):
    assert [blow.resistance for blow in graph][::12] == [5e3, 60e3]
    assert all(one.count < other.count for one, other in pairwise(graph))
    assert all(one.compression.max() <= other.compression.max() for one, other in pairwise(graph))
    assert max(abs(blow.unbalanced) / blow.impact_energy for blow in graph) < 1e-3


def test_the_set_is_about_the_energy_over_the_resistance_for_soft_ground(spt, graph):
    """Of 5 kN: the ram's energy and the weights' way go into R (s + Q/2), the damping and the rod take the rest."""
    soft = graph[0]
    most = (
        soft.impact_energy + (63.5 + 10.24 * 5.8e-4 * 7850.0) * 9.80665 * soft.set
    ) / soft.resistance
    assert 0.35 * most < soft.set < most


def test_the_first_force_at_the_head_is_impedance_times_velocity(spt, graph):
    velocity = np.sqrt(2.0 * 9.80665 * 0.75)
    assert graph[0].head_force == pytest.approx(5.8e-4 * 7850.0 * 5120.0 * velocity, rel=0.01)


@pytest.mark.slow
def test_more_segments_hardly_change_the_set(site, graph):
    fine = site(
        SPT, ("segments = 100", "segments = 400"), ("[5e3, 7.5e3, 10e3, 15e3, 20e3", "[20e3")
    )
    assert bearing_graph(fine)[0].first.set == pytest.approx(graph[4].set, rel=0.01)


def test_several_blows_leave_residual_forces_that_settle():
    made = prepare(EXAMPLES / "pile.toml")
    blows = drive(made)
    assert len(blows) == 5
    assert (
        blows[0].set < blows[1].set
    )  # the locked-in force at the toe spares the second blow a part of the quake
    assert blows[4].set == pytest.approx(blows[3].set, rel=1e-3)
    assert blows[-1].residual.max() > 1e5
    assert np.all(blows[-1].residual[24:110] > 0.0)  # the shaft holds the rod down against the toe
    assert all(abs(blow.unbalanced) < 1e-9 * blow.impact_energy for blow in blows)
    assert sum(made.soil()["shaft.resistance"]) == pytest.approx(700e3, rel=1e-9)


def test_the_command_writes_tables_files_and_pictures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    text = SPT.replace(
        "5e3, 7.5e3, 10e3, 15e3, 20e3, 25e3, 30e3, 35e3, 40e3, 45e3, 50e3, 55e3, 60e3", "10e3, 40e3"
    )
    Path("short.toml").write_text(text, encoding="utf-8")
    shown = CliRunner().invoke(app, ["pile", "short.toml", "--quiet"])
    assert shown.exit_code == 0, shown.output
    assert "bearing graph" in shown.output
    assert "energy balance closed to" in shown.output
    folder = tmp_path / "results" / "spt"
    assert {file.name for file in folder.iterdir()} == {
        "run.json",
        "summary.json",
        "traces.parquet",
        "traces.csv",
        "envelopes.parquet",
        "envelopes.csv",
        "bearing.parquet",
        "bearing.csv",
        "figures",
    }
    assert {file.name for file in (folder / "figures").iterdir()} == {
        "traces.png",
        "envelopes.png",
        "bearing.png",
    }
    for file in (folder / "figures").iterdir():
        assert len(np.unique(np.asarray(Image.open(file).convert("L")))) > 20
    table = pyarrow.parquet.read_table(folder / "traces.parquet")
    assert table.schema.field("head.zv").metadata[b"unit"] == b"N"
    assert json.loads((folder / "run.json").read_text())["site"]["hammer"]["mass"] == 63.5
    as_json = CliRunner().invoke(
        app, ["pile", "short.toml", "--quiet", "--json", "--no-figures", "--blows", "2"]
    )
    metrics = {metric["name"]: metric["value"] for metric in json.loads(as_json.stdout)["metrics"]}
    assert metrics["blows"] == 2
    assert metrics["bearing.10000.set"] > metrics["bearing.40000.set"]
    assert metrics["blow.1.energy_ratio"] == pytest.approx(1.0, abs=0.03)


def test_residual_forces_are_those_of_a_rod_at_rest(site):
    text = (EXAMPLES / "pile.toml").read_text(encoding="utf-8").replace("blows = 5", "blows = 1")
    (short,) = drive(site(text, ("time = 0.25", "time = 0.1")))
    (longer,) = drive(site(text, ("time = 0.25", "time = 0.2")))
    assert short.residual == pytest.approx(longer.residual, abs=1e-4 * longer.residual.max())
    assert short.residual[0] == pytest.approx(
        0.0, abs=0.02 * short.residual.max()
    )  # nothing presses on the head


# --- refusals ---

SHAFT = "damping = 0.5\n[[shaft]]\nfrom = 5\nto = {to}\nresistance = 1e3"


@pytest.mark.parametrize(
    ("replaced", "place", "words"),
    [
        (("quake = 2.5e-3", "quake = 0"), "quake = 0", "toe.quake: must be greater than 0"),
        (
            ("gravity = 9.80665", "time = 1e-3"),
            "time = 1e-3",
            "0.001 s is too short for a blow: a wave needs 0.002 s from head to toe",
        ),
        (
            ("quake = 2.5e-3", "quake = true"),
            "quake = true",
            "toe.quake: must be a number (given: true)",
        ),
        (
            ("quake = 2.5e-3", 'quake = "two"'),
            'quake = "two"',
            "toe.quake: must be a number, with a unit or in m (given: 'two')",
        ),
        (
            ("area = 5.8e-4", "area = -1"),
            "area = -1",
            "rod[1].area: must be greater than 0",
        ),
        (("density = 7850.0", "density = 0"), "density = 0", "rod[1].density"),
        (
            ("segments = 100", "segments = 0"),
            "segments = 0",
            "segments: must be greater than or equal to 1",
        ),
        (
            ("resistance = 20e3", "resistance = nan"),
            "resistance = nan",
            "toe.resistance: must be a finite number",
        ),
        (
            ("resistance = 20e3", "resistance = -1"),
            "resistance = -1",
            "toe.resistance: must be greater than 0",
        ),
        (("resistance = 20e3", "resistance = 900"), "resistance = 900", "they sink without a blow"),
        (("drop = 0.75", "dropp = 0.75"), "dropp", "there is no such key"),
        (("damping = 0.5", SHAFT.format(to=11)), "to = 11", "below the toe, at 10.24 m"),
        (("damping = 0.5", SHAFT.format(to=4)), "[[shaft]]", "let it end below its beginning"),
        (("gravity = 9.80665", "time = 1e6"), "time = 1e6", "rows, and at most 2e+07 are kept"),
        (("gravity = 9.80665", "gauge = 11"), "gauge = 11", "the gauge at 11 m is below the toe"),
        (
            ("damping = 0.5", "damping = 0.5\n[cushion]\nstiffness = 1e8\nrestitution = 0.001"),
            "restitution",
            "cushion.restitution",
        ),
    ],
)
def test_refused_with_the_line(site, replaced, place, words):
    text = SPT.replace(*replaced)
    line = text.count("\n", 0, text.index(place)) + 1
    with pytest.raises(InputRefused) as refusal:
        site(text)
    problems = [str(problem) for problem in refusal.value.problems]
    assert any(f"line {line}," in text and words in text for text in problems), problems


def test_everything_wrong_is_told_at_once(site):
    with pytest.raises(InputRefused) as refusal:
        site(
            SPT,
            ("mass = 63.5", "mass = 0"),
            ("area = 5.8e-4", "area = -1"),
            ("quake = 2.5e-3", "quake = 0"),
        )
    assert len(refusal.value.problems) == 3

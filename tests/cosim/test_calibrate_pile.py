"""Wave matching: the soil of a computed blow is found again from its force and velocity, with noise."""

import json

import numpy as np
import pyarrow.parquet
import pytest
import tomli_w
from typer.testing import CliRunner

from rockshed.analyses.pile.blows import drive
from rockshed.analyses.pile_matching.run import match_pile
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.sites.pile.preparation import prepare

TRUE = {
    "shaft_1.resistance": 300e3,
    "shaft_2.resistance": 600e3,
    "shaft.quake": 3e-3,
    "shaft.damping": 0.25,
    "toe.resistance": 900e3,
    "toe.quake": 4e-3,
    "toe.damping": 0.6,
    "resistance": 1800e3,
}
PILE = {
    "segments": 45,
    "time": 0.05,
    "gravity": 0.0,
    "hammer": {"mass": 4000.0, "drop": 1.2, "efficiency": 0.8},
    "cushion": {"stiffness": 8e8, "restitution": 0.8},
    "rod": [{"length": 18.0, "width": 0.4, "modulus": 3.6e10, "density": 2450.0}],
}
SOIL = {"quake": 3e-3, "damping": 0.25}
SITE = {
    **PILE,
    "shaft": [
        {"from": 4.0, "to": 11.0, "resistance": 300e3, **SOIL},
        {"from": 11.0, "to": 18.0, "resistance": 600e3, **SOIL},
    ],
    "toe": {"resistance": 900e3, "quake": 4e-3, "damping": 0.6},
}
START = {
    **PILE,
    "shaft": [
        {"from": 4.0, "to": 11.0, "resistance": 500e3},
        {"from": 11.0, "to": 18.0, "resistance": 400e3},
    ],
    "toe": {"resistance": 500e3},
}


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """A computed blow with 1 % of noise as a file, and the site from which the search begins."""
    pile = prepare(SITE)
    (blow,) = drive(pile)
    traces = blow.traces
    velocity = traces["head.zv"] / pile.rod()["head.impedance"]
    noise = np.random.default_rng(3).normal(0.0, 0.01, (2, velocity.size))
    force = traces["head.contact_force"]
    columns = [
        1e3 * traces["time"],
        (force + noise[0] * force.max()) / 1e3,
        velocity + noise[1] * velocity.max(),
    ]
    folder = tmp_path_factory.mktemp("measured")
    title = "time (ms),force (kN),velocity (m/s)"
    np.savetxt(folder / "blow.csv", np.c_[*columns], delimiter=",", header=title, comments="")
    (folder / "start.toml").write_text(tomli_w.dumps(START), "utf-8")
    return folder


def test_the_soil_of_a_noisy_blow_is_found_within_its_intervals(measured, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = [str(measured / name) for name in ("blow.csv", "start.toml")]
    shown = CliRunner().invoke(app, ["calibrate", "pile", *files, "--json", "--quiet"])
    assert shown.exit_code == 0, shown.output
    found = {entry["name"]: entry["value"] for entry in json.loads(shown.stdout)["metrics"]}
    inside = 0
    for name, true in TRUE.items():
        assert found[name] == pytest.approx(true, rel=0.15), name
        inside += found[f"{name}.low"] <= true <= found[f"{name}.high"]
    assert inside >= len(TRUE) - 1
    assert found["departure"] < 0.02
    folder = tmp_path / "results" / "matching-blow"
    assert (folder / "figures" / "matching.png").stat().st_size > 10_000
    waves = pyarrow.parquet.read_table(folder / "waves.parquet")
    left = waves["measured.force"].to_numpy() - waves["computed.force"].to_numpy()
    assert np.sqrt(np.mean(left**2)) < 0.02 * waves["measured.force"].to_numpy().max()


def test_with_the_true_soil_the_computed_wave_is_the_measured_one(measured, tmp_path):
    """Without noise and with the same segments, the two computations are one to rounding."""
    from rockshed.analyses.pile_matching.measured import MeasuredBlow
    from rockshed.analyses.pile_matching.model import WaveModel

    pile = prepare(SITE)
    (blow,) = drive(pile)
    force = blow.traces["head.contact_force"]
    velocity = blow.traces["head.zv"] / pile.rod()["head.impedance"]
    made = MeasuredBlow("made", blow.traces["time"], force, velocity)
    model = WaveModel(pile, made)
    model.down = 0.5 * (force + blow.traces["head.zv"])
    up = model.wave(np.ones(len(model.sought)))
    expected = 0.5 * (force - blow.traces["head.zv"])
    np.testing.assert_allclose(up, expected, atol=1e-9 * force.max())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time (ms),force (kN)\n1,2\n", "must have the columns time, force and velocity"),
        ("time (ms),force (kg),velocity (m/s)\n1,2,3\n", "must be a force"),
        ("time (ms),force (kN),velocity (m/s)\n" + "1,2,3\n" * 60, "is not later than"),
        ("time (ms),force (kN),velocity (m/s)\n1,2,3\n", "has 1 rows"),
        ("time (ms),force (kN),velocity (m/s)\n1,two,3\n", "is no finite number"),
    ],
)
def test_a_wrong_measurement_is_refused_with_its_place_and_the_site_with_it(tmp_path, text, words):
    file = tmp_path / "blow.csv"
    file.write_text(text, "utf-8")
    site = {key: value for key, value in START.items() if key != "shaft"}
    with pytest.raises(InputRefused) as refusal:
        match_pile(file, site)
    told = [str(problem) for problem in refusal.value.problems]
    assert any(words in problem and "blow.csv" in problem for problem in told), told
    assert any("is not given in layers" in problem for problem in told)


def test_a_force_of_the_other_sign_and_a_short_time_are_refused(measured, tmp_path):
    rows = np.loadtxt(measured / "blow.csv", delimiter=",", skiprows=1)
    title = "time (ms),force (kN),velocity (m/s)"
    for name, changed in (("sign", rows * [1.0, -1.0, 1.0]), ("short", rows[:80])):
        np.savetxt(tmp_path / f"{name}.csv", changed, delimiter=",", header=title, comments="")
    with pytest.raises(InputRefused, match="is no compression"):
        match_pile(tmp_path / "sign.csv", START)
    with pytest.raises(InputRefused, match="is back from the toe"):
        match_pile(tmp_path / "short.csv", START)

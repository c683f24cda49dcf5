"""Calibrations of piles and of slopes that are killed go on: the bits of one in one go, nothing computed twice."""

import json
import re
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
import tomli_w
from typer.testing import CliRunner

import rockshed
from rockshed import kept_parts
from rockshed.analyses import kept_values
from rockshed.analyses.asked import finished_trials
from rockshed.commands.app import app
from rockshed.kept_parts import KeptParts, digest_of
from tests.cosim.test_resume_others import of_result

PILE = {
    "segments": 12,
    "time": 0.04,
    "gravity": 0.0,
    "hammer": {"mass": 4000.0, "drop": 1.2},
    "cushion": {"stiffness": 8e8},
    "rod": [{"length": 18.0, "width": 0.4, "modulus": 3.6e10, "density": 2450.0}],
    "shaft": [{"from": 4.0, "to": 18.0, "resistance": 900e3}],
    "toe": {"resistance": 900e3},
}
SLOPE = {
    "name": "slope",
    "rock": {"radius": 0.4, "density": 2600.0},
    "start": {"x": 1.0},
    "limit_speed": {"mean": 12.0, "deviation": 2.0},
    "profile": {"file": "profile.csv"},
}
PROFILE = "x;y;material\n0;40;soil\n30;12;soil\n90;5;\n"
_HELD = """
import sys
from threading import Event
from rockshed import kept_parts
from rockshed.analyses import kept_values

kept_parts.INTERVAL = 0.0
begin, left = kept_values._Kept.__init__, iter(range(int(sys.argv[1])))

def held(self, function, *more):
    def computed(place):
        if next(left, None) is None:
            print("held", flush=True)
            Event().wait()
        return function(place)
    begin(self, computed, *more)

kept_values._Kept.__init__ = held
from rockshed.commands.app import app
app(sys.argv[2:])
"""
"""A command that computes so many values, and then waits for its end."""


@dataclass(frozen=True)
class Calibration:
    """A command, the kind that it is called when it goes on, and its tables."""

    words: str
    kind: str
    tables: tuple[str, ...]


CALIBRATIONS = {
    "pile": Calibration(
        "calibrate pile blow.csv pile.toml --no-figures --output-dir out",
        "a pile matching goes on",
        ("waves.parquet",),
    ),
    "rockfall": Calibration(
        "calibrate rockfall slope.toml ends.csv --fit soil.roughness.mean=0.05..0.6 --steps 20 "
        "--trials 50 --workers 1 --forecast other.toml --no-figures --output-dir out",
        "a rockfall-calibration goes on",
        ("posterior.parquet", "likelihood.parquet", "ends.parquet"),
    ),
}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """A folder with the input files of all calibrations."""
    place = tmp_path_factory.mktemp("inputs")
    blow = rockshed.pile(PILE).blows[0].traces
    velocity = blow["head.zv"] / (0.16 * (3.6e10 * 2450.0) ** 0.5)
    rows = np.c_[blow["time"], blow["head.contact_force"], velocity]
    title = "time (s),force (N),velocity (m/s)"
    np.savetxt(place / "blow.csv", rows, delimiter=",", header=title, comments="")
    (place / "pile.toml").write_text(tomli_w.dumps({**PILE, "toe": {"resistance": 500e3}}))
    (place / "slope.toml").write_text(tomli_w.dumps(SLOPE))
    (place / "other.toml").write_text(tomli_w.dumps({**SLOPE, "start": {"x": 3.0}}))
    (place / "profile.csv").write_text(PROFILE)
    (place / "ends.csv").write_text("x (m)\n41\n44\n45\n47\n52\n")
    return place


def copied(inputs, place):
    place.mkdir(parents=True)
    for file in inputs.iterdir():
        (place / file.name).write_bytes(file.read_bytes())


def count_computed(monkeypatch):
    """Places whose values are computed from here on."""
    begin, seen = kept_values._Kept.__init__, []

    def counted(self, function, *more):
        begin(self, lambda place: (seen.append(place), function(place))[1], *more)

    monkeypatch.setattr(kept_values._Kept, "__init__", counted)
    return seen


def content(folder, calibration):
    """Everything that a calibration has found, to the bit."""
    facts = [json.loads((folder / name).read_text()) for name in ("run.json", "summary.json")]
    tables = [pyarrow.parquet.read_table(folder / name) for name in calibration.tables]
    numbers = {
        (i, name): table[name].to_numpy().tobytes()
        for i, table in enumerate(tables)
        for name in table.column_names
        if name != "slope"
    }
    notes = [re.sub(r"accepted; \d+ s", "accepted", note) for note in facts[0].get("notes", [])]
    return [{**of_result(facts[0]), "notes": notes, "site_file": ""}, facts[1], numbers]


@pytest.fixture(scope="module", params=CALIBRATIONS)
def in_one_go(request, inputs, tmp_path_factory):
    """A calibration, its results, and how many values it has computed."""
    calibration, place = CALIBRATIONS[request.param], tmp_path_factory.mktemp("whole") / "work"
    copied(inputs, place)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        seen = count_computed(patch)
        done = CliRunner().invoke(app, calibration.words.split())
        assert done.exit_code == 0, done.output
    assert sorted(file.name for file in place.iterdir() if file.name.startswith(".")) == []
    return calibration, content(place / "out", calibration), len(seen)


def killed(calibration, place, computed):
    """Kill a calibration when it has computed so many values."""
    (place / "script.py").write_text(_HELD)
    process = subprocess.Popen(
        [sys.executable, "-P", "script.py", str(computed), *calibration.words.split()],
        cwd=place,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert any("held" in line for line in process.stdout)
    finally:
        process.kill()
        process.communicate(timeout=60)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("again", ["resume", "the same command"])
def test_what_is_killed_goes_on_and_computes_nothing_twice(
    in_one_go, inputs, tmp_path, monkeypatch, share, again
):
    calibration, whole, number = in_one_go
    before = int(share * number)
    copied(inputs, tmp_path / "work")
    killed(calibration, tmp_path / "work", before)
    assert not (tmp_path / "work" / "out").exists()
    is_resumed = again == "resume"
    monkeypatch.chdir(tmp_path if is_resumed else tmp_path / "work")
    seen = count_computed(monkeypatch)
    words = "resume work/out --no-figures" if is_resumed else calibration.words
    done = CliRunner().invoke(app, words.split())
    assert done.exit_code == 0, done.output
    assert (calibration.kind in done.stderr) == is_resumed
    assert len(seen) == number - before
    assert content(tmp_path / "work" / "out", calibration) == whole
    assert not finished_trials(tmp_path / "work" / "out").exists()


def interrupted(calibration, place, monkeypatch):
    """Ctrl-C when a few values are computed; return what the command says."""

    def stop(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.chdir(place)
        patch.setattr("rockshed.analyses.back_analysis.run.forecast_of", stop)
        return CliRunner().invoke(app, calibration.words.split())


def test_ctrl_c_writes_what_waits_and_a_profile_that_changed_since_is_refused(
    inputs, tmp_path, monkeypatch
):
    place, calibration = tmp_path / "work", CALIBRATIONS["rockfall"]
    copied(inputs, place)
    done = interrupted(calibration, place, monkeypatch)
    assert done.exit_code == 130
    assert "`rockshed resume out` goes on" in " ".join(done.stderr.split())
    kept = finished_trials(place / "out")
    assert [*kept.glob("values-*.npz")]
    (place / "profile.csv").write_text(PROFILE.replace("12", "13"))
    told = CliRunner().invoke(app, ["resume", str(place / "out")])
    assert told.exit_code == 2
    assert "profile.csv:haschangedsince" in "".join(told.stderr.split())
    (place / "profile.csv").write_text(PROFILE)
    found = rockshed.resume(place / "out")
    assert found.folder == place / "out"
    assert not kept.exists()


def test_values_of_something_else_or_that_are_damaged_are_computed_again(tmp_path, monkeypatch):
    monkeypatch.setattr(kept_parts, "INTERVAL", 0.0)
    places, seen = np.arange(4.0).reshape(4, 1), []

    def square(place):
        seen.append(float(place[0]))
        return place**2

    def computed(*about):
        seen.clear()
        with suppress(ZeroDivisionError), kept_values.KeptValues(tmp_path / "kept") as kept:
            function = kept.of(square, *about)
            assert [function(place)[0] for place in places] == [0.0, 1.0, 4.0, 9.0]
            raise ZeroDivisionError
        return list(seen)

    assert computed("this", 1.0) == [0.0, 1.0, 2.0, 3.0]
    assert computed("this", 1.0) == []
    assert computed("that", 1.0) == [0.0, 1.0, 2.0, 3.0]
    digest = digest_of("another")
    KeptParts(tmp_path / "kept", "values").write(digest, {0: {"places": places}})
    for file in (tmp_path / "kept").glob("*-000000000002.npz"):
        file.write_bytes(file.read_bytes()[:-50])
    assert computed("this", 1.0) == [2.0]
    assert computed("this", 1.0) == []
    with kept_values.KeptValues(tmp_path / "kept"):
        pass
    assert not (tmp_path / "kept").exists()


def test_a_digest_tells_apart_everything_inside_of_what_it_is_made():
    made = [
        *([1.0], [1.0, 2.0], [[1.0], 2.0], {"a": 1.0}, {"b": 1.0}, "a", ["a", "b"], ["ab"]),
        *(np.arange(3000.0), np.arange(3000), [np.r_[np.arange(2999.0), 0.0]]),
        [np.r_[np.arange(1500.0), 7.0, np.arange(1498.0), 0.0]],
        Path("a"),
    ]
    assert len({digest_of(value) for value in made}) == len(made)

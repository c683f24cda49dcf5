"""Calibrations, convergence studies and reproductions that are killed go on with ``rockshed resume``."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.calibration.measurement import as_data, from_data, of_stiffness
from rockshed.analyses.convergence import run as convergence
from rockshed.analyses.exchange_steps import run as exchange_steps
from rockshed.commands.app import app
from rockshed.papers import reproduction
from rockshed.runs.kept import FINISHED

pytestmark = pytest.mark.usefixtures("own_fmus")

SHED = Path(rockshed.__file__).parent / "examples" / "trial-shed.toml"
HEAD = """
import sys
from pathlib import Path
import rockshed

if __name__ == "__main__":
    out = sys.argv[1]
    tell = lambda *told: print(*told, flush=True)
"""
SCRIPTS = {
    "calibration": "rockshed.calibrate(38.3e3, seeds=2, workers=2, folder=out, progress=tell)",
    "exchange-steps": (
        'rockshed.converge_exchange("lab-impact", levels=4, options={"stop_time": 0.002}, folder=out, progress=tell)'
    ),
}
FILES = {
    "calibration": "calibration.json",
    "exchange-steps": "exchange-steps.json",
}
OTHERWISE = (
    *("started", "ended", "wall_time", "wall_times", "cpu_time", "duration", "folder", "files"),
    *("rockshed_files", "project_file", "effort", "seconds"),
)
"""Entries that are not the same in two runs of one command: times, places and pictures."""


def of_result(content):
    """What of a file follows from what was computed."""
    if isinstance(content, dict):
        return {k: of_result(entry) for k, entry in content.items() if k not in OTHERWISE}
    return [of_result(entry) for entry in content] if isinstance(content, list) else content


def result_in(folder, kind):
    return of_result(json.loads((folder / FILES[kind]).read_text(encoding="utf-8")))


def started(kind, place):
    place.mkdir()
    shutil.copy(SHED, place / "shed.toml")
    (place / "script.py").write_text(HEAD + "    " + SCRIPTS[kind] + "\n")
    return subprocess.Popen(
        [sys.executable, "-P", "script.py", "out"], cwd=place, stdout=subprocess.PIPE, text=True
    )


def pieces(process):
    """Numbers of the pieces that are done, as they are told."""
    for line in process.stdout:
        done, total = map(int, line.split()[-2:])
        yield done, total


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["calibration", "exchange-steps"])
def test_what_is_killed_at_three_moments_goes_on_with_the_bits_of_one_in_one_go(tmp_path, kind):
    process = started(kind, tmp_path / "whole")
    *_, (_, total) = pieces(process)
    assert process.wait(timeout=300) == 0
    whole = result_in(tmp_path / "whole" / "out", kind)
    for number, part in enumerate((1, max(1, total // 2), max(1, total - 1))):
        place = tmp_path / f"killed-{number}"
        process = started(kind, place)
        assert next(done for done, _ in pieces(process) if done >= part)
        process.kill()
        process.communicate(timeout=60)
        assert not (place / "out" / FILES[kind]).exists()
        words = [
            "resume",
            str(place / "out"),
            *(["--no-figures"] if kind != "reproduction" else []),
        ]
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, done.output
        assert f"{kind} goes on" in done.stderr
        assert result_in(place / "out", kind) == whole
        assert not (place / "out" / FINISHED).exists()


def test_measurements_are_kept_as_plain_data_and_come_back():
    measured = [of_stiffness(38.3e3, "one", 1e6), of_stiffness(40e3)]
    for given in (measured[0], measured):
        back = from_data(json.loads(json.dumps(as_data(given))))
        assert [(m.name, m.stiffness, m.printed) for m in back] == [
            (m.name, m.stiffness, m.printed)
            for m in (given if isinstance(given, list) else [given])
        ]
    for plain in (38.3e3, "39.1 kgf/cm", "curve.csv"):
        assert from_data(as_data(plain)) == plain


@pytest.mark.parametrize(
    ("kind", "asked"),
    [
        ("calibration", {"measurement": "gone.csv"}),
        ("convergence", {"project": "gone.toml"}),
        ("exchange-steps", {"target": "gone.toml"}),
    ],
)
def test_an_analysis_whose_file_is_gone_is_refused_in_words(tmp_path, kind, asked):
    place = tmp_path / "out" / FINISHED
    place.mkdir(parents=True)
    told = {"kind": kind, "files": {str(tmp_path / next(iter(asked.values()))): "0"}}
    (place / "asked.json").write_text(json.dumps({**told, "arguments": asked}))
    done = CliRunner().invoke(app, ["resume", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert "has changed since" in " ".join(done.stderr.split())


def interrupted(*_, **__):
    """End in the place of the runs."""
    raise KeyboardInterrupt


def test_a_reproduction_that_was_ended_goes_on_from_what_it_was_asked(tmp_path, monkeypatch):
    asked = ("mogami1973", tmp_path / "out", ["settlement"], True)
    with monkeypatch.context() as patched:
        patched.setattr(reproduction, "run_all", interrupted)
        with pytest.raises(KeyboardInterrupt):
            reproduction.reproduce(*asked)
    done = CliRunner().invoke(app, ["resume", str(tmp_path / "out"), "--quiet"])
    assert done.exit_code == 0, done.output
    whole = reproduction.reproduce(asked[0], tmp_path / "whole", *asked[2:])
    found = json.loads((tmp_path / "out" / "reproduction.json").read_text(encoding="utf-8"))
    assert of_result(found) == of_result(json.loads(json.dumps(whole.content)))
    assert not (tmp_path / "out" / FINISHED).exists()


def test_a_study_of_exchange_steps_that_was_ended_runs_only_the_steps_that_are_missing(
    tmp_path, monkeypatch
):
    asked = {"levels": 4, "options": {"stop_time": 0.0005}, "watch": ["sand.rock.force.y"]}
    whole = rockshed.converge_exchange("lab-impact", **asked, folder=tmp_path / "whole")
    simulate, steps = exchange_steps.simulate, []

    def until_the_third(system):
        steps.append(system.spec.exchange_step)
        return simulate(system) if len(steps) < 3 else interrupted()

    with monkeypatch.context() as patched:
        patched.setattr(exchange_steps, "simulate", until_the_third)
        with pytest.raises(KeyboardInterrupt):
            rockshed.converge_exchange("lab-impact", **asked, folder=tmp_path / "out")
    again = []
    monkeypatch.setattr(exchange_steps, "simulate", lambda s: again.append(s) or simulate(s))
    found = rockshed.resume(tmp_path / "out")
    assert [system.spec.exchange_step for system in again] == [
        level.step for level in whole.levels[2:]
    ]
    assert result_in(tmp_path / "out", "exchange-steps") == result_in(
        tmp_path / "whole", "exchange-steps"
    )
    assert [level.curves["sand.rock.force.y"].tolist() for level in found.levels] == [
        level.curves["sand.rock.force.y"].tolist() for level in whole.levels
    ]
    assert not (tmp_path / "out" / FINISHED).exists()


def test_a_study_of_meshes_that_was_ended_goes_on_with_the_same_arguments(tmp_path, monkeypatch):
    asked = {"packings": 3, "finest": 2.0, "values": {"rock.mass": 2000.0}, "workers": 1}
    with monkeypatch.context() as patched:
        patched.setattr(convergence, "run_all", interrupted)
        with pytest.raises(KeyboardInterrupt):
            rockshed.converge(SHED, **asked, folder=tmp_path / "out")
    seen = []
    monkeypatch.setattr(convergence, "converge", lambda **given: seen.append(given))
    rockshed.resume(tmp_path / "out")
    (given,) = seen
    assert {key: given[key] for key in asked} == asked
    assert given["project"] == str(SHED.absolute())

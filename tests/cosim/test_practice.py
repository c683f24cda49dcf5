"""What an engineer's first day meets, and no other test shows: ends at once, and what a kill leaves."""

import json
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from rockshed.analyses.pile.pictures import bearing
from rockshed.commands.app import app
from rockshed.commands.results_place import results_folder
from rockshed.core.results.reading import read_run
from rockshed.core.results.run_folder import RunFolder, running_folder
from rockshed.files import naming
from rockshed.runs.projects import TEMPLATES
from rockshed.sites.pile.preparation import prepare


class Told:
    """A screen that keeps what it is told."""

    def __init__(self):
        self.texts = []

    def warn(self, text):
        self.texts.append(text)


def test_results_of_another_system_file_of_the_same_name_stay(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("results/system", "a", "b"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "results/system/run.json").write_text(json.dumps({"system_file": "a/system.toml"}))
    screen = Told()
    again = results_folder("system", "a/system.toml", {"system_file": "a/system.toml"}, screen)
    assert (str(again), screen.texts) == ("results/system", [])
    other = results_folder("system", "b/system.toml", {"system_file": "b/system.toml"}, screen)
    assert str(other) == "results/system-2"
    assert screen.texts == [
        "results/system holds other results, which stay; these go into results/system-2"
    ]


@pytest.mark.skipif(sys.platform != "linux", reason="has a device that is always full")
def test_a_full_disk_is_told_with_the_file_that_was_written(tmp_path):
    refused = pytest.raises(OSError, match=r"No space left on device: '.*rows.csv'")
    with refused, naming(tmp_path / "rows.csv"), open("/dev/full", "w") as full:
        full.write("1,2,3" * 10_000)


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
@pytest.mark.parametrize("after", [0.05, 0.15, 0.4])
def test_ctrl_c_right_after_the_start_ends_in_words(tmp_path, after):
    command = [sys.executable, "-P", "-m", "rockshed", "run", "lab-impact", "--in-process"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=120)
    # where Python itself had not begun yet, it says so at length, and may name our folder
    begun = "rockshed" in told and "Python runtime state" not in told
    assert not (begun and "Traceback" in told), told
    assert process.returncode in (1, 130, -signal.SIGINT)
    # a fast machine has begun to compute by then
    left = list(tmp_path.glob("results/*"))
    assert [read_run(path).status for path in left] in ([], ["interrupted"])


def test_a_run_that_was_killed_before_its_first_row_is_called_that(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with RunFolder(tmp_path / "run") as results:
        results.begin([], {"name": "x", "status": "running", "components": {}, "system": {}})
        kept = running_folder(tmp_path / "run").rename(tmp_path / "kept")
    kept.rename(running_folder(tmp_path / "run"))
    shown = CliRunner().invoke(app, ["plot", "run"], env={"COLUMNS": "300"})
    said = " ".join(shown.stderr.split())
    assert shown.exit_code == 2, shown.output
    assert "no folder of a run" not in said
    assert "killed" in said


UPWARDS = ["run", "lab-impact", "--in-process", "--set", "rock.velocity0.y=8"]
"""A rock that never touches the sand: a run with a warning."""


@pytest.mark.parametrize(("options", "code"), [([], 0), (["--strict"], 3)])
def test_a_strict_run_with_a_warning_ends_with_code_3_and_keeps_its_results(
    tmp_path, options, code
):
    place = ["--no-figures", "--stop-time", "0.002", "--output-dir", str(tmp_path / "run")]
    shown = CliRunner().invoke(app, [*UPWARDS, *place, *options], env={"COLUMNS": "300"})
    assert shown.exit_code == code, shown.output
    assert "has never touched the sand" in shown.stderr
    assert ("strict: the run has 1 warning" in shown.stderr) == bool(options)
    assert (tmp_path / "run" / "run.json").is_file()
    assert not (tmp_path / "run" / "figures").exists()


def test_pictures_that_were_left_out_are_drawn_later(tmp_path):
    folder = str(tmp_path / "o")
    told = ["pile", str(TEMPLATES["pile"]), "--blows", "1", "--no-figures", "--output-dir", folder]
    shown = CliRunner().invoke(app, told)
    assert shown.exit_code == 0, shown.output
    assert not (tmp_path / "o" / "figures").exists()
    again = CliRunner().invoke(app, ["plot", folder])
    assert again.exit_code == 0, again.output
    assert (tmp_path / "o" / "figures" / "bearing.png").is_file()


@pytest.mark.parametrize(("counts", "scale"), [((20.0, 60.0), "linear"), ((12.0, 900.0), "log")])
def test_a_resistance_near_refusal_leaves_the_others_of_a_bearing_graph_apart(counts, scale):
    stresses = {"compression": np.array([1e7]), "tension": np.array([1e6])}
    blows = [
        SimpleNamespace(resistance=1e3 * count, count=count, set=0.3 / count, **stresses)
        for count in counts
    ]
    points = [SimpleNamespace(first=blow, last=blow) for blow in blows]
    resistance, stress = bearing(prepare(TEMPLATES["pile"]), points).axes[:2]
    assert resistance.get_xscale() == stress.get_xscale() == scale
    left, right = stress.transData.transform([(counts[0], 0.0), (counts[1], 0.0)])[:, 0]
    assert right - left > 0.3 * stress.bbox.width

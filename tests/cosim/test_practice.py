"""What an engineer's first day meets, and no other test shows: ends at once, and what a kill leaves."""

import json
import signal
import subprocess
import sys
import time

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.commands.results_place import results_folder
from rockshed.core.results.run_folder import RunFolder, running_folder
from rockshed.files import naming


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
    begun = "rockshed" in told  # else Python itself had not begun yet, and says so at length
    assert not (begun and "Traceback" in told), told
    assert process.returncode in (1, 130, -signal.SIGINT)
    assert list(tmp_path.iterdir()) == []


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

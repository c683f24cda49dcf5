"""Ctrl-C while the processes of an analysis begin: the command ends in words, and so do they."""

import os
import shlex
import signal
import subprocess
import sys
import time

import psutil
import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="sends a signal to a group")

_SLOW = """
import importlib.abc
import os
import sys
import time
from pathlib import Path

class Slow(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == os.environ["SLOW_IMPORT"]:
            place = Path(os.environ["SLOW_PLACE"])
            (place / f"importing-{os.getpid()}").touch()
            while not (place / "go").exists():
                time.sleep(0.02)

if any("spawn_main" in word for word in sys.orig_argv):
    sys.meta_path.insert(0, Slow())
"""
"""Makes a module that the processes of an analysis import a slow one: it waits to be told to go."""
STUDY = "study lab-impact --vary rock.velocity0.y=-4,-6,-8,-5 --stop-time 0.002 --workers 2 --quiet"
CALIBRATION = "calibrate sand --stiffness '39.1 kgf/cm' --seeds 2 --workers 2 --quiet"
CLUSTER = f"{STUDY} --scheduler local"


def begun(place, words, module):
    """A command as a terminal starts it, once its processes import this module."""
    (place / "sitecustomize.py").write_text(_SLOW)
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "rockshed", *words, "--output-dir", "out"],
        cwd=place,
        env=os.environ
        | {"PYTHONPATH": str(place), "SLOW_IMPORT": module, "SLOW_PLACE": str(place)},
        stdout=subprocess.DEVNULL,
        stderr=(place / "said").open("w"),
        start_new_session=True,
    )
    while not [*place.glob("importing-*")]:
        assert process.poll() is None, (place / "said").read_text()
        time.sleep(0.02)
    return process


def ended(process, place):
    """Exit code and words of a command that ends, with all its processes."""
    children = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    time.sleep(0.3)
    (place / "go").touch()
    code = process.wait(timeout=300)
    assert psutil.wait_procs(children, timeout=60)[1] == []
    return code, (place / "said").read_text()


@pytest.mark.parametrize("words", [STUDY, CALIBRATION, CLUSTER], ids=["study", "sand", "dask"])
@pytest.mark.parametrize(
    "module", ["multiprocessing.spawn", "rockshed", "numpy", "rockshed.runs.executors"]
)
def test_ctrl_c_while_processes_import_says_nothing_but_that(tmp_path, words, module):
    if "--scheduler" in words:
        pytest.importorskip("distributed")
    process = begun(tmp_path, shlex.split(words), module)
    code, said = ended(process, tmp_path)
    assert "Traceback" not in said, said
    assert "KeyboardInterrupt" not in said, said
    assert "interrupted" in said
    assert code == 130


def test_a_process_that_never_ends_to_import_does_not_hold_up_ctrl_c(tmp_path):
    process = begun(tmp_path, STUDY.split(), "numpy")
    children = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(timeout=300) == 130
    assert psutil.wait_procs(children, timeout=60)[1] == []
    assert "Traceback" not in (tmp_path / "said").read_text()

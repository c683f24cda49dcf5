"""Runs that are ended from outside, in a process of their own, with a foreign FMU whose Python code the signal hits."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from rockshed.core.results.reading import read_run
from rockshed.core.results.run_folder import running_folder
from rockshed.core.run import simulate
from tests.cosim.mocks import mass, wired

SCRIPT = """
import sys
from pathlib import Path
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from tests.cosim.mocks import called_back

fmu, folder, way = sys.argv[1:]
system = system_from({"name": "slow", "components": {"a": {"fmu": fmu, "parameters": {"pause": 0.001}, "record_states": True}},
                      "exchange_step": 0.01, "stop_time": 1000.0, "state_interval": 0.1})
run = simulate(system, Path(folder), sources=called_back(system) if way == "back" else {})
print(run.status)
"""


def start(fmu, folder, way):
    """A run of a hundred seconds, once it has written a row after the start."""
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(fmu), str(folder), way],
        cwd=Path(__file__).parents[2],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    stream = running_folder(folder) / "timeseries.arrows"
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and process.poll() is None:
        if stream.is_file() and any(read_run(folder).series["time"] > 0.0):
            return process
        time.sleep(0.05)
    process.kill()
    pytest.fail(f"the run wrote nothing: {process.communicate()}")


def is_sound(run):
    """Rows without a gap, and the right values in them."""
    time = run.series["time"]
    return np.allclose(time, run.series["a.local_time"], atol=1e-12) and np.allclose(
        np.diff(time), 0.01
    )


@pytest.mark.parametrize("way", ["back", "direct"])
def test_ctrl_c_ends_the_run_and_keeps_everything(foreign, tmp_path, way):
    process = start(foreign, tmp_path / "run", way)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out.strip()) == (0, "interrupted"), err
    run = read_run(tmp_path / "run")
    assert run.status == "interrupted"
    assert is_sound(run)
    assert run.series["time"][-1] == run.metrics["simulated_time"].value > 0.0
    assert run.provenance["error"] is None
    assert len(list(run.states("a"))) == int(run.series["time"][-1] / 0.1 + 1e-9) + 1
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_a_killed_run_can_be_read_and_its_folder_used_again(foreign, tmp_path):
    process = start(foreign, tmp_path / "run", "direct")
    process.kill()
    process.communicate(timeout=30)
    run = read_run(tmp_path / "run")
    assert run.status == "running"
    assert run.series["time"].size > 0
    assert is_sound(run)
    assert len(list(run.states("a"))) > 0
    assert run.provenance["components"]["a"]["parameters"]["pause"]["value"] == 0.001
    system, sources = wired({"a": mass()}, [])
    assert simulate(system, tmp_path / "run", sources=sources).status == "complete"
    assert [path.name for path in tmp_path.iterdir()] == ["run"]

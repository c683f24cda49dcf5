"""A Dask scheduler that dies in the middle: what has ended is kept, and the same command goes on."""

import socket
import subprocess
import sys
from pathlib import Path

import pytest

import rockshed

pytestmark = pytest.mark.slow
SLOPE = Path(rockshed.__file__).parent / "examples" / "slope.toml"
STUDY = "study lab-impact --vary rock.velocity0.y=-4,-6,-8 --vary sand.modulus=2e6,4e6"
COMMANDS = {
    "study": (f"{STUDY} --stop-time 0.1", "runs.csv", "runs: "),
    "rockfall": (f"rockfall {SLOPE} --trials 400000", "envelopes.csv", "trials: "),
}
"""Command, a file of its results, and the beginning of the lines that tell how far it is."""


def started(*words):
    return subprocess.Popen(
        [sys.executable, "-P", "-m", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def scheduler():
    """A scheduler with one worker: its process and address."""
    pytest.importorskip("distributed")
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = str(unused.getsockname()[1])
    address = f"tcp://127.0.0.1:{port}"
    begun = started(
        *("distributed.cli.dask_scheduler", "--host", "127.0.0.1"),
        *("--port", port, "--no-dashboard"),
    )
    assert any("Scheduler at" in line for line in begun.stderr)
    worker = started(
        *("distributed.cli.dask_worker", address),
        *("--nthreads", "1", "--no-nanny", "--no-dashboard"),
    )
    assert any("Registered to" in line for line in worker.stderr)
    yield begun, address
    for process in (worker, begun):
        process.kill()
        process.communicate()


@pytest.mark.parametrize("name", COMMANDS)
def test_what_has_ended_outlives_a_scheduler_and_the_same_command_goes_on(
    name, scheduler, tmp_path
):
    words, table, counted = COMMANDS[name]
    process, address = scheduler
    command = ["rockshed", *words.split(), "--no-figures", "--output-dir"]
    lost = started(*command, str(tmp_path / "out"), "--scheduler", address)
    told = []
    for line in lost.stderr:
        told.append(line)
        if line.startswith(counted) and not line.startswith(f"{counted}0 "):
            process.kill()
    assert lost.wait(timeout=300) == 1
    said = " ".join("".join(told).split())
    assert "the scheduler or its last worker is gone" in said
    assert said.endswith("kept: run it again")
    assert "Traceback" not in said
    kept = [*tmp_path.glob(".out-finished*"), *tmp_path.glob("out/.finished-runs/run-*.npz")]
    assert kept
    for folder, where in (("out", ("--scheduler", "local")), ("whole", ())):
        again = started(*command, str(tmp_path / folder), "--workers", "1", *where)
        _, text = again.communicate(timeout=600)
        assert again.returncode == 0, text
    assert (tmp_path / "out" / table).read_text() == (tmp_path / "whole" / table).read_text()
    assert not any(file.exists() for file in kept)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "whole"]

"""Batches of runs: what has ended is kept, and no process outlives the one that has started it."""

import json
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import active_children

import numpy as np
import psutil
import pytest

from rockshed.runs import batch, executors
from rockshed.runs.batch import COMPLETE, Task, run_all
from rockshed.runs.job import Request
from rockshed.runs.kept import KeptRuns

SHORT = Task(Request("lab-impact", options={"stop_time": 0.001}))

_BATCH = """
import sys
from pathlib import Path
from rockshed.runs.batch import Task, run_all
from rockshed.runs.job import Request
from rockshed.runs.kept import KeptRuns

if __name__ == "__main__":
    tasks = [
        Task(Request("lab-impact", {"sand.seed": n}, options={"stop_time": t}))
        for n, t in ((1, 0.001), (2, 0.9), (3, 0.9), (4, 0.9))
    ]
    run_all(tasks, 2, print, lambda n, all: print("ended", n, flush=True), KeptRuns(Path(sys.argv[1])))
"""


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A folder with one run that has ended, and its outcome."""
    runs = KeptRuns(tmp_path_factory.mktemp("kept") / "runs")
    found = run_all([SHORT], 1, kept=runs)[SHORT.key]
    assert found.status == COMPLETE
    return runs, found


def test_a_run_that_has_ended_is_not_run_again(kept, monkeypatch):
    runs, before = kept
    monkeypatch.setattr(batch, "run_one", lambda order: pytest.fail("it is run again"))
    again = run_all([SHORT], 1, kept=runs)[SHORT.key]
    assert (again.metrics, again.fmus, again.options) == (
        before.metrics,
        before.fmus,
        before.options,
    )
    assert all(np.array_equal(again.series[name], before.series[name]) for name in before.series)


def test_a_run_of_other_values_is_run(kept):
    runs, _ = kept
    other = Task(Request("lab-impact", {"sand.damping": 0.3}, options={"stop_time": 0.001}))
    (order,) = (batch._order(task, print) for task in [other])
    assert runs.find(order.key, order.system, order.allow_unstable, order.about) is None


@pytest.mark.parametrize("at", [0, 0.3, 0.6, 0.9])
def test_a_kept_run_that_is_damaged_is_run_again(kept, at):
    runs, _ = kept
    (file,) = runs.folder.glob("run-*.npz")
    whole = file.read_bytes()
    order = batch._order(SHORT, print)
    for damaged in (whole[: int(at * len(whole))], _flipped(whole, int(at * len(whole)))):
        file.write_bytes(damaged)
        found = runs.find(order.key, order.system, order.allow_unstable, order.about)
        assert found is None or json.dumps(found.metrics) == json.dumps(kept[1].metrics)
    file.write_bytes(whole)


def _flipped(content, place):
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


def test_processes_of_a_batch_end_when_their_parent_is_killed_and_what_has_ended_is_kept(tmp_path):
    script = tmp_path / "batch.py"
    script.write_text(_BATCH)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    run = subprocess.Popen(
        [sys.executable, str(script), str(tmp_path / "runs")],
        stdout=subprocess.PIPE,
        text=True,
        env={**__import__("os").environ, "TMPDIR": str(scratch)},
    )
    assert any("ended 1" in line for line in run.stdout)
    started = psutil.Process(run.pid).children(recursive=True)
    time.sleep(0.5)
    run.kill()
    run.wait(timeout=60)
    _, left = psutil.wait_procs(started, timeout=60)
    assert not [process for process in left if process.status() != psutil.STATUS_ZOMBIE]
    assert len(list((tmp_path / "runs").glob("run-*.npz"))) == 1
    assert not [path for path in scratch.iterdir() if path.name.startswith("rockshed-")]


def interrupted_while_deaf():
    """Raise what Ctrl-C raises, while a process sleeps; it carries that process."""
    with executors.Processes(1) as pool:
        (lane,) = pool._lanes
        lane.pool.submit(time.monotonic).result()  # it has begun
        lane.pool.submit(time.sleep, 600.0)
        raise KeyboardInterrupt(*active_children())


def test_a_process_that_hears_no_interrupt_is_killed(monkeypatch):
    """As a kernel that prepares a large layer of sand; between two runs a process hears nothing."""
    monkeypatch.setattr(executors, "_DEAF", 0.5)
    with pytest.raises(KeyboardInterrupt) as reason:
        interrupted_while_deaf()
    (child,) = reason.value.args
    with suppress(psutil.NoSuchProcess):  # raises TimeoutExpired where it goes on
        psutil.Process(child.pid).wait(60.0)

"""Batches of runs: what has ended is kept, and no process outlives the one that has started it."""

import json
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import active_children
from multiprocessing.context import SpawnProcess
from pathlib import Path

import numpy as np
import psutil
import pytest

from rockshed.core.loop.master import Interruption
from rockshed.runs import batch, executors
from rockshed.runs import kept as runs_kept
from rockshed.runs.batch import COMPLETE, Task, run_all
from rockshed.runs.job import Request
from rockshed.runs.kept import KeptRuns
from rockshed.temporary import TemporaryFolder

pytestmark = pytest.mark.usefixtures("own_fmus")

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
        for n, t in ((1, 0.001), (2, 30.0), (3, 30.0), (4, 30.0))
    ]
    run_all(tasks, 2, print, lambda n, all: print("ended", n, flush=True), KeptRuns(Path(sys.argv[1])))
"""


@pytest.fixture(scope="module")
def kept(own_fmus, tmp_path_factory):
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


def test_a_run_is_kept_under_the_fmus_that_have_run_though_their_files_are_others_by_now(
    kept, tmp_path, monkeypatch
):
    before = kept[1]
    (order,) = (batch._order(task, print) for task in [SHORT])
    asked = (order.key, order.system, order.allow_unstable, order.about)
    runs = KeptRuns(tmp_path / "runs")
    fmus = dict(before.fmus)
    built_anew = {name: "0" * 64 for name in fmus}
    monkeypatch.setattr(runs_kept, "_present", lambda _: built_anew)
    runs.keep(order.system, order.allow_unstable, before, order.about)
    assert runs.find(*asked) is None
    monkeypatch.setattr(runs_kept, "_present", lambda _: fmus)
    assert runs.find(*asked).metrics == before.metrics


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


def run_until_interrupted(began):
    """Carry out a run that Ctrl-C ends, and that has a temporary folder as an FMU has."""
    with executors.running(), TemporaryFolder(), Interruption() as interruption:
        Path(began).touch()
        last = time.monotonic() + 30.0
        while not interruption.requested and time.monotonic() < last:
            time.sleep(0.01)


def interrupted_with_a_run_waiting(place):
    with executors.Processes(1) as pool:
        (lane,) = pool._lanes
        began = [place / name for name in ("first", "second")]
        runs = [lane.pool.submit(run_until_interrupted, str(path)) for path in began]
        while not (began[0].exists() and runs[1].running()):
            time.sleep(0.01)
        raise KeyboardInterrupt


def test_a_run_that_waits_in_a_process_is_interrupted_too(tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "_DEAF", 10.0)
    killed = []
    monkeypatch.setattr(SpawnProcess, "kill", lambda process: killed.append(process))
    with pytest.raises(KeyboardInterrupt):
        interrupted_with_a_run_waiting(tmp_path)
    assert not killed


def keep_a_folder(began):
    """Hear nothing, and keep a temporary folder."""
    with TemporaryFolder() as folder:
        Path(began).write_text(str(folder))
        time.sleep(600.0)


def interrupted_while_deaf_with_a_folder(began):
    with executors.Processes(1) as pool:
        (lane,) = pool._lanes
        lane.pool.submit(keep_a_folder, str(began))
        while not (began.exists() and began.read_text()):
            time.sleep(0.01)
        raise KeyboardInterrupt


def test_what_a_killed_process_leaves_is_removed_by_the_one_that_kills_it(tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "_DEAF", 0.5)
    began = tmp_path / "began"
    with pytest.raises(KeyboardInterrupt):
        interrupted_while_deaf_with_a_folder(began)
    assert not Path(began.read_text()).exists()

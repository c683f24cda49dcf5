"""Runs that are ended and go on in another process: the same bits, or a refusal that says why."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.core import continuing
from rockshed.core.continuing import find_stopped
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.results.checkpoints import (
    CheckpointDamaged,
    file_of,
    known_checkpoints,
    read_checkpoint,
)
from rockshed.core.run import simulate
from rockshed.core.system.planning import make_plan
from tests.cosim.mocks import Mock, mass, out, spring, wired

LINKS = [
    "spring.end1.force -> a.force",
    "spring.end2.force -> b.force",
    "a.position -> spring.end1.position",
    "b.position -> spring.end2.position",
]
BOND = {"giver": "spring", "force": ["end1.force"], "taker": "a", "position": ["position"]}
RESULTS = ("timeseries.parquet", "timeseries.csv", "states.h5", "columns.csv")
"""Files that have to be the same to the bit; the others have times of the clock."""


def system(breaks_at=None, hidden=False, **changes):
    """Two masses on a spring, one with half the step; the other breaks down at a time (s)."""
    mocks = {"spring": spring(3.0, ends=2), "a": mass(1.0, position=1.0), "b": mass(3.0)}
    step = mocks["a"].step
    count = [0]

    def advance(v, t, h):
        count[0] += 1
        if breaks_at is not None and t >= breaks_at - 1e-9:
            return (3, "broken")
        step(v, t, h)
        if hidden:
            v["velocity"] += 1e-9 * count[0]  # which no state holds
        return None

    mocks["a"].step = advance if breaks_at is not None or hidden else step
    options = {
        "exchange_step": 0.05,
        "output_interval": 0.1,
        "state_interval": 0.2,
        "stop_time": 2.0,
        "components": {"a": {"record_states": True, "step": 0.025}, "spring": {"step": 0.1}},
        "bonds": {"pull": BOND},
        "watch": ["*.position"],
    }
    return wired(mocks, LINKS, **{**options, **changes})


def ended(folder, breaks_at, every, **changes):
    """A run that has broken down at a time (s)."""
    broken, sources = system(breaks_at, **changes)
    with pytest.raises(RunFailed, match="broken"):
        simulate(broken, folder, sources=sources, checkpoint_every=every)
    return folder


def resumed(folder, **changes):
    """The run of a folder, which goes on with components that do not break down."""
    return continuing.resume(find_stopped(folder), system(**changes)[1])


def differing(one, other):
    """Results that are other bits, and metrics that are other numbers."""
    files = [name for name in RESULTS if (one / name).read_bytes() != (other / name).read_bytes()]
    of_both = [json.loads((folder / "summary.json").read_text()) for folder in (one, other)]
    metrics = [
        found["name"]
        for found, expected in zip(*of_both, strict=True)
        if found != expected and "wall time" not in found["name"]
    ]
    return files + metrics


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Folders of runs in one go, by master."""
    place = tmp_path_factory.mktemp("whole")
    for master in ("sequential", "jacobi"):
        one, sources = system(master=master)
        simulate(one, place / master, sources=sources)
    return place


@settings(max_examples=6)
@given(
    every=st.integers(1, 30),
    moment=st.integers(1, 39),
    master=st.sampled_from(["sequential", "jacobi"]),
)
def test_a_run_that_goes_on_gives_the_bits_of_one_in_one_go(
    tmp_path_factory, whole, every, moment, master
):
    place = tmp_path_factory.mktemp("runs")
    ended(place / "ended", 0.05 * moment, 0.05 * every, master=master)
    done = resumed(place / "ended", master=master)
    assert done.status == "complete"
    assert not differing(whole / master, place / "ended")
    assert [path.name for path in place.iterdir()] == ["ended"]
    shutil.rmtree(place)


def test_a_run_that_is_ended_again_and_again_comes_to_its_end(tmp_path, whole):
    folder = ended(tmp_path / "ended", 0.4, 0.1)
    for moment in (0.3, 0.9, 1.6):
        with pytest.raises(RunFailed, match="broken"):
            continuing.resume(find_stopped(folder), system(moment)[1])
    done = resumed(folder)
    assert not differing(whole / "sequential", folder)
    assert len(done.provenance["resumed"]) == 4
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ended"]


def test_a_run_goes_on_from_what_a_killed_process_has_left(tmp_path, whole):
    """Rows behind the checkpoint are cut off; the folder is named by either of its names."""
    folder = ended(tmp_path / "run", 1.3, 0.3)
    left = folder.rename(tmp_path / "run.running")
    told = json.loads((left / "run.json").read_text())
    (left / "run.json").write_text(json.dumps({**told, "status": "running"}))
    (left / ".rockshed").write_text('{"made by": "rockshed"}')
    (left / "checkpoints" / ".exchange-000000000024.0a1b2c3d.checkpoint").write_bytes(b"half")
    assert resumed(left).status == "complete"
    assert not differing(whole / "sequential", folder)
    assert not left.exists()


def test_messages_of_a_run_that_goes_on_are_counted_as_in_one_go(tmp_path):
    def warning(breaks_at=None):
        return Mock(
            [out("y")],
            lambda v, t, h: (3, "broken") if breaks_at and t > breaks_at else (1, "rough"),
        )

    one, sources = wired({"a": warning()}, [])
    whole = simulate(one, tmp_path / "whole", sources=sources)
    with pytest.raises(RunFailed):
        simulate(one, tmp_path / "ended", sources={"a": warning(0.65)}, checkpoint_every=0.2)
    done = continuing.resume(find_stopped(tmp_path / "ended"), sources)
    assert done.warnings == whole.warnings == ["a: rough (10 times)"]


def test_an_fmu_whose_state_does_not_hold_everything_is_found_out(tmp_path):
    folder = ended(tmp_path / "run", 1.3, 0.3, hidden=True)
    with pytest.raises(InputRefused, match=r"at t = 1.2 s, spring.end1.force is .* does not hold"):
        resumed(folder, hidden=True)
    assert find_stopped(folder).witness.exchange == 24  # everything is as it was
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_components_without_serialized_states_are_named_before_a_run_with_checkpoints(tmp_path):
    mute = {"a": Mock([out("y")], serializes=False), "b": Mock([out("y")], serializes=False)}
    one, sources = wired(mute, [])
    with pytest.raises(InputRefused) as refused:
        simulate(one, tmp_path / "run", sources=sources, checkpoint_every=0.15)
    assert [problem.where for problem in refused.value.problems] == ["a", "b", "checkpoint_every"]
    assert "canSerializeFMUState" in str(refused.value)
    assert "no whole number of exchange steps of 0.1 s; give 0.1 s" in str(refused.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("every", [0.0, -1.0, float("nan"), float("inf"), 2.0, 5.0])
def test_times_that_give_no_checkpoint_are_refused(tmp_path, every):
    one, sources = system()
    with pytest.raises(InputRefused, match="checkpoint_every"):
        simulate(one, tmp_path / "run", sources=sources, checkpoint_every=every)


def test_a_complete_run_has_nothing_left_to_do(tmp_path):
    one, sources = system()
    simulate(one, tmp_path / "run", sources=sources, checkpoint_every=0.5)
    assert find_stopped(tmp_path / "run") is None
    assert known_checkpoints(tmp_path / "run") == [0, 20, 30]


def test_a_time_below_zero_between_checkpoints_is_called_that(tmp_path):
    one, sources = system()
    with pytest.raises(InputRefused, match=r"-2 s is no time above 0; give"):
        simulate(one, tmp_path / "run", sources=sources, checkpoint_every=-2.0)


def test_a_run_without_checkpoints_says_what_to_do(tmp_path):
    broken, sources = system(0.7)
    with pytest.raises(RunFailed):
        simulate(broken, tmp_path / "run", sources=sources)
    with pytest.raises(InputRefused, match=r"no checkpoint: .* run it again with checkpoint_every"):
        find_stopped(tmp_path / "run")
    with pytest.raises(InputRefused, match=r"is no folder of a run"):
        find_stopped(tmp_path / "nowhere")


def test_other_fmus_and_other_versions_are_refused_all_at_once(tmp_path):
    folder = ended(tmp_path / "run", 1.3, 0.3)
    told = json.loads((folder / "run.json").read_text())
    told["versions"]["numpy"] = "1.0"
    (folder / "run.json").write_text(json.dumps(told))
    other = system()[1]
    other["b"].origin = {"sha256": "0" * 64}
    with pytest.raises(InputRefused) as refused:
        continuing.resume(find_stopped(folder), other)
    numpy, fmu = map(str, refused.value.problems)
    assert numpy.startswith("numpy: the run was computed with 1.0, and this is ")
    assert fmu.startswith("b: ")
    assert "its sha256 is 0000000000000000, and was None in the run" in fmu


def test_a_damaged_checkpoint_is_passed_over_for_the_one_before(tmp_path, whole):
    folder = ended(tmp_path / "run", 1.3, 0.3)
    newest = file_of(folder, known_checkpoints(folder)[-1])
    content = bytearray(newest.read_bytes())
    content[len(content) // 2] ^= 1
    newest.write_bytes(content)
    stopped = find_stopped(folder)
    assert (stopped.base.exchange, stopped.witness.exchange) == (0, 18)
    resumed(folder)
    assert not differing(whole / "sequential", folder)


@settings(max_examples=60)
@given(data=st.data())
def test_no_damage_to_a_checkpoint_is_read_over(checkpoint, data):
    folder, exchange, content = checkpoint
    place = data.draw(st.integers(0, len(content) - 1))
    cut = data.draw(st.booleans())
    damaged = bytearray(content[:place] if cut else content)
    if not cut:
        damaged[place] ^= data.draw(st.integers(1, 255))
    file_of(folder, exchange).write_bytes(damaged)
    with pytest.raises(CheckpointDamaged):
        read_checkpoint(folder, exchange)


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory):
    """Folder of a run, number of exchanges and content of a checkpoint."""
    folder = ended(tmp_path_factory.mktemp("damaged") / "run", 1.3, 0.3)
    exchange = known_checkpoints(folder)[-1]
    return folder, exchange, file_of(folder, exchange).read_bytes()


def test_nothing_in_a_checkpoint_is_executed(tmp_path):
    """Not even where its hash is right: objects of Python are no data."""
    import hashlib

    class Planted:
        def __reduce__(self):
            return (os.mkdir, (str(tmp_path / "planted"),))

    stream = io.BytesIO()
    np.savez(stream, facts=np.array([Planted()], object), states=np.zeros(0, np.uint8))
    content = stream.getvalue()
    file = file_of(tmp_path, 3)
    file.parent.mkdir()
    digest = hashlib.sha256(content).hexdigest().encode()
    file.write_bytes(b"rockshed checkpoint 1\n" + digest + b"\n" + content)
    with pytest.raises(CheckpointDamaged, match="allow_pickle"):
        read_checkpoint(tmp_path, 3)
    assert not (tmp_path / "planted").exists()


def test_a_state_of_another_system_is_refused(tmp_path):
    folder = ended(tmp_path / "run", 1.3, 0.3)
    told = json.loads((folder / "run.json").read_text())
    told["system"]["watch"] = []
    (folder / "run.json").write_text(json.dumps(told))
    with pytest.raises(InputRefused, match="is the state of another system"):
        resumed(folder)


ENTRIES = ("checkpoints", "versions", "components", "system", "resumed", "started", "status")
JUNK = st.sampled_from([None, [], {}, "x", -1, 1e300, True, [None], {"run": "x"}])


@settings(max_examples=20)
@given(data=st.data())
def test_a_damaged_description_of_a_run_is_refused_in_words(stopped, data):
    folder, told = stopped
    entry = data.draw(st.sampled_from(ENTRIES))
    changed = json.loads(told)
    inner = changed[entry] if isinstance(changed.get(entry), dict) else {}
    if inner and data.draw(st.booleans()):
        inner[data.draw(st.sampled_from(sorted(inner)))] = data.draw(JUNK)
    else:
        changed[entry] = data.draw(JUNK)
    (folder / "run.json").write_text(json.dumps(changed))
    content = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    problems = []
    try:
        found = find_stopped(folder)
        if found is not None:
            plan = make_plan(continuing.system_of(found.run), system()[1])
            continuing.refuse_others(found.run, system()[1], (found.base, found.witness))
            assert plan.order
    except InputRefused as refusal:
        problems = refusal.problems
    assert all(problem.where and problem.what for problem in problems)
    assert content == {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """Folder of a run that was ended, and its description."""
    folder = ended(tmp_path_factory.mktemp("stopped") / "run", 1.3, 0.3)
    told = json.loads((folder / "run.json").read_text())
    return folder, json.dumps({**told, "resumed": []})


# ---------------------------------------------------------------- processes that are killed


def started(words, place):
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "rockshed", *words],
        cwd=place,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def command(words, place):
    done = subprocess.run(
        [sys.executable, "-P", "-m", "rockshed", *words], cwd=place, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done


def killed(words, place, moment=0.0):
    """Kill a command, and the process that watches over it, a while (s) after its first checkpoint."""
    process = started(words, place)
    while not list(place.glob("run*/checkpoints/exchange-*")):
        assert process.poll() is None, "the run has ended by itself"
        time.sleep(0.005)
    time.sleep(moment)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


SYSTEM = """
name = "fall"
exchange_step = 1e-5
output_interval = 1e-3
stop_time = {stop}

[components.rock]
fmu = "{fmu}"
"""


CHILD = """
import sys, time
from tests.cosim import test_resume

one, sources = test_resume.system()
step = sources["b"].step
sources["b"].step = lambda v, t, h: (time.sleep(0.05), step(v, t, h))[1]
test_resume.simulate(one, test_resume.Path(sys.argv[1]), sources=sources, checkpoint_every=0.1)
"""


def test_a_killed_process_is_continued_by_this_one(tmp_path, whole):
    """It is killed in the middle of anything: a step, a row, or a checkpoint."""
    root = Path(__file__).parents[2]
    folder = tmp_path / "run"
    child = subprocess.Popen([sys.executable, "-c", CHILD, str(folder)], cwd=root)
    while len(known_checkpoints(tmp_path / "run.running")) < 3:
        assert child.poll() is None, "the run has ended by itself"
        time.sleep(0.001)
    child.kill()
    child.wait()
    assert resumed(folder).status == "complete"
    assert not differing(whole / "sequential", folder)
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="kills groups of processes")
def test_a_process_that_is_killed_is_continued_by_another_one(tmp_path, rock_fmu):
    (tmp_path / "fall.toml").write_text(SYSTEM.format(stop=10.0, fmu=rock_fmu))
    words = ["run", "fall.toml", "--no-figures", "--quiet", "--checkpoint-every", "20ms"]
    # the first of five hundred checkpoints: no machine is so fast that it ends meanwhile
    killed([*words, "--output-dir", "run"], tmp_path)
    left = tmp_path / "run.running"
    assert json.loads((left / "run.json").read_text())["status"] == "running"
    done = command(["resume", "run", "--no-figures"], tmp_path)
    assert "goes on from t = " in done.stderr
    command([*words, "--output-dir", "whole"], tmp_path)
    files = ("timeseries.parquet", "timeseries.csv", "columns.csv")
    assert all(
        (tmp_path / "run" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
        for name in files
    )
    assert not left.exists()
    assert "nothing is left to do" in command(["resume", "run", "--no-figures"], tmp_path).stderr


IMPACTS = {
    "paper": [],
    "jacobi": ["--coupling", "jacobi"],
    "impulse": ["--coupling", "impulse"],
}


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="kills groups of processes")
@pytest.mark.parametrize("coupling", IMPACTS)
def test_an_impact_that_is_killed_ten_times_gives_the_bits_of_one_in_one_go(tmp_path, coupling):
    words = ["run", "lab-impact", *IMPACTS[coupling], "--no-figures", "--quiet"]
    began = time.monotonic()
    command([*words, "--output-dir", "whole"], tmp_path)
    lasted = json.loads((tmp_path / "whole" / "run.json").read_text())["wall_time"]
    random = np.random.default_rng(int(began))
    for _ in range(10):
        moment = random.uniform(0.0, 0.9 * (lasted["exchanges"] + lasted["recording"]))
        run = [*words, "--output-dir", "run", "--checkpoint-every", "1ms"]
        killed(run, tmp_path, moment)
        command(["resume", "run", "--no-figures", "--quiet"], tmp_path)
        assert not differing(tmp_path / "whole", tmp_path / "run"), f"killed after {moment} s"
        shutil.rmtree(tmp_path / "run")

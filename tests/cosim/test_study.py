"""Studies of a small system: the same table however it was computed, whoever was killed meanwhile."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import psutil
import pytest

import rockshed
from rockshed.core.errors import InputRefused
from rockshed.core.loop.instances import KeptInstances
from rockshed.core.run import simulate, simulate_in_memory
from rockshed.runs.batch import slim
from rockshed.runs.job import prepare
from rockshed.runs.request import Request

pytestmark = pytest.mark.usefixtures("own_fmus")

VARY = {"rock.velocity0.y": [-4.0, -6.0, -8.0], "sand.modulus": [2e6, 4e6]}
STOP = {"stop_time": 0.002}

_STUDY = """
import sys
import rockshed

if __name__ == "__main__":
    vary = {"rock.velocity0.y": [-4.0, -6.0, -8.0], "sand.modulus": [2e6, 4e6]}
    found = rockshed.study(
        "lab-impact", vary, options={"stop_time": float(sys.argv[2])}, workers=2,
        folder=sys.argv[1], progress=lambda stage, done, total: print(stage, done, flush=True),
    )
"""


@pytest.fixture(scope="module")
def alone(own_fmus, tmp_path_factory):
    """The study in one go on one process."""
    folder = tmp_path_factory.mktemp("alone") / "study"
    return rockshed.study("lab-impact", VARY, options=STOP, workers=1, folder=folder)


def table(folder):
    return (folder / "runs.csv").read_text()


def started(tmp_path, stop):
    script = tmp_path / "study.py"
    script.write_text(_STUDY)
    return subprocess.Popen(
        [sys.executable, str(script), str(tmp_path / "study"), str(stop)],
        stdout=subprocess.PIPE,
        text=True,
    )


def after_a_run(process):
    return any(line.startswith("runs ") and line.split()[1] != "0" for line in process.stdout)


def workers_of(process):
    """Processes that carry out runs, and not the one that looks after shared memory."""
    children = psutil.Process(process.pid).children(recursive=True)
    return [child for child in children if "spawn_main" in " ".join(child.cmdline())]


def test_a_study_on_two_processes_has_the_table_of_one_process(alone, tmp_path):
    rockshed.study("lab-impact", VARY, options=STOP, workers=2, folder=tmp_path / "two")
    assert table(tmp_path / "two") == table(alone.folder)
    assert not (tmp_path / "two" / ".finished-runs").exists()


def test_a_run_of_a_study_has_the_numbers_of_a_run_by_itself(alone):
    last = alone.records.runs[-1]
    system = rockshed.case("lab-impact", values=dict(last.inputs), **STOP)
    found = rockshed.simulate(system).metrics
    assert last.metrics["penetration"] == found["penetration"].value
    assert last.metrics["peak_transmitted_force"] == found["peak_transmitted_force"].value


@pytest.mark.slow
def test_a_study_whose_worker_is_killed_loses_nothing(tmp_path):
    process = started(tmp_path, 0.1)
    assert after_a_run(process)
    os.kill(workers_of(process)[0].pid, signal.SIGKILL)
    assert process.wait(timeout=300) == 0
    rockshed.study("lab-impact", VARY, options={"stop_time": 0.1}, folder=tmp_path / "whole")
    assert table(tmp_path / "study") == table(tmp_path / "whole")


def test_a_study_that_is_killed_goes_on_and_has_the_table_of_one_in_one_go(tmp_path, alone):
    process = started(tmp_path, 0.002)
    assert after_a_run(process)
    process.kill()
    process.wait(timeout=60)
    kept = list((tmp_path / "study" / ".finished-runs").glob("run-*.npz"))
    assert kept or (tmp_path / "study" / "runs.csv").is_file()
    said = []
    rockshed.study(
        "lab-impact", VARY, options=STOP, workers=1, folder=tmp_path / "study", note=said.append
    )
    assert not kept or any("have ended before" in text for text in said)
    assert table(tmp_path / "study") == table(alone.folder)


def test_a_value_that_an_fmu_refuses_is_refused_before_anything_runs(tmp_path):
    began = time.monotonic()
    with pytest.raises(InputRefused, match=r"design 2 .*sand.friction_angle"):
        rockshed.study(
            "lab-impact",
            {"sand.friction_angle": [0.5, 9.0]},
            options={"stop_time": 5.0},
            workers=1,
            folder=tmp_path / "study",
        )
    assert time.monotonic() - began < 200.0
    assert not (tmp_path / "study").exists()


def test_runs_that_fail_are_counted_and_the_others_told(tmp_path):
    found = rockshed.study(
        "lab-impact",
        {"rock.position0.y": [0.5, 0.01]},
        options=STOP,
        workers=1,
        folder=tmp_path / "s",
    )
    assert [run.status for run in found.records.runs] == ["complete", "failed"]
    assert "1 of 2 runs have no result" in found.warnings[0]


def test_the_report_of_a_study_has_its_tables(alone):
    (page,) = rockshed.report(alone.folder)
    assert "spread of the means" in page.read_text()
    facts = json.loads((alone.folder / "run.json").read_text())
    assert facts["kind"] == "study"


# ------------------------------------------------------------------ instances that are kept


def system(speed):
    job = prepare(Request("lab-impact", {"rock.velocity0.y": speed}, options=STOP))
    return slim(job.system, None)


def same(first, second):
    return all(np.array_equal(first.series[name], second.series[name]) for name in second.series)


def test_runs_of_kept_instances_have_the_bits_of_new_ones(tmp_path):
    instances = KeptInstances()
    for number, speed in enumerate((-8.0, -3.0, -8.0)):
        found = simulate_in_memory(system(speed), instances)
        assert same(found, simulate(system(speed), tmp_path / f"run-{number}"))
    assert len(instances._waiting) == 3
    instances.close()


def test_sand_that_has_settled_does_not_settle_again(monkeypatch):
    instances = KeptInstances()
    simulate_in_memory(system(-8.0), instances)
    known = [kept for listed in instances._settled.values() for kept in listed]
    assert len(known) == 1
    simulate_in_memory(system(-3.0), instances)
    assert [kept for listed in instances._settled.values() for kept in listed] == known
    instances.close()


def test_an_instance_that_a_reset_does_not_make_anew_is_replaced(tmp_path):
    instances = KeptInstances()
    simulate_in_memory(system(-8.0), instances)
    for kept in instances._waiting.values():
        kept.fresh = b"it began otherwise"
    before = {id(kept.slave) for kept in instances._waiting.values()}
    found = simulate_in_memory(system(-3.0), instances)
    assert same(found, simulate(system(-3.0), tmp_path / "run"))
    assert len(before) == 3
    assert all(kept.fresh != b"it began otherwise" for kept in instances._waiting.values())
    instances.close()

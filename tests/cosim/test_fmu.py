"""FMU files: a stranger's and our own, in both ways to carry out exchanges."""

import gc
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.fmu.fmu_slave import FmuFile, read_description
from rockshed.core.fmu.slave import BOOLEAN, DISCARD, ERROR, INTEGER, OK
from rockshed.core.results.reading import read_run
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from tests.cosim.mocks import Mock, called_back, inp, mass, out

RING = [
    "a.force -> b.speed",
    "b.force -> a.speed",
    "a.next_level -> b.level",
    "b.next_level -> a.level",
    "a.disabled -> b.enabled",
    "b.disabled -> a.enabled",
]


def strangers(fmu, connections=(), **settings):
    parameters = settings.pop("parameters", {})
    data = {
        "name": "strangers",
        "components": {
            name: {"fmu": str(fmu), "parameters": parameters.get(name, {})} for name in "ab"
        },
        "connections": list(connections),
        "exchange_step": 0.1,
        "stop_time": 1.0,
        **settings,
    }
    return system_from(data)


def both_ways(system, folder, **rest):
    """The same run with calls back through Python, and with calls of the C functions."""
    return [
        simulate(system, folder / "back", sources=called_back(system), **rest),
        simulate(system, folder / "direct", **rest),
    ]


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_real_integer_and_boolean_values_travel_between_strangers(foreign, tmp_path, master):
    """Levels count up around the ring; one side is disabled by the other and vice versa; forces are -2 and +2 times each other."""
    system = strangers(foreign, RING, parameters={"b": {"damping": -0.5}}, master=master)
    for run in both_ways(system, tmp_path):
        a, b = run.series["a.next_level"], run.series["b.next_level"]
        assert run.series["a.local_time"] == pytest.approx(run.series["time"], abs=1e-12)
        if master == "sequential":
            assert a.tolist() == [0, *range(1, 20, 2)]
            assert b.tolist() == [0, *range(2, 21, 2)]
        else:
            assert a.tolist() == b.tolist() == [*range(11)]
        assert set(np.unique(run.series["a.disabled"])) <= {0.0, 1.0}


def test_both_ways_give_the_same_bits(foreign, rock_fmu, tmp_path):
    """Rock and a damper of its velocity, three rates, a power bond without work output, watched outputs."""
    parameters = {"position0.x": 0.1, "velocity0.x": 3.7, "mass": 1.3, "internal_step": 3e-4}
    data = {
        "name": "pair",
        "exchange_step": 1e-3,
        "stop_time": 0.12,
        "output_interval": 2e-3,
        "state_interval": 2e-2,
        "components": {
            "rock": {
                "fmu": str(rock_fmu),
                "step": 5e-4,
                "parameters": parameters,
                "record_states": True,
            },
            "damper": {"fmu": str(foreign), "step": 2e-3, "parameters": {"damping": 17.3}},
        },
        "connections": ["rock.position.x -> damper.speed", "damper.force -> rock.force.x"],
        "bonds": {
            "x": {
                "giver": "damper",
                "force": ["force"],
                "taker": "rock",
                "position": ["position.x"],
            }
        },
        "watch": ["rock.velocity.x", "damper.force"],
    }
    for master in ("sequential", "jacobi"):
        back, direct = both_ways(system_from({**data, "master": master}), tmp_path)
        assert len(back.series) == len(direct.series) > 15
        for name, values in back.series.items():
            assert values.tobytes() == direct.series[name].tobytes(), name
        assert list(back.states("rock")) == list(direct.states("rock"))
        keep = [m for m in back.metrics.values() if "wall time" not in m.name]
        assert keep == [m for m in direct.metrics.values() if "wall time" not in m.name]
        assert abs(back.series["coupling.x.energy"][-1]) > 1e-4


def test_the_same_as_fmpy_alone(rock_fmu, tmp_path):
    """One FMU with constant inputs under our master and under fmpy's own."""
    from fmpy import simulate_fmu

    start = {"velocity0.x": 2.0, "force.x": 3.0, "torque": 0.01}
    system = system_from(
        {
            "name": "one",
            "components": {"rock": {"fmu": str(rock_fmu), "parameters": start}},
            "exchange_step": 1e-3,
            "stop_time": 0.05,
        }
    )
    ours = simulate(system, tmp_path / "run").series
    theirs = simulate_fmu(
        str(rock_fmu),
        stop_time=0.05,
        step_size=1e-3,
        output_interval=1e-3,
        start_values=start,
        output=["position.x", "position.y", "angle"],
    )
    for name in ("position.x", "position.y", "angle"):
        assert theirs[name] == pytest.approx(ours[f"rock.{name}"], abs=1e-15)


def test_a_recorded_state_goes_on_bit_for_bit_in_a_new_slave(rock_fmu, tmp_path):
    system = system_from(
        {
            "name": "one",
            "components": {
                "rock": {
                    "fmu": str(rock_fmu),
                    "record_states": True,
                    "parameters": {"force.x": 3.0, "velocity0.x": 0.3},
                }
            },
            "exchange_step": 1e-3,
            "stop_time": 0.02,
            "state_interval": 0.01,
        }
    )
    run = simulate(system, tmp_path / "run")
    time, state = list(run.states("rock"))[1]
    description = read_description(FmuFile(rock_fmu).model_description())
    slave = FmuFile(rock_fmu).instantiate("another")
    assert (
        max(
            slave.setup_experiment(0.0, 1.0),
            slave.enter_initialisation(),
            slave.exit_initialisation(),
        )
        == 0
    )
    slave.restore(state)
    for n in range(10):
        assert slave.step(time + n * 1e-3, 1e-3) == 0
    values = np.zeros(1)
    for name in ("position.x", "position.y", "velocity.x"):
        slave.get(np.array([description.ports[name].reference], np.uint32), values)
        assert values[0] == run.series[f"rock.{name}"][-1]
    slave.free()


def test_rollback_of_a_stranger(foreign):
    """Back to an earlier state and forward again: the same output; a state that is none is refused."""
    slave = FmuFile(foreign).instantiate("a")
    description = read_description(FmuFile(foreign).model_description())
    ports = {
        name: np.array([port.reference], np.uint32) for name, port in description.ports.items()
    }
    values = np.zeros(1)
    assert (
        max(
            slave.setup_experiment(0.0, 1.0),
            slave.enter_initialisation(),
            slave.exit_initialisation(),
        )
        == 0
    )
    slave.set(ports["speed"], np.array([2.0]))
    slave.set(ports["level"], np.array([4.0]), INTEGER)
    slave.set(ports["enabled"], np.array([1.0]), BOOLEAN)
    slave.step(0.0, 0.1)
    state = slave.state()
    slave.set(ports["speed"], np.array([5.0]))
    slave.step(0.1, 0.1)
    slave.get(ports["force"], values)
    assert values[0] == -10.0
    slave.restore(state)
    for name, kind, expected in (
        ("force", "Real", -4.0),
        ("next_level", INTEGER, 5.0),
        ("speed", "Real", 2.0),
        ("disabled", BOOLEAN, 0.0),
    ):
        slave.get(ports[name], values, kind)
        assert values[0] == expected, name
    slave.free()


def test_a_damaged_state_is_refused_and_a_sound_one_still_taken(rock_fmu):
    """pythonfmu's binary returns OK for both; the FMU logs an error."""
    slave = FmuFile(rock_fmu).instantiate("rock")
    assert (
        max(
            slave.setup_experiment(0.0, 1.0),
            slave.enter_initialisation(),
            slave.exit_initialisation(),
        )
        == OK
    )
    state = slave.state()
    with pytest.raises(RuntimeError, match=r"rock: the state cannot be restored: .*damaged"):
        slave.restore(state[:-1] + bytes([state[-1] ^ 1]))
    assert [status for status, _ in slave.messages] == [ERROR]
    assert slave.step(0.0, 1e-3) == DISCARD
    slave.restore(state)
    assert slave.step(0.0, 1e-3) == OK
    slave.free()


@pytest.mark.parametrize("sources", [called_back, lambda system: {}], ids=["back", "direct"])
def test_a_strangers_failure_is_told_in_its_own_words(foreign, tmp_path, sources):
    system = strangers(foreign, RING, parameters={"b": {"fail_at": 0.55}})
    with pytest.raises(
        RunFailed,
        match=r"b at t = 0\.5 s: the step by 0\.1 s failed \(Discard\): the damper is broken",
    ):
        simulate(system, tmp_path / "run", sources=sources(system))
    kept = read_run(tmp_path / "run")
    assert (kept.status, kept.series["time"][-1]) == ("failed", 0.5)


@pytest.mark.parametrize("sources", [called_back, lambda system: {}], ids=["back", "direct"])
def test_a_strangers_nan_is_found_where_it_comes_from(foreign, tmp_path, sources):
    system = strangers(foreign, RING, parameters={"a": {"nan_at": 0.75}})
    with pytest.raises(RunFailed, match=r"a at t = 0\.8 s: a\.force is no finite number"):
        simulate(system, tmp_path / "run", sources=sources(system))


def test_an_error_logged_in_the_initialisation_is_a_refusal(foreign, tmp_path):
    """pythonfmu cannot return an error there. Percent signs of the message do no harm."""
    parameters = {"a": {"refuses": True, "label": "this one"}, "b": {"refuses": "yes"}}
    with pytest.raises(InputRefused) as refusal:
        simulate(strangers(foreign, RING, parameters=parameters), tmp_path / "run")
    assert [str(problem) for problem in refusal.value.problems] == [
        "a: this one is 100% unwilling: %s %d",
        "b: none is 100% unwilling: %s %d",
    ]
    assert list(tmp_path.iterdir()) == []


def test_a_slave_in_python_beside_an_fmu(foreign, tmp_path):
    """The loop cannot be compiled then, and the run is the same."""
    system = strangers(foreign, ["b.y -> a.speed", "a.force -> b.x"])
    relay = Mock(
        [inp("x"), out("y"), out("local_time")],
        lambda v, t, h: v.update({"y": t + h, "local_time": t + h}),
    )
    run = simulate(
        system.model_copy(update={"record": ["a.force"]}), tmp_path / "run", sources={"b": relay}
    )
    assert run.series["a.force"] == pytest.approx(
        [0.0] + [-2.0 * n * 0.1 for n in range(10)], abs=1e-12
    )


def test_unpacked_files_are_removed(foreign, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    simulate(strangers(foreign), tmp_path / "run")
    with pytest.raises(InputRefused):
        simulate(strangers(foreign, parameters={"a": {"refuses": True}}), tmp_path / "run")
    gc.collect()
    assert list((tmp_path / "temporary").iterdir()) == []


STEP = """
import sys
from pathlib import Path
from rockshed.core.fmu.fmu_slave import FmuFile
slave = FmuFile(Path(sys.argv[1])).instantiate("one")
print(max(slave.setup_experiment(0.0, 1.0), slave.enter_initialisation(), slave.exit_initialisation(), slave.step(0.0, 0.1)))
slave.free()
"""


def test_any_name_of_the_temporary_folder_will_do(foreign, rock_fmu, tmp_path):
    """pythonfmu's binary ends the process where it gets an escaped path, as URIs have."""
    folder = tmp_path / "Müller #1 %41"
    folder.mkdir()
    for fmu in (foreign, rock_fmu):
        done = subprocess.run(
            [sys.executable, "-c", STEP, fmu],
            env=os.environ | {"TMPDIR": str(folder), "TEMP": str(folder)},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert (done.returncode, done.stdout) == (0, "0\n"), done.stderr
    assert list(folder.iterdir()) == []


def test_but_for_one_that_is_refused(rock_fmu, tmp_path, monkeypatch):
    """Spaces are the only escaped characters that pythonfmu's binary knows: it takes this name for another."""
    folder = tmp_path / "a%20b"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    with pytest.raises(
        InputRefused, match=r"a%20b.* has %20 in its name: set TMPDIR to another one"
    ):
        FmuFile(rock_fmu).instantiate("rock")
    assert list(folder.iterdir()) == []


def test_the_provenance_names_the_files(foreign, tmp_path):
    import hashlib

    told = simulate(strangers(foreign), tmp_path / "run").provenance["components"]["a"]
    assert told["fmu"] == str(foreign)
    assert told["sha256"] == hashlib.sha256(Path(foreign).read_bytes()).hexdigest()
    assert told["guid"]
    assert told["parameters"]["refuses"] == {"value": False, "unit": "1"}


def test_a_library_that_cannot_be_loaded(foreign, tmp_path):
    import zipfile

    broken = tmp_path / "Broken.fmu"
    with zipfile.ZipFile(foreign) as old, zipfile.ZipFile(broken, "w") as new:
        for name in old.namelist():
            new.writestr(name, b"no library" if name.startswith("binaries/") else old.read(name))
    with pytest.raises(InputRefused, match=r"a: no instance of .*Broken\.fmu can be made"):
        simulate(strangers(broken), tmp_path / "run")
    assert not (tmp_path / "run").exists()
    assert Path.cwd().is_dir()


def test_values_of_integers_and_enumerations_reach_an_fmu(rock_fmu, tmp_path):
    system = system_from(
        {
            "name": "one",
            "components": {
                "rock": {
                    "fmu": str(rock_fmu),
                    "parameters": {
                        "shape": "disc",
                        "mass": 2.0,
                        "radius": 0.5,
                        "angular_velocity0": 2.0,
                        "velocity0.y": 0.0,
                    },
                }
            },
            "exchange_step": 1e-3,
            "stop_time": 1e-3,
        }
    )
    run = simulate(system, tmp_path / "run")
    assert run.provenance["components"]["rock"]["parameters"]["shape"]["value"] == "disc"
    assert run.series["rock.energy.kinetic"][0] == pytest.approx(
        0.5 * (0.5 * 2.0 * 0.5**2) * 2.0**2
    )


def test_masses_of_mocks_and_files_alike(tmp_path):
    """A source given for a component replaces its file, which need not exist."""
    system = system_from(
        {
            "name": "one",
            "components": {"m": {"fmu": "nowhere.fmu"}},
            "exchange_step": 0.1,
            "stop_time": 1.0,
        }
    )
    assert simulate(system, tmp_path / "run", sources={"m": mass(velocity=2.0)}).series[
        "m.position"
    ][-1] == pytest.approx(2.0)

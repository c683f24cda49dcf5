"""The state is complete: going back and moving to another process continue bit for bit; a damaged one is refused."""

import pickle
import struct
import zlib

import numpy as np
import pytest

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.component import ComponentError
from rockshed.fmus.parts import Runtime
from rockshed.fmus.python.slave import component_state

from .host import DISCARD, Host
from .host3 import Host3


@pytest.fixture(params=list(Runtime))
def fmus(request):
    return request.getfixturevalue(f"{request.param}_fmus")


DRIVE = {"RBSMBeam": {"force.y[2]": -1e3}, "ImpulsiveGround": {"force.y": -5e3}}
"""What makes a component move that rests by itself."""

CONTINUE = """
import pickle, sys
from tests.fmu.host import Host
state, step = pickle.load(open(sys.argv[2], "rb"))
host = Host(sys.argv[1])
host.restore(state)
host.steps(5, step, first=5)
pickle.dump((host.outputs(), host.state()), open(sys.argv[2], "wb"))
host.close()
"""


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_rollback_is_exact(fmus, name):
    with Host(fmus[name]) as host:
        step = float(host.description.defaultExperiment.stepSize)
        host.start(**DRIVE.get(name, {})).steps(5, step)
        saved, before = host.state(), host.outputs()
        host.steps(5, step, first=5)
        expected = host.outputs(), host.state()
        host.restore(saved)
        assert host.outputs() == before
        host.steps(5, step, first=5)
        assert (host.outputs(), host.state()) == expected
        assert expected[0] != before


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_a_state_moved_to_another_process_continues_exactly(fmus, python, tmp_path, name):
    file = tmp_path / "state"
    with Host(fmus[name]) as host:
        step = float(host.description.defaultExperiment.stepSize)
        host.start(**DRIVE.get(name, {})).steps(5, step)
        file.write_bytes(pickle.dumps((host.state(), step)))
        python(CONTINUE, fmus[name], file)
        host.steps(5, step, first=5)
        assert pickle.loads(file.read_bytes()) == (host.outputs(), host.state())


YIELDING = {
    "section.bending": 2,
    "section.corner1.moment": 20.0,
    "section.corner2.moment": 30.0,
    "section.corner2.curvature": 1e-3,
    "supports": 2,
    "damping.stiffness": 1e-7,
}


def bent(host):
    """A beam that has yielded and is pushed back."""
    host.start(**YIELDING, **{f"force.y[{i}]": -1e4 for i in range(8, 17)}).steps(20, 1e-5)
    assert host["energy.plastic"] > 0.0
    for i in range(8, 17):
        host[f"force.y[{i}]"] = 2e4
    return host


def test_a_yielding_beam_goes_back_and_on_exactly(fmus):
    with Host(fmus["RBSMBeam"]) as host:
        saved = bent(host).state()
        host.steps(20, 1e-5, first=20)
        expected = host.outputs(), host.state()
        host.restore(saved)
        host.steps(20, 1e-5, first=20)
        assert (host.outputs(), host.state()) == expected
        assert expected[0]["plastic_curvature[12]"] != 0.0


def test_a_yielding_beam_has_the_same_bits_in_every_fmu(python_fmus, native_fmus, fmi3_fmus):
    found = []
    for kind, built in ((Host, python_fmus), (Host, native_fmus), (Host3, fmi3_fmus)):
        with kind(built["RBSMBeam"]) as host:
            saved = bent(host).state()
            host.steps(20, 1e-5, first=20)
            found.append(host.state())
            host.restore(saved)
            host.steps(20, 1e-5, first=20)
            assert host.state() == found[-1]
    assert found[0] == found[1] == found[2]


def test_hostile_sliders_of_a_yielding_beam_never_give_a_result_that_is_none(fmus):
    with Host(fmus["RBSMBeam"]) as host:
        good = bent(host).state()
        instance = component("RBSMBeam").instance()
        instance.from_bytes(component_state(good))
        for value in (np.inf, np.nan, 1e300, -1e12):
            host.restore(good)
            host.messages.clear()
            sliders = instance.state("slipped")
            kept = sliders.copy()
            sliders[20] = value
            content = slave_state(good, instance.to_bytes())
            sliders[:] = kept
            host.restore(content)
            if np.isfinite(value):
                status = host.step(20e-5, 1e-5)
                finite = all(np.isfinite(v) for v in host.outputs().values() if v is not None)
                assert status == DISCARD or finite
            else:
                assert "not finite" in host.errors()[0]
        host.fmu.reset()


def slave_state(like, component):
    """The state of an FMU with another component in it."""
    content = like.replace(component_state(like), component)
    return content[:8] + struct.pack("<I", zlib.crc32(content[12:])) + content[12:]


def test_time_goes_back_with_the_state(fmus):
    with Host(fmus["Probe"]) as host:
        host.start().steps(5, 0.1)
        saved = host.state()
        host.steps(5, 0.1, first=5)
        host.restore(saved)
        assert host.step(1.0, 0.1) == host.refusal
        assert "the slave is at t = 0.5 s" in host.errors()[0]
        host.steps(5, 0.1, first=5)


def test_a_failed_step_can_be_taken_back_and_tried_again(fmus):
    with Host(fmus["Probe"]) as host:
        host.start(leak=1, inflow=9.0).steps(2, 0.5)
        saved = host.state()
        assert host.step(1.0, 0.5) == DISCARD
        host.restore(saved)
        host["inflow"] = 0.5
        host.steps(1, 0.5, first=2)
        assert host["level[1]"] == pytest.approx(9.25, rel=1e-14)


def test_a_state_of_the_initialization_mode_leads_back_into_it(fmus):
    with Host(fmus["Probe"]) as host:
        host.fmu.setupExperiment()
        host.fmu.enterInitializationMode()
        host["inflow"] = 2.0
        saved = host.state()
        host.fmu.exitInitializationMode()
        host.steps(1, 0.1)
        host.restore(saved)
        host["inflow"] = 3.0
        assert host["flow"] == 3.0
        host.fmu.exitInitializationMode()
        host.steps(1, 0.1)


def damaged(state, where):
    content = bytearray(state)
    content[where] ^= 1
    return bytes(content)


BAD_STATES = {
    "nothing": lambda state: b"",
    "noise": lambda state: b"\x01" * len(state),
    "cut short": lambda state: state[:-8],
    "too long": lambda state: state + b"\0" * 8,
    "a bit of the time": lambda state: damaged(state, 20),
    "a bit of a value": lambda state: damaged(state, len(state) // 2),
    "a bit of the table of arrays": lambda state: damaged(state, -9),
}


@pytest.mark.parametrize("what", BAD_STATES)
def test_a_bad_state_is_refused(fmus, what):
    with Host(fmus["Probe"], "tank") as host:
        host.start().steps(3, 0.1)
        saved, before = host.state(), host.outputs()
        host.restore(BAD_STATES[what](saved))
        assert "tank (Probe): this is no serialized state" in host.errors()[0]
        assert host.outputs() == before
        assert host.step(0.3, 0.1) == host.refusal
        host.restore(saved)
        host.steps(1, 0.1, first=3)


def test_a_state_of_another_component_or_size_is_refused(fmus):
    with Host(fmus["Probe"]) as tank, Host(fmus["FallingRock"]) as rock:
        tank.start()
        rock.start()
        tank.restore(rock.state())
        assert "no serialized state of this component with these sizes" in tank.errors()[0]
        assert tank.step(0.0, 0.1) == tank.refusal


def test_the_component_reads_the_state_of_its_fmu(fmus, probe):
    with Host(fmus["Probe"]) as host:
        host.start(inflow=1.0, **{"level0[2]": 4.0}).steps(3, 0.1)
        instance = probe.instance()
        instance.from_bytes(component_state(host.state()))
        assert np.array_equal(
            instance.state("hidden.level"), [host[f"level[{i}]"] for i in (1, 2, 3)]
        )
        assert instance["count"] == host["count"]
    with pytest.raises(ComponentError, match="no serialized state"):
        component_state(b"something else, long enough to be one")

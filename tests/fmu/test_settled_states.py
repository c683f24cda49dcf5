"""A state that was taken when its outputs were computed is not computed again after it is restored."""

import struct
import zlib

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.components.common.component import Instance
from rockshed.core.fmu.fmu_slave import read_description
from rockshed.fmus.in_process import InProcess
from rockshed.fmus.python.conduct import SETTLED, Phase


@pytest.fixture
def source():
    return InProcess(component("FallingRock"))


def initialising(source, mass=500.0):
    """A slave in initialisation mode, whose outputs are not computed yet."""
    slave = source.instantiate("rock")
    ports = read_description(source.model_description()).ports
    slave.references = {name: np.array([p.reference], np.uint32) for name, p in ports.items()}
    slave.set(slave.references["mass"], np.array([mass]))
    slave.setup_experiment(0.0, 1.0)
    slave.enter_initialisation()
    return slave


def value(slave, name):
    out = np.zeros(1)
    assert slave.get(slave.references[name], out) == 0
    return float(out[0])


@pytest.fixture
def computed(monkeypatch):
    """How often a state was computed."""
    calls = []
    whole = Instance.initialise
    monkeypatch.setattr(Instance, "initialise", lambda self: (calls.append(1), whole(self))[1])
    return calls


def test_a_settled_state_is_not_computed_again_whatever_inputs_follow(source, computed):
    first = initialising(source)
    expected = value(first, "energy.kinetic")
    assert len(computed) == 1
    second = initialising(source)
    second.restore(first.state())
    second.set(second.references["force.y"], np.array([7.0]))
    assert value(second, "energy.kinetic") == expected
    assert second.exit_initialisation() == 0
    assert second.step(0.0, 1e-3) == 0
    assert len(computed) == 1


def test_a_state_is_computed_again_after_a_parameter_was_set(source, computed):
    first = initialising(source)
    before = value(first, "energy.kinetic")
    second = initialising(source)
    second.restore(first.state())
    second.set(second.references["mass"], np.array([1000.0]))
    assert value(second, "energy.kinetic") == pytest.approx(2.0 * before)
    assert len(computed) == 2


def test_a_state_that_was_not_computed_yet_says_so(source, computed):
    slave = initialising(source)
    assert phase_of(slave.state()) == Phase.INITIALISING
    value(slave, "energy.kinetic")
    assert phase_of(slave.state()) == Phase.INITIALISING | SETTLED
    slave.exit_initialisation()
    assert phase_of(slave.state()) == Phase.RUNNING


@pytest.mark.parametrize("phase", [p | SETTLED for p in Phase if p != Phase.INITIALISING])
def test_no_other_phase_can_have_settled(source, phase):
    slave = initialising(source)
    state = slave.state()
    content = struct.pack("<I", phase) + state[16:]
    damaged = struct.pack("<8sI", state[:8], zlib.crc32(content)) + content
    with pytest.raises(RuntimeError, match="phase"):
        slave.restore(damaged)


def phase_of(state):
    return struct.unpack_from("<I", state, 12)[0]

"""A component in this process behaves like its FMU."""

import timeit

import numpy as np
import pytest

from rockshed.components.catalogue import NAMES, component
from rockshed.core.fmu.fmu_slave import FmuFile, read_description
from rockshed.fmus.in_process import InProcess, slave_class


@pytest.mark.parametrize("name", NAMES)
def test_description_values_and_state_are_those_of_the_fmu(fmus, name):
    sources = InProcess(component(name)), FmuFile(fmus[name])
    assert sources[0].model_description() == sources[1].model_description()
    ports = read_description(sources[0].model_description()).ports.values()
    references = np.array([p.reference for p in ports if p.kind == "Real"], np.uint32)
    results = []
    for source in sources:
        slave, values = source.instantiate("one"), np.zeros(references.size)
        assert [
            slave.setup_experiment(0.0, 1.0),
            slave.enter_initialisation(),
            slave.exit_initialisation(),
        ] == [0, 0, 0]
        assert [slave.step(i * 1e-5, 1e-5) for i in range(5)] == [0] * 5
        assert slave.get(references, values) == 0
        results.append((values.tolist(), slave.state(), slave.messages))
        slave.restore(slave.state())
        assert slave.terminate() == 0
        slave.free()
    assert results[0] == results[1]


@pytest.fixture
def tank(probe):
    source = InProcess(probe, {"tanks": 4})
    slave = source.instantiate("tank")
    slave.references = {
        name: np.array([port.reference], np.uint32)
        for name, port in read_description(source.model_description()).ports.items()
    }
    return slave


def test_types_are_converted(tank):
    for name, value, kind in (
        ("leak", 1.0, "Integer"),
        ("counting", 0.0, "Boolean"),
        ("first_count", 5.0, "Integer"),
    ):
        out = np.zeros(1)
        assert tank.set(tank.references[name], np.array([value]), kind) == 0
        assert tank.get(tank.references[name], out, kind) == 0
        assert out == [value]


def test_what_is_wrong_is_the_status_of_the_call_itself(tank):
    assert [
        tank.setup_experiment(0.0, 1.0),
        tank.enter_initialisation(),
        tank.exit_initialisation(),
    ] == [0, 0, 0]
    assert tank.set(tank.references["inflow"], np.array([np.nan])) == 3
    assert tank.step(0.0, 0.1) == 2
    assert "inflow = nan" in tank.messages[0][1]
    assert tank.reset() == 0
    with pytest.raises(RuntimeError, match="no serialized state"):
        tank.restore(b"nothing")
    assert tank.set_text(0, "x") == 3


DEBUGGING = """
from rockshed.components.catalogue import component
from rockshed.fmus.in_process import InProcess, slave_class
slave = InProcess(component("FallingRock")).instantiate("rock")
statuses = slave.setup_experiment(0.0, 1.0), slave.enter_initialisation(), slave.exit_initialisation(), slave.step(0.0, 1e-5)
assert statuses == (0, 0, 0, 0)
print(type(component("FallingRock").step).__name__)
"""


def test_the_code_runs_uncompiled_for_a_debugger(python):
    assert python(DEBUGGING, NUMBA_DISABLE_JIT="1").strip() == "function"


def test_references_in_any_order_are_nearly_as_fast_as_a_block(probe):
    slave = slave_class(probe, {"tanks": 50})(instance_name="tank")
    slave.setup_experiment(0.0, None, None)
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    first = slave._instance.references["extra[1]"]
    block = list(range(first, first + 50))
    scattered = [*block[25:], *block[:25]]

    values = [0.5 * i for i in range(50)]

    def exchange(references):
        slave.set_real(references, values)
        assert slave.get_real(references) == values

    times = {True: [], False: []}
    for _ in range(20):
        for ordered, references in ((True, block), (False, scattered)):
            times[ordered].append(
                timeit.timeit(lambda references=references: exchange(references), number=50)
            )
    assert min(times[False]) < 10 * min(times[True])

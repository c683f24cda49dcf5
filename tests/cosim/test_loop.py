"""The exchange loop in three forms side by side: as kept machine code, compiled by numba in this process, and call by call."""

import ctypes
import math

import numpy as np
import pytest

from rockshed.bench.exchange import relay
from rockshed.core.fmu.slave import BOOLEAN, INTEGER, REAL, Addresses
from rockshed.core.loop import compiled as loop
from rockshed.core.loop.exchange import CompiledDriver, PlainDriver, State
from rockshed.core.loop.initialisation import free, initialise, instantiate
from rockshed.core.loop.tables import NOT_FINITE
from rockshed.core.run import sources_of
from rockshed.core.system.plan import make_plan
from rockshed.core.system.system import system_from
from rockshed.fmus.build import BuildError, Runtime, build_component
from rockshed.fmus.native.fmu import compiler, own_platform
from tests.cosim.mocks import Mock, MockSlave, inp, mass, out, spring, wired

MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_uint), ctypes.c_size_t, ctypes.c_void_p
)
STEP = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int
)


class WithAddresses(MockSlave):
    """A mock whose calls are C functions as well."""

    def __init__(self, mock, name):
        super().__init__(mock, name)
        self._kept = {}
        for kind, number in (
            (REAL, ctypes.c_double),
            (INTEGER, ctypes.c_int),
            (BOOLEAN, ctypes.c_int),
        ):
            self._kept["set", kind], self._kept["get", kind] = (
                MOVE(self._setter(kind, number)),
                MOVE(self._getter(kind, number)),
            )
        self._kept["step"] = STEP(lambda _c, time, step, _k: self.step(time, step))

        def address(*key):
            return ctypes.cast(self._kept[key[0] if len(key) == 1 else key], ctypes.c_void_p).value

        kinds = (REAL, INTEGER, BOOLEAN)
        self.addresses = Addresses(
            1,
            {k: address("set", k) for k in kinds},
            {k: address("get", k) for k in kinds},
            address("step"),
        )

    def _setter(self, kind, number):
        def call(_c, references, n, values):
            given = (number * n).from_address(values)
            return self.set(list(references[:n]), np.array(given[:], float), kind)

        return call

    def _getter(self, kind, number):
        def call(_c, references, n, values):
            found = np.zeros(n)
            status = self.get(list(references[:n]), found, kind)
            (number * n).from_address(values)[:] = [
                number(int(v) if number is ctypes.c_int else v).value for v in found
            ]
            return status

        return call


class ByNumba(CompiledDriver):
    """The loop as numba compiles it, called by numba's own dispatcher."""

    def __init__(self, state, slaves):
        super().__init__(state, slaves)
        self._loop = lambda _head, first, count: loop.advance(
            self._tables._replace(row=len(self._waiting)), first, count
        )


def carried_out(driver, system, sources, parts):
    """Everything that a driver leaves behind after so many exchanges in each part, and its fault."""
    plan = make_plan(system, sources)
    slaves = instantiate(plan, sources)
    state = State(plan)
    initialise(plan, slaves, state)
    state.open_accounts()
    made, first, fault = driver(state, slaves), 0, None
    for count in parts:
        fault = made.advance(first, count)
        first += count
        if fault is not None:
            break
        state.snapshots.waiting.extend(state.snapshots.due(first - count, first))
    rows = state.snapshots.rows[: len(state.snapshots.waiting)].copy()
    free(slaves.values())
    return {
        "inputs": state.inputs,
        "outputs": state.outputs,
        "channels": state.channels,
        "watched": state.watched,
        "rows": rows,
        "fault": np.array(
            [fault.exchange, fault.operation.action, fault.status] if fault else [], float
        ),
    }


def assert_the_same(system, sources, parts=(1, 10, 49)):
    machine_code, by_numba, plain = (
        carried_out(driver, system, sources(), parts)
        for driver in (CompiledDriver, ByNumba, PlainDriver)
    )
    for name, found in machine_code.items():
        assert found.tobytes() == by_numba[name].tobytes(), name
        assert found.tobytes() == plain[name].tobytes(), name
    return machine_code


def counter():
    def step(v, t, h):
        v["level"], v["on"], v["wave"] = v["given"] + 1, v["level"] % 2, math.sin(40.0 * (t + h))

    return Mock(
        [
            inp("given", kind="Integer"),
            inp("enabled", kind="Boolean"),
            out("level", kind="Integer"),
            out("on", kind="Boolean"),
            out("wave", "m"),
        ],
        step,
    )


def callables(mocks):
    for mock in mocks.values():
        mock.instantiate = lambda name, mock=mock: WithAddresses(mock, name)
    return mocks


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_mocks_of_all_kinds_and_rates_give_the_same_bits(master):
    def sources():
        return callables(
            {
                "spring": spring(30.0, ends=2),
                "a": mass(1.0, position=1.0),
                "b": mass(3.0),
                "c": counter(),
                "d": counter(),
            }
        )

    system, _ = wired(
        sources(),
        [
            "spring.end1.force -> a.force",
            "spring.end2.force -> b.force",
            "a.position -> spring.end1.position",
            "b.position -> spring.end2.position",
            "c.level -> d.given",
            "d.level -> c.given",
            "c.on -> d.enabled",
        ],
        master=master,
        exchange_step=0.01,
        stop_time=1.2,
        output_interval=0.03,
        watch=["a.position", "c.wave"],
        components={"b": {"step": 0.02}, "a": {"step": 0.005}, "d": {"step": 0.03}},
        bonds={
            "one": {
                "giver": "spring",
                "force": ["end1.force"],
                "taker": "a",
                "position": ["position"],
            }
        },
    )
    found = assert_the_same(system, sources)
    assert len(found["rows"]) == 20
    assert abs(found["channels"]["taken"][0]) > 0.01
    assert found["watched"]["high"][1] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(("answer", "status"), [((3, "torn"), 3), (math.nan, NOT_FINITE)])
@pytest.mark.parametrize("exchanged", [True, False])
def test_the_first_bad_status_ends_all_three_in_the_same_place(answer, status, exchanged):
    def step(v, t, h):
        if t < 0.3:
            v["y"] = t
        elif isinstance(answer, tuple):
            return answer
        else:
            v["y"] = answer
        return None

    def sources():
        return callables({"a": Mock([out("y")], step), "b": Mock([inp("x")])})

    system, _ = wired(sources(), ["a.y -> b.x"] if exchanged else [], exchange_step=0.01)
    found = assert_the_same(system, sources)
    assert found["fault"][2] == status
    assert found["fault"][0] == pytest.approx(30, abs=1)
    assert len(found["rows"]) == 11  # those of the parts before


def test_native_fmus_give_the_same_bits(tmp_path):
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))
    file = build_component(relay(), destination=tmp_path, runtime=Runtime.NATIVE)
    system = system_from(
        {
            "name": "pair",
            "components": {name: {"fmu": str(file), "parameters": {"u[50]": 0.3}} for name in "ab"},
            "master": "jacobi",
            "connections": ["a.y[1..49] -> b.u[1..49]", "b.y[101..149] -> a.u[1..49]"],
            "exchange_step": 1e-3,
            "stop_time": 0.1,
            "watch": ["a.y[7]"],
        }
    )
    found = assert_the_same(system, lambda: sources_of(system))
    levels = found["rows"][:, 0]
    assert levels[0] < levels[12] < levels[-1] == 2.0  # each is half of the other one and one

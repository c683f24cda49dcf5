"""The exchange loop in three forms side by side: as kept machine code, compiled by numba in this
process, and call by call with numpy. Slaves in Python are called back."""

import math

import numpy as np
import pytest

from rockshed.bench.pair import COMPONENT as RELAY
from rockshed.core.loop import compiled as loop
from rockshed.core.loop.buses import Buses
from rockshed.core.loop.exchange import ExchangeLoop
from rockshed.core.loop.initialisation import free, initialise, instantiate
from rockshed.core.loop.tables import NOT_FINITE
from rockshed.core.run import sources_of
from rockshed.core.system.planning import make_plan
from rockshed.core.system.reading import system_from
from rockshed.fmus.build import BuildError, Runtime, build_component
from rockshed.fmus.native.fmu import compiler, own_platform
from tests.cosim.mocks import Mock, inp, mass, out, spring, wired
from tests.cosim.reference_loop import ReferenceLoop


class ByNumba(ExchangeLoop):
    """The loop as numba compiles it, called by numba's own dispatcher."""

    def __init__(self, buses, slaves):
        super().__init__(buses, slaves)
        self._loop = lambda _head, first, count: loop.advance(
            self._tables._replace(row=len(self._waiting)), first, count
        )


def carried_out(form, system, sources, parts):
    """Everything that a form of the loop leaves behind after so many exchanges in each part, and its fault."""
    plan = make_plan(system, sources)
    slaves = instantiate(plan, sources)
    buses = Buses(plan)
    initialise(slaves, buses)
    buses.open_accounts()
    made, first, fault = form(buses, slaves), 0, None
    assert made.record(0) is None
    buses.snapshots.waiting.append(0)
    for count in parts:
        fault = made.advance(first, count)
        first += count
        if fault is not None:
            break
        buses.snapshots.waiting.extend(buses.snapshots.due(first - count, first))
    rows = buses.snapshots.rows[: len(buses.snapshots.waiting)].copy()
    free(slaves.values())
    return {
        "inputs": buses.inputs,
        "outputs": buses.outputs,
        "channels": buses.channels,
        "watched": buses.watched,
        "rows": rows,
        "fault": np.array(
            [fault.exchange, fault.operation.action, fault.status] if fault else [], float
        ),
    }


def assert_the_same(system, sources, parts=(1, 10, 49)):
    machine_code, by_numba, reference = (
        carried_out(form, system, sources(), parts)
        for form in (ExchangeLoop, ByNumba, ReferenceLoop)
    )
    for name, found in machine_code.items():
        assert found.tobytes() == by_numba[name].tobytes(), name
        assert found.tobytes() == reference[name].tobytes(), name
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


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_mocks_of_all_kinds_and_rates_give_the_same_bits(master):
    def sources():
        return {
            "spring": spring(30.0, ends=2),
            "a": mass(1.0, position=1.0),
            "b": mass(3.0),
            "c": counter(),
            "d": counter(),
        }

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
    assert len(found["rows"]) == 21
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
        return {"a": Mock([out("y")], step), "b": Mock([inp("x")])}

    system, _ = wired(sources(), ["a.y -> b.x"] if exchanged else [], exchange_step=0.01)
    found = assert_the_same(system, sources)
    assert found["fault"][2] == status
    assert found["fault"][0] == pytest.approx(30, abs=1)
    assert len(found["rows"]) == 12  # the first one, and those of the parts before


def test_steps_of_sixtieths_of_a_second_give_the_same_bits():
    system, _ = wired(
        {"a": counter(), "b": counter()},
        ["a.level -> b.given", "b.level -> a.given"],
        exchange_step="1/60",
        stop_time=1.0,
        components={"b": {"step": "1/120"}},
    )
    assert_the_same(system, lambda: {"a": counter(), "b": counter()})


def test_native_fmus_give_the_same_bits(tmp_path):
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))
    file = build_component(RELAY, destination=tmp_path, runtime=Runtime.NATIVE)
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


def test_a_linear_connection_gives_an_input_factor_times_the_output_plus_offset():
    """The only inputs that change on their way; b is pushed by half the force on a, and 3 N."""

    def sources():
        return {"spring": spring(30.0), "a": mass(1.0, position=1.0), "b": mass(3.0)}

    system, _ = wired(
        sources(),
        [
            "spring.end1.force -> a.force",
            {"source": "spring.end1.force", "target": "b.force", "factor": 0.5, "offset": 3.0},
            "a.position -> spring.end1.position",
        ],
        exchange_step=0.01,
        stop_time=0.5,
        components={"b": {"step": 0.02}},
    )
    assert_the_same(system, sources, (1, 10, 39))
    plan = make_plan(system, sources())
    slaves = instantiate(plan, sources())
    buses = Buses(plan)
    initialise(slaves, buses)
    on_a, on_b = ([end.name for end in plan.inputs].index(name) for name in ("a.force", "b.force"))
    assert buses.inputs[on_b] == 0.5 * buses.inputs[on_a] + 3.0 == -12.0

"""Inputs that follow polynomials between exchanges."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rockshed.analyses.exchange_steps.run import converge_exchange
from rockshed.core import continuing
from rockshed.core import run as core
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.system.planning import make_plan
from rockshed.core.system.reading import system_from
from rockshed.core.system.schedule import make_schedule
from rockshed.runs.job import Job
from rockshed.runs.simulation import simulate
from rockshed.runs.system import System
from tests.cosim.mocks import Mock, inp, mass, out, spring, wired

SCHEMES = ("sequential", "jacobi")


def push(t):
    """Begins so smoothly that the first exchanges, which know too few values, make no error."""
    return t**4 * math.exp(-t)


def oscillator(wall, coupling, pushed):
    """A mass of 1 kg on a spring to a wall and one to another mass; it moves exactly while that one
    stands still and the push has the value of the middle of the step."""
    stiffness = wall + coupling
    frequency = math.sqrt(stiffness)

    def step(v, t, h):
        rest = (coupling * v["other"] + pushed(t + 0.5 * h)) / stiffness
        x, u = v["position"] - rest, v["velocity"]
        c, s = math.cos(frequency * h), math.sin(frequency * h)
        v["position"] = rest + c * x + s * u / frequency
        v["velocity"] = c * u - s * frequency * x

    return Mock([inp("other", "m"), out("position", "m"), out("velocity", "m/s")], step)


def two_oscillators(order, master, exchange=1 / 16):
    mocks = {"a": oscillator(5.0, 3.0, push), "b": oscillator(2.0, 3.0, lambda t: 0.0)}
    spec, sources = wired(
        mocks,
        ["a.position -> b.other", "b.position -> a.other"],
        exchange_step=exchange,
        stop_time=3.0,
        master=master,
        extrapolation=order,
        components={name: {"step": 1 / 1024} for name in mocks},
    )
    return System(Job("oscillators", spec, sources, {}))


@pytest.mark.parametrize(
    ("order", "master", "expected"),
    [
        (0, "jacobi", 1),
        (0, "sequential", 2),  # one of them sees the other late, the other one early by as much
        *((order, master, order + 1) for order in (1, 2) for master in SCHEMES),
    ],
)
def test_the_error_of_the_coupling_is_one_order_above_the_polynomial(order, master, expected):
    found = converge_exchange(two_oscillators(order, master), levels=4, watch=["a.position"])
    assert found.figures_followed[1].found.orders[-1] == pytest.approx(expected, abs=0.2)


def test_the_limit_is_the_exact_motion():
    def rates(t, state):
        x, u, y, w = state
        return [u, -8.0 * x + 3.0 * y + push(t), w, -5.0 * y + 3.0 * x]

    exact = solve_ivp(rates, (0, 3), [0, 0, 0, 0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    found = converge_exchange(two_oscillators(2, "jacobi"), levels=3, watch=["a.position"])
    assert found.figures_followed[1].values[-1] == pytest.approx(exact[0], rel=1e-5)


def signal(coefficients):
    """Shows a polynomial of time, starting with its value at 0."""

    def at(v, t):
        v["value"] = sum(c * t**k for k, c in enumerate(coefficients))

    def start(v):
        at(v, 0.0)

    return Mock([inp("unused"), out("value", "N")], lambda v, t, h: at(v, t + h), start)


def summing():
    """Adds up what it gets times its step: the impulse of a force."""

    def step(v, _t, h):
        v["impulse"] += v["force"] * h

    return Mock([inp("force", "N"), out("impulse")], step)


numbers = st.floats(-10.0, 10.0)


@settings(max_examples=40)
@given(
    coefficients=st.lists(numbers, min_size=1, max_size=3),
    master=st.sampled_from(SCHEMES),
    steps=st.sampled_from([(0.25, 0.25), (0.25, 0.0625), (0.25, 0.5), (0.5, 0.125), (1.0, 0.25)]),
    is_first=st.booleans(),
)
def test_the_impulse_of_a_polynomial_is_exact_once_enough_values_are_known(
    coefficients, master, steps, is_first
):
    of_source, of_target = steps
    names = ["signal", "sum"] if is_first else ["sum", "signal"]
    mocks = {"signal": signal(coefficients), "sum": summing()}
    spec, sources = wired(
        {name: mocks[name] for name in names},
        ["signal.value -> sum.force"],
        exchange_step=0.25,
        stop_time=6.0,
        output_interval=1.0,
        master=master,
        components={
            "sum": {"step": of_target, "extrapolation": 2},
            "signal": {"step": of_source},
        },
    )
    found = run(spec, sources)
    got = np.diff(found.series["sum.impulse"])[3:]
    whole = np.polynomial.Polynomial(coefficients).integ()
    assert got == pytest.approx(np.diff(whole(found.time))[3:], abs=1e-9, rel=1e-9)


def run(spec, sources):
    return simulate(System(Job("test", spec, sources, {})))


def spring_and_mass(**changes):
    """A mass of 1 kg with four steps in an exchange, on a spring of 9 N/m."""
    settings = {
        "exchange_step": 0.1,
        "stop_time": 2.0,
        "components": {"mass": {"step": 0.025, "extrapolation": 2}},
        "bonds": {
            "pull": {
                "giver": "spring",
                "force": ["end1.force"],
                "taker": "mass",
                "position": ["position"],
            }
        },
    }
    return wired(
        {"spring": spring(9.0), "mass": mass(1.0, position=1.0)},
        ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"],
        **{**settings, **changes},
    )


@pytest.mark.parametrize("master", SCHEMES)
@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_ledger_counts_the_work_of_the_force_that_was_set_in_each_step(order, master):
    found = run(*spring_and_mass(master=master, extrapolation=order))
    kinetic = 0.5 * found.series["mass.velocity"] ** 2
    assert found.series["coupling.pull.work.taker"] == pytest.approx(kinetic, abs=1e-12)


def test_a_giver_that_extrapolates_counts_the_work_of_each_of_its_steps():
    """A spring has given back what it holds, whatever way it was shown its end on."""
    changes = {"components": {"spring": {"step": 0.025, "extrapolation": 1}}}
    spec, sources = spring_and_mass(**changes)
    seen = []
    step = sources["spring"].step
    sources["spring"].step = lambda v, t=0.0, h=0.0: seen.append(v["end1.position"]) or step(v)
    found = run(spec, sources)
    held = 0.5 * 9.0 * (seen[-1] ** 2 - 1.0)
    assert found.series["coupling.pull.work.giver"][-1] == pytest.approx(held, rel=1e-12)


def test_the_system_makes_the_less_energy_the_higher_the_order():
    """A spring shows the force of its last step: only in short steps is that of the exchange."""

    def made(order):
        own = {"step": 0.1 / 256, "extrapolation": order}
        found = run(*spring_and_mass(components={"mass": own, "spring": own}, master="jacobi"))
        total = 0.5 * found.series["mass.velocity"] ** 2 + 4.5 * found.series["mass.position"] ** 2
        return np.abs(total - 4.5).max()

    assert made(0) > 2.0 * made(1) > 4.0 * made(2)


def forces_on(spec, sources):
    """What a component was given in each of its steps."""
    taken = []
    step = sources["sum"].step

    def noting(v, t, h):
        taken.append(v["force"])
        return step(v, t, h)

    sources["sum"].step = noting
    found = run(spec, sources)
    return np.array(taken), found


def watching(source, **settings):
    mocks = {"sum": summing(), "signal": source}
    return wired(
        mocks,
        ["signal.value -> sum.force"],
        exchange_step=1.0,
        stop_time=8.0,
        master="jacobi",
        components={"sum": {"step": 0.5, "extrapolation": 1}},
        **settings,
    )


def test_the_first_exchange_holds_as_one_value_alone_has_no_slope():
    taken, _ = forces_on(*watching(signal([3.0, 2.0])))
    middles = np.arange(0.25, 8.0, 0.5)
    assert list(taken[:2]) == [3.0, 3.0]
    assert taken[2:] == pytest.approx(3.0 + 2.0 * middles[2:])


def test_a_component_of_one_step_in_an_exchange_gets_the_mean_over_the_exchange():
    spec, sources = watching(signal([3.0, 2.0]))
    whole = spec.components["sum"].model_copy(update={"step": None})
    spec = spec.model_copy(update={"components": {**spec.components, "sum": whole}})
    taken, _ = forces_on(spec, sources)
    assert taken[1:] == pytest.approx(3.0 + 2.0 * np.arange(1.5, 8.0))


def test_what_a_connection_no_longer_delivers_is_not_extrapolated():
    fault = {"port": "sum.force", "kind": "frozen", "from": 3.0, "to": 5.0}
    taken, _ = forces_on(*watching(signal([0.0, 1.0]), scenario={"fault": [fault]}))
    assert list(taken[6:10]) == [3.0] * 4  # frozen, and before that a line
    assert list(taken[10:12]) == [5.0] * 2  # the first value of a new polynomial
    assert taken[12:] == pytest.approx(np.arange(6.25, 8.0, 0.5))


def test_a_discrete_output_that_changes_begins_the_polynomials_of_its_component_anew():
    def step(v, t, h):
        later = t + h
        v["value"] = later if later < 4.0 else 100.0 - later
        v["broken"] = float(later >= 4.0)

    ports = [inp("unused"), out("value", "N"), out("broken", kind="Boolean")]
    source = Mock(ports, step)
    spec, sources = watching(source, watch=["signal.broken"])
    taken, _ = forces_on(spec, sources)
    assert list(taken[8:10]) == [96.0] * 2
    assert taken[10:] == pytest.approx(100.0 - np.arange(5.25, 8.0, 0.5))


def test_a_factor_and_an_offset_change_the_values_that_polynomials_go_through():
    spec, sources = watching(signal([3.0, 2.0]))
    link = {"source": "signal.value", "target": "sum.force", "factor": -2.0, "offset": 1.0}
    spec = system_from({**spec.model_dump(exclude_none=True), "connections": [link]})
    taken, _ = forces_on(spec, sources)
    assert list(taken[:2]) == [-5.0] * 2
    assert taken[2:] == pytest.approx(-5.0 - 4.0 * np.arange(1.25, 8.0, 0.5))


def test_inputs_are_set_before_each_step_and_shown_where_a_bond_counts():
    def told(shows, scheme):
        made = make_schedule(["a", "b"], {"a": 4, "b": 2}, 4, scheme, {"b": shows})
        return [f"{o.action.name} {o.component} {o.begin} {o.length}" for o in made.operations[0]]

    assert told(False, "sequential")[3:] == [
        "SET b 0 2",
        "STEP b 0 2",
        "EXTRAPOLATE b 2 2",
        "STEP b 2 2",
        "GET b 0 0",
    ]
    assert told(True, "jacobi") == [
        "SET a 0 0",
        "SET b 0 2",
        "STEP a 0 4",
        "STEP b 0 2",
        "GET b 0 0",
        "EXTRAPOLATE b 2 2",
        "STEP b 2 2",
        "GET a 0 0",
        "GET b 0 0",
    ]


def test_inputs_that_cannot_be_extrapolated_are_refused_in_words():
    switch = Mock([inp("on", kind="Boolean"), out("x")])
    spec, sources = wired(
        {"switch": switch, "alone": mass()},
        [],
        components={"switch": {"extrapolation": 1}, "alone": {"extrapolation": 2}},
    )
    with pytest.raises(InputRefused) as refusal:
        make_plan(spec, sources)
    places = [problem.where for problem in refusal.value.problems]
    assert places == ["switch.extrapolation", "alone.extrapolation"]
    with pytest.raises(InputRefused, match="extrapolation"):
        wired({"a": mass()}, [], extrapolation=3)


def test_an_order_of_the_system_is_for_those_that_can():
    spec, sources = spring_and_mass(extrapolation=1, components={"spring": {"extrapolation": 0}})
    plan = make_plan(spec, sources)
    assert [plan.inputs[entry.place].name for entry in plan.extrapolated] == ["mass.force"]


@pytest.mark.parametrize("moment", [0.3, 0.9])
def test_a_run_that_goes_on_extrapolates_as_the_one_in_one_go(tmp_path, moment):
    whole, sources = spring_and_mass()
    core.simulate(whole, tmp_path / "whole", sources=sources)
    broken, sources = spring_and_mass()
    step = sources["mass"].step
    sources["mass"].step = lambda v, t, h: (3, "broken") if t >= moment - 1e-9 else step(v, t, h)
    with pytest.raises(RunFailed, match="broken"):
        core.simulate(broken, tmp_path / "ended", sources=sources, checkpoint_every=0.2)
    continuing.resume(continuing.find_stopped(tmp_path / "ended"), spring_and_mass()[1])
    name = "timeseries.parquet"
    assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "ended" / name).read_bytes()

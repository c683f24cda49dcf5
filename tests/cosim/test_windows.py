"""The implicit master over windows of several exchanges: courses of values are iterated."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.core.system.planning import make_plan
from tests.cosim.mocks import wired
from tests.cosim.test_extrapolation import oscillator, push
from tests.cosim.test_implicit import BONDS, pair, run

STEP = 1 / 512
"""Step (s) of the oscillators, in which they hold their inputs."""


def exact_position():
    def rates(t, state):
        x, u, y, w = state
        return [u, -8.0 * x + 3.0 * y + push(t), w, -5.0 * y + 3.0 * x]

    return solve_ivp(rates, (0, 3), [0] * 4, method="DOP853", rtol=1e-12, atol=1e-12).y[0, -1]


def oscillators(exchange, window, interpolation):
    """Two masses on springs, each exact while the other one stands still."""
    mocks = {"a": oscillator(5.0, 3.0, push), "b": oscillator(2.0, 3.0, lambda t: 0.0)}
    table = {
        "tolerance": 1e-10,
        "absolute": 1e-14,
        "window": window * exchange,
        "interpolation": interpolation,
        "input": "middle",
    }
    return wired(
        mocks,
        ["a.position -> b.other", "b.position -> a.other"],
        exchange_step=exchange,
        stop_time=3.0,
        master="implicit",
        iteration=table,
        components={name: {"step": STEP} for name in mocks},
    )


@pytest.mark.parametrize(
    ("window", "interpolation", "coarse", "expected"),
    [
        (1, 1, 1 / 8, 2.0),
        (4, 1, 1 / 8, 2.0),
        (4, 2, 1 / 8, 3.0),
        (2, 2, 1 / 4, 4.0),  # errors of a parabola cancel over a window of two exchanges
    ],
)
def test_the_error_of_the_coupling_is_one_order_above_the_interpolation(
    tmp_path, window, interpolation, coarse, expected
):
    errors = []
    for exchange in (coarse, coarse / 2):
        spec, sources = oscillators(exchange, window, interpolation)
        result = simulate(spec, tmp_path / f"{exchange}", sources=sources)
        errors.append(abs(result.series["a.position"][-1] - exact_position()))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(expected, abs=0.3)


def test_a_window_finds_what_its_exchanges_find_one_after_the_other(tmp_path):
    found = {}
    for window in (0.01, 0.05):
        table = {"tolerance": 1e-10, "window": window}
        system = pair(iteration=table, bonds=BONDS, watch=["b.position"])
        found[window] = run(tmp_path / f"{window}", system)
    one, five = found.values()
    assert five.provenance["iteration"]["window"] == 5
    assert sum(five.provenance["iteration"]["iterations"].values()) == 10
    assert five.time.tolist() == one.time.tolist()
    for name in ("a.position", "contact.a.force"):
        size = np.abs(one.series[name]).max()
        assert five.series[name] == pytest.approx(one.series[name], abs=1e-7 * size)


def test_a_longer_window_takes_fewer_iterations_in_all(tmp_path):
    counts = []
    for window in (0.01, 0.1):
        result = run(tmp_path / f"{window}", pair(iteration={"window": window}))
        told = result.provenance["iteration"]["iterations"]
        counts.append(sum(int(number) * count for number, count in told.items()))
    assert counts[1] < 0.6 * counts[0]


@pytest.mark.parametrize(
    ("table", "options", "said"),
    [
        ({"window": 0.025}, {}, "iteration.window: 0.025 s is no whole number of steps of 0.01 s"),
        ({"window": 0.03}, {"stop_time": 0.5}, "no whole number of steps of 0.03 s"),
        ({"interpolation": 2}, {}, "iteration.interpolation: is 2, and the window has one exch"),
        ({"window": 0.02, "interpolation": 3}, {}, "is 3, and the window has 2 exchanges"),
        (
            {"window": 0.02},
            {"scenario": {"set": [{"port": "contact.stiffness", "value": 1.0, "at": 0.1}]}},
            "a window of 2 exchanges",
        ),
    ],
)
def test_a_window_that_does_not_fit_is_refused(table, options, said):
    with pytest.raises(InputRefused) as refused:
        make_plan(*pair(iteration=table, **options))
    assert any(said in str(problem) for problem in refused.value.problems)


def test_a_fraction_of_a_second_is_a_window():
    system = pair(step="1/60", stop=0.5, iteration={"window": "1/20"})
    assert make_plan(*system).timing.window == 3


def test_a_window_of_another_master_says_nothing():
    plan = make_plan(*pair(iteration={"window": 0.05}, master="sequential"))
    assert plan.timing.window == 1
    assert plan.schedule.period == 1

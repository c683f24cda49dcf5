"""Orders of convergence: found where there is one, and not where there is none."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.analyses.exchange_steps.ladder import step_of
from rockshed.analyses.exchange_steps.orders import converged, halvings_for


def differences(values):
    return [a - b for a, b in pairwise(values)]


def sequence(order, limit=5.0, error=0.8, levels=5):
    return [limit + error * 2.0 ** (-order * level) for level in range(levels)]


@given(
    st.floats(0.5, 4.0),
    st.floats(-10.0, 10.0),
    st.one_of(st.floats(0.1, 2.0), st.floats(-2.0, -0.1)),
)
def test_order_errors_and_limit_of_an_exact_sequence_are_found(order, limit, error):
    values = sequence(order, limit, error)
    found = converged(differences(values), 10.0)
    assert found.order == pytest.approx(order, abs=1e-6)
    assert values[-1] - found.errors[-1] == pytest.approx(limit, abs=1e-6)
    assert found.errors[0] == pytest.approx(error, rel=1e-6)


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_the_step_for_an_accuracy_is_the_coarsest_that_has_it(order):
    found = converged(differences(sequence(order)), 5.0)
    for most in (0.7, 0.3, 0.11, 0.01, 1e-4):
        halvings = halvings_for(found, most)
        assert 0.8 * 2.0 ** (-order * halvings) <= most
        assert halvings == 0 or 0.8 * 2.0 ** (-order * (halvings - 1)) > most


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ([1.0, 0.0, 0.5, 0.25], "not monotone"),
        ([1.0, 0.9, 0.8, 0.7], "do not become smaller"),
        ([1.0, 0.9, 0.6, -0.2], "do not become smaller"),
        ([1.0, 0.6, 0.5, 0.49], "not settled"),
        ([1.0, 0.5, 0.0, -0.45], "no order to build on"),
        ([1.0, 0.5, 0.3, 0.3], "agree to rounding"),
        ([1.0, 0.5, math.nan, 0.3], "no value"),
    ],
)
def test_a_sequence_without_an_order_has_none_and_no_step_is_recommended(values, reason):
    found = converged(differences(values), 1.0)
    assert found.order is None
    assert reason in found.reason
    assert found.errors == ()
    assert halvings_for(found, 0.1) is None


def test_what_does_not_depend_on_the_step_has_no_error_at_any():
    found = converged([0.0, 1e-14, -1e-14], 1.0)
    assert (found.order, found.reason, found.errors) == (None, "", (0.0,) * 4)
    assert halvings_for(found, 0.01) == 0


@pytest.mark.parametrize(
    ("step", "steps"),
    [
        (1e-6, [1e-6, 1e-6, 5e-7, 2.5e-7]),  # ten of them in the first exchange step
        (2.5e-6, [2.5e-6, 2.5e-6, 2.5e-6, 1.25e-6]),
        (1e-5, [1e-5, 5e-6, 2.5e-6, 1.25e-6]),
        (2e-5, [2e-5, 1e-5, 5e-6, 2.5e-6]),  # slower than the exchange
    ],
)
def test_a_component_keeps_its_step_while_that_divides_the_exchange_step(step, steps):
    assert [step_of(step, 1e-5, level) for level in range(4)] == steps

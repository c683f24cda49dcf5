"""How much each exchange of a window counts for an input of a step in it."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.core.system.iterated import weights

PERIOD = 6
PARTS = st.fractions(0, 1, max_denominator=8)


def mean_of(power, begin, end):
    """Mean of time to a power over a step, exactly."""
    return (end ** (power + 1) - begin ** (power + 1)) / ((power + 1) * (end - begin))


@given(
    st.integers(0, PERIOD - 1),
    PARTS,
    PARTS,
    st.integers(1, 3),
    st.sampled_from((1, 2)),
    st.sampled_from(("begin", "middle", "end")),
)
def test_a_polynomial_up_to_the_order_of_the_interpolation_comes_back(
    exchange, one, other, order, every, moment
):
    """At the beginning and the end of a step as its value, in the middle as its mean."""
    begin, end = sorted((exchange + one, exchange + other))
    if begin == end:
        end += Fraction(1, 8) if end < exchange + 1 else 0
        begin -= Fraction(1, 8) if begin == end else 0
    counts = weights(moment, (float(begin), float(end)), every, PERIOD, order)
    assert not np.any(np.delete(counts, np.arange(0, PERIOD + 1, every)))
    for power in range(order + 1):
        found = float(counts @ np.arange(PERIOD + 1.0) ** power)
        middle = mean_of(power, begin, end)
        expected = {"begin": begin**power, "middle": middle, "end": end**power}[moment]
        assert found == pytest.approx(float(expected), rel=1e-9, abs=1e-9)


def test_a_value_at_an_exchange_is_the_value_that_was_shown_there():
    assert weights("end", (1.0, 2.0), 1, 4, 3).tolist() == [0.0, 0.0, 1.0, 0.0, 0.0]
    assert weights("begin", (1.0, 2.0), 1, 4, 2).tolist() == [0.0, 1.0, 0.0, 0.0, 0.0]


def test_a_source_that_shows_too_few_values_for_the_order_has_a_line():
    found = weights("middle", (0.0, 1.0), 2, 2, 3)
    assert found.tolist() == [0.75, 0.0, 0.25]

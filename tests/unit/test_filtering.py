"""Our low-pass filters against scipy's, and what they have to leave alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import butter, sosfilt, sosfilt_zi, sosfiltfilt

from orchestrator.filtering import fewest, looking_back, without_shift

RATE = 1e4


def curve(seed, length=400):
    return np.cumsum(np.random.default_rng(seed).normal(size=length)) + 5.0


@pytest.mark.parametrize("order", [2, 4, 6])
@pytest.mark.parametrize("cut_off", [60.0, 222.3, 1500.0, 4000.0])
def test_the_same_as_scipy(order, cut_off):
    sections, values = butter(order, cut_off, fs=RATE, output="sos"), curve(order)
    assert without_shift(values, cut_off, RATE, order) == pytest.approx(sosfiltfilt(sections, values), rel=1e-9, abs=1e-9)
    steady = values[0] * sosfilt_zi(sections)
    assert looking_back(values, cut_off, RATE, order) == pytest.approx(sosfilt(sections, values, zi=steady)[0], rel=1e-9, abs=1e-9)


@given(st.floats(-1e6, 1e6), st.floats(10.0, 4900.0), st.sampled_from([2, 4]))
def test_what_is_steady_stays_as_it_is(value, cut_off, order):
    values = np.full(60, value)
    assert looking_back(values, cut_off, RATE, order) == pytest.approx(values, rel=1e-7, abs=1e-9)
    assert without_shift(values, cut_off, RATE, order) == pytest.approx(values, rel=1e-7, abs=1e-9)


def test_too_few_values_are_refused():
    assert without_shift(np.ones(fewest(4)), 100.0, RATE, 4).size == 16
    with pytest.raises(ValueError, match="15 values, and more than 15 are needed"):
        without_shift(np.ones(15), 100.0, RATE, 4)

"""The low-pass filter of settled forces against scipy's, and what it has to leave alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import butter, sosfiltfilt

from rockshed.metrics.filtering import low_pass

RATE = 1e4
TIME = np.arange(400) / RATE


@pytest.mark.parametrize("cut_off", [150.0, 222.3, 500.0])
def test_the_same_as_scipys_filter_run_forwards_and_backwards(cut_off):
    pulse = np.exp(-(((TIME - 0.02) / 0.003) ** 2)) * (
        1.0 + 0.2 * np.sin(2.0 * np.pi * 2000.0 * TIME)
    )
    other = sosfiltfilt(butter(4, cut_off, fs=RATE, output="sos"), pulse)
    assert low_pass(TIME, pulse, cut_off) == pytest.approx(other, abs=5e-3)
    assert low_pass(TIME, pulse, cut_off).max() == pytest.approx(other.max(), rel=2e-3)


def test_a_sine_at_the_cut_off_keeps_half_of_its_height_and_its_phase():
    sine = np.sin(2.0 * np.pi * 250.0 * TIME)
    assert low_pass(TIME, sine, 250.0)[100:300] == pytest.approx(0.5 * sine[100:300], abs=2e-3)


@given(st.floats(-1e6, 1e6), st.floats(30.0, 4900.0))
def test_what_is_steady_stays_as_it_is(value, cut_off):
    assert low_pass(TIME, np.full(TIME.size, value), cut_off) == pytest.approx(
        np.full(TIME.size, value), rel=1e-9, abs=1e-9
    )


def test_rows_too_few_or_too_far_apart_have_none():
    assert low_pass(TIME[:1], TIME[:1], 100.0) is None
    assert low_pass(TIME, TIME, 0.5 * RATE) is None

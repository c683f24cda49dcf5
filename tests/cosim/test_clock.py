from fractions import Fraction

import pytest

from rockshed.core.system.clock import (
    PICOSECONDS,
    exact,
    fraction_near,
    seconds_in,
    ticks_per_second,
    to_seconds,
    to_ticks,
)


@pytest.mark.parametrize(
    ("seconds", "ticks"),
    [
        (1e-6, 10**6),
        (2.5e-7, 250_000),
        (0.1, 10**11),
        (1e-12, 1),
        (-0.5, -5 * 10**11),
        (9.765625e-6, 9_765_625),
    ],
)
def test_ticks_are_the_decimal_number_that_was_written(seconds, ticks):
    assert to_ticks(exact(seconds)) == ticks


def test_a_time_comes_back_as_the_float_that_was_written():
    times = [n / 1e5 for n in range(3000)]
    assert [to_seconds(to_ticks(exact(time))) for time in times] == times


def test_a_float_that_was_computed_counts_as_the_number_next_to_it():
    assert exact(157 * 0.1) == Fraction(157, 10)
    assert exact(3 * 0.1) == exact(0.3)
    assert exact(1.0 / 3.0 + 1.0 / 3.0) == Fraction(2, 3)


@pytest.mark.parametrize("n", [3, 30, 60, 144, 44_100, 48_000, 999_983])
def test_a_fraction_of_a_second_is_what_it_is_nearest_to(n):
    assert exact(1.0 / n) == Fraction(1, n)
    assert exact(50.0 / n) == Fraction(50, n)


@pytest.mark.parametrize("seconds", [1e-13, 0.123456789012345678, 1e-5 / 2.7182818284])
def test_a_time_that_is_neither_picoseconds_nor_a_fraction_is_refused(seconds):
    with pytest.raises(ValueError, match=f"{seconds!r} s is no whole number of picoseconds"):
        exact(seconds)


def test_decimal_times_are_counted_in_picoseconds_and_others_in_the_largest_tick_that_fits():
    assert ticks_per_second([exact(1e-5), exact(0.02)]) == PICOSECONDS
    assert ticks_per_second([exact(1 / 60), exact(1.0)]) == 60
    assert ticks_per_second([exact(1 / 60), exact(1e-3)]) == 3000


def test_times_of_sixtieths_are_right_to_the_last_bit_for_hours():
    rate = ticks_per_second([exact(1 / 60), exact(1e-3)])
    step = to_ticks(exact(1 / 60), rate)
    assert all(to_seconds(n * step, rate) == n / 60 for n in range(0, 10**6, 997))


def test_a_time_beyond_the_longest_is_refused():
    with pytest.raises(ValueError, match=r"1e\+07 s is beyond the longest time, 4\.61e\+06 s"):
        to_ticks(exact(1e7))


@pytest.mark.parametrize("text", ["1/0", "one/60", "1/" + "9" * 5000, "1e400/3", ""])
def test_a_text_that_is_no_time_is_refused(text):
    with pytest.raises(ValueError, match="is no time: write a number of seconds, or a fraction"):
        seconds_in(text)


def test_a_rounded_fraction_is_recognised():
    assert fraction_near(0.016666666667) == "1/60"
    assert fraction_near(0.0333) == ""  # rounded too far to tell
    assert fraction_near(0.017) == fraction_near(1e-5) == ""

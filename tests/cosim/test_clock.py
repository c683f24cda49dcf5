import pytest

from rockshed.core.system.clock import to_seconds, to_ticks


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
    assert to_ticks(seconds) == ticks


def test_a_time_comes_back_as_the_float_that_was_written():
    assert [to_seconds(to_ticks(n / 1e5)) for n in range(3000)] == [n / 1e5 for n in range(3000)]


def test_a_float_that_was_computed_counts_as_the_decimal_next_to_it():
    assert to_ticks(157 * 0.1) == 15_700_000_000_000
    assert to_ticks(3 * 0.1) == to_ticks(0.3)


def test_a_step_between_two_ticks_is_refused():
    for step in (1e-13, 1e-5 / 3.0):
        with pytest.raises(ValueError, match=f"{step!r} s is no whole number of picoseconds"):
            to_ticks(step)

"""Percentiles, their intervals, and the counts at lines and barriers."""

import numpy as np
import pytest

from rockshed.campaigns.statistics import envelope
from rockshed.metrics.percentiles import borne, percentile, proportion


@pytest.mark.parametrize(
    ("count", "share", "low", "high"),
    [
        (10, 0.5, 2, 9),  # tables of the sign test: 95 % from the 2nd to the 9th of 10
        (20, 0.5, 6, 15),  # 6th to 15th of 20
        (6, 0.5, 1, 6),  # six are the fewest
    ],
)
def test_ranks_of_the_bounds(count, share, low, high):
    ordered = np.arange(1.0, count + 1.0)  # each value is its rank
    found = percentile(ordered, share)
    assert (found.low, found.high) == (low, high)


def test_bounds_that_a_small_sample_does_not_have_are_missing():
    assert 0.95**71 > 0.025 > 0.95**72
    assert np.isnan(percentile(np.arange(71.0), 0.95).high)
    assert percentile(np.arange(72.0), 0.95).high == 71.0
    assert np.isnan(percentile(np.arange(5.0), 0.5).low)
    assert borne((0.5, 0.9, 0.95, 0.99), 71) == [0.5, 0.9]


@pytest.mark.slow
def test_the_interval_covers_the_percentile_as_often_as_it_says():
    sample, truth = np.random.default_rng(1), -np.log(0.1)
    found = [percentile(np.sort(sample.exponential(size=80)), 0.9) for _ in range(3000)]
    covered = np.mean([f.low <= truth <= f.high for f in found])
    assert 0.945 < covered < 0.985


def test_a_percentile_is_a_value_of_the_sample_not_exceeded_by_its_share():
    values = np.sort(np.random.default_rng(2).normal(size=1000))
    for share in (0.5, 0.9, 0.95, 0.99):
        found = percentile(values, share)
        assert found.low <= found.value <= found.high
        assert np.mean(values <= found.value) == pytest.approx(share)
    assert percentile(np.array([4.0]), 0.5).value == 4.0


def test_intervals_of_proportions():
    assert proportion(0, 200) == (0.0, pytest.approx(1.0 - 0.025 ** (1 / 200)))
    assert proportion(200, 200) == (pytest.approx(0.025 ** (1 / 200)), 1.0)
    low, high = proportion(8, 20)
    assert (low, high) == (
        pytest.approx(0.191, abs=5e-4),
        pytest.approx(0.639, abs=5e-4),
    )  # printed in tables of the binomial


def test_an_envelope_leaves_out_the_rocks_that_do_not_come_by():
    peaks = np.full((8, 3), -1.0, np.float32)
    peaks[:, 0] = np.arange(8.0)
    peaks[:2, 1] = 5.0, 6.0  # too few for a percentile
    made = envelope(peaks)
    np.testing.assert_array_equal(made["max"], [7.0, 6.0, np.nan])
    np.testing.assert_array_equal(made["p50"], [3.0, np.nan, np.nan])
    assert np.isnan(made["p99"]).all()

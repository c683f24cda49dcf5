"""Random variates against scipy's distributions, and their use in a trial."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from rockshed.components.common.counter_random import draw, stream, uniform
from rockshed.components.slope_rockfall.declarations import LOGNORMAL, NORMAL, TRIANGULAR, UNIFORM
from rockshed.components.slope_rockfall.records import OUTCOME
from rockshed.components.slope_rockfall.sampling import (
    normal_quantile,
    normal_tail,
    variate,
    widest,
)
from tests.slope_rocks import SLOPE, run_trials

MEAN, DEVIATION, TRUNCATION = 3.0, 0.7, 1.96
SIGMA = math.sqrt(math.log1p((DEVIATION / MEAN) ** 2))
EXACT = {
    NORMAL: stats.truncnorm(-TRUNCATION, TRUNCATION, MEAN, DEVIATION),
    UNIFORM: stats.uniform(MEAN - math.sqrt(3) * DEVIATION, 2 * math.sqrt(3) * DEVIATION),
    TRIANGULAR: stats.triang(0.5, MEAN - math.sqrt(6) * DEVIATION, 2 * math.sqrt(6) * DEVIATION),
}


@given(st.floats(1e-9, 1.0 - 1e-9))
def test_normal_quantile(p):
    assert normal_quantile(p) == pytest.approx(stats.norm.ppf(p), rel=1e-12, abs=1e-15)


@given(st.sampled_from(list(EXACT)), st.floats(0.0, 1.0, exclude_max=True))
def test_variates_are_quantiles_of_their_distribution(kind, u):
    assert variate(kind, MEAN, DEVIATION, normal_tail(TRUNCATION), u) == pytest.approx(
        EXACT[kind].ppf(u), rel=1e-9
    )


@given(st.floats(0.0, 1.0, exclude_max=True))
def test_lognormal_is_the_exponential_of_the_truncated_normal(u):
    exponent = stats.truncnorm(-TRUNCATION, TRUNCATION, math.log(MEAN) - SIGMA**2 / 2, SIGMA).ppf(u)
    assert variate(LOGNORMAL, MEAN, DEVIATION, normal_tail(TRUNCATION), u) == pytest.approx(
        math.exp(exponent), rel=1e-9
    )


@pytest.mark.parametrize("kind", [NORMAL, UNIFORM, LOGNORMAL, TRIANGULAR])
def test_no_variate_exceeds_the_widest(kind):
    largest = variate(kind, MEAN, DEVIATION, normal_tail(TRUNCATION), 1.0 - 2.0**-53)
    assert largest == pytest.approx(widest(kind, MEAN, DEVIATION, TRUNCATION), rel=1e-6)
    assert variate(kind, MEAN, 0.0, normal_tail(TRUNCATION), 0.3) == MEAN


def test_streams_are_uniform_and_independent():
    numbers = np.array(
        [[draw(np.uint64(stream(1, trial)), i) for i in range(20)] for trial in range(500)]
    )
    assert stats.kstest(numbers.ravel(), "uniform").pvalue > 1e-3
    assert abs(np.corrcoef(numbers[:-1].ravel(), numbers[1:].ravel())[0, 1]) < 0.05
    assert abs(np.corrcoef(numbers[:, :-1].ravel(), numbers[:, 1:].ravel())[0, 1]) < 0.05
    other = np.array([draw(np.uint64(stream(2, trial)), 0) for trial in range(500)])
    assert abs(np.corrcoef(numbers[:, 0], other)[0, 1]) < 0.2
    assert uniform(5, 3) == 0.4204264852742745  # packings of sand are made of these


def test_the_limit_speed_of_a_campaign_is_distributed_as_asked():
    instance = SLOPE.instance()
    instance.initialise()
    _, _, outcomes = run_trials(instance, 4000)
    exact = stats.truncnorm(-1.96, 1.96, 12.0, 2.0)
    assert stats.kstest(outcomes[:, OUTCOME.limit_speed], exact.cdf).pvalue > 1e-3

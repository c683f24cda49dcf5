"""What whole trials know beyond one trajectory: strata of a Latin hypercube, and barriers."""

import numpy as np
import pytest

from rockshed.components.common.counter_random import shuffled
from rockshed.components.slope_rockfall.declarations import UNIFORM
from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE, RESTED, STOPPED
from tests.slope_rocks import SLOPE, plane, run_trials


def example(**values):
    rock = SLOPE.instance()
    for name, value in values.items():
        rock[name.replace("__", ".")] = value
    rock.initialise()
    return rock


@pytest.mark.parametrize("count", [1, 2, 5, 64, 200, 1000])
def test_shuffling_is_a_permutation_with_an_order_of_its_own_for_each_key(count):
    orders = [[shuffled(i, count, key) for i in range(count)] for key in (7, 8)]
    assert all(sorted(order) == list(range(count)) for order in orders)
    assert count < 10 or orders[0] != orders[1]


@pytest.mark.parametrize("first", [0, 300])
def test_each_trial_of_a_hypercube_has_a_stratum_of_its_own(first):
    rock = example(hypercube=100, limit_speed__distribution=float(UNIFORM))
    _, _, outcomes = run_trials(rock, 100, first=first)
    share = (outcomes[:, OUTCOME.limit_speed] - 12.0) / (2.0 * np.sqrt(3.0)) / 2.0 + 0.5
    assert sorted(np.floor(100 * share)) == list(range(100))
    assert np.any(np.diff(share) < 0.0)
    assert 0.2 < np.std(100 * share % 1.0) < 0.4  # anywhere in its stratum


def test_a_hypercube_leaves_a_trial_a_function_of_its_number():
    rock = example(hypercube=100)
    _, _, together = run_trials(rock, 150)
    _, _, later = run_trials(rock, 50, first=100)
    np.testing.assert_array_equal(together[100:], later)


def test_the_mean_of_the_limit_speed_scatters_less_with_a_hypercube():
    def scatter(hypercube):
        rock = example(hypercube=hypercube)
        return np.std(
            [
                run_trials(rock, 50, seed=seed)[2][:, OUTCOME.limit_speed].mean()
                for seed in range(30)
            ]
        )

    assert scatter(50) < 0.1 * scatter(0)


WALL = [(60, 31, 60, 1000)]


def test_a_barrier_of_any_strength_stops_what_passes_below_its_reach():
    rock = example()
    free, _, _ = run_trials(rock, 500, lines=WALL)
    passages, _, outcomes = run_trials(rock, 500, lines=WALL, barriers=[(3.0, 1e12)])
    low = free[:, 0, PASSAGE.y] - 31.0 <= 3.0
    arrived = free[:, 0, PASSAGE.count] > 0
    stopped = outcomes[:, OUTCOME.end] == STOPPED
    np.testing.assert_array_equal(stopped, low & arrived)
    assert 20 < stopped.sum() < arrived.sum()
    np.testing.assert_array_equal(outcomes[:, OUTCOME.barrier], np.where(stopped, 0, -1))
    np.testing.assert_allclose(outcomes[stopped, OUTCOME.x], 60.0, atol=1e-9)
    assert np.all(passages[stopped, 0, PASSAGE.count] == 1)
    np.testing.assert_array_equal(passages[stopped, 0, :-1], free[stopped, 0, :-1])


def test_a_barrier_lets_through_what_exceeds_its_capacity_and_the_rock_goes_on_as_before():
    rock = example()
    free, _, free_ends = run_trials(rock, 500, lines=WALL)
    capacity = float(np.median(free[:, 0, PASSAGE.kinetic]))
    _, _, outcomes = run_trials(rock, 500, lines=WALL, barriers=[(1e3, capacity)])
    stopped = outcomes[:, OUTCOME.end] == STOPPED
    np.testing.assert_array_equal(
        stopped, (free[:, 0, PASSAGE.kinetic] <= capacity) & (free[:, 0, PASSAGE.count] > 0)
    )
    np.testing.assert_array_equal(outcomes[~stopped, :-1], free_ends[~stopped, :-1])


def test_stations_beyond_a_barrier_see_no_stopped_rock():
    rock = plane(0.5, speed=5.0)
    barred, peaks, outcomes = run_trials(
        rock, 1, lines=[(20, -100, 20, 100)], barriers=[(1e3, 1e12)], stations=2000, right=100.0
    )
    assert outcomes[0, OUTCOME.end] == STOPPED != RESTED
    x = rock["profile.x"] + np.arange(2000)
    assert np.all(peaks[0, (x >= 0.5) & (x <= 19.0)] > -1.0)
    assert np.all(peaks[0, x > 21.0] == -1.0)
    assert barred[0, 0, PASSAGE.count] == 1

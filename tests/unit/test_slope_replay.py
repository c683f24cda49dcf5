"""A trial is a function of seed and number alone: whoever asks for it, in whatever order, and however it is stepped through."""

import threading

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.components.slope_rockfall.declarations import FLIGHT
from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE, PEAK, RESTED
from tests.slope_rocks import SLOPE, mode, run_trials

LINES = [(x, -50, x, 200) for x in (60, 90, 120)]


@pytest.fixture(scope="module")
def instance():
    """The example slope with its chance."""
    instance = SLOPE.instance()
    instance.initialise()
    return instance


def moving(**values):
    rock = SLOPE.instance()
    for name, value in values.items():
        rock[name] = value
    rock.initialise()
    return rock


def outputs(rock):
    return {name: rock[name] for name in rock.references}


def test_steps_of_any_length_give_the_same_trajectory_bit_for_bit():
    finest, fine, whole = moving(seed=3, trial=5), moving(seed=3, trial=5), moving(seed=3, trial=5)
    for second in range(14):
        whole.step(float(second), 1.0)
        for i in range(100 * second, 100 * second + 100):
            fine.step(i * 1e-2, 1e-2)
        for i in range(10_000 * second, 10_000 * second + 10_000):
            finest.step(i * 1e-4, 1e-4)
        assert outputs(finest) == outputs(fine) == outputs(whole)
    assert whole["impacts"] > 10


def test_a_clock_with_rounding_gives_the_same_outputs():
    exact, summed, time = moving(), moving(), 0.0
    for i in range(200):
        exact.step(i * 0.1, 0.1)
        summed.step(time, 0.1)
        time += 0.1
    assert time != 20.0
    assert outputs(exact) == outputs(summed)


def test_a_start_at_another_time_shifts_the_events_only():
    early, late = moving(), moving()
    for i in range(8):
        early.step(float(i), 1.0)
        late.step(100.0 + i, 1.0)
    assert late["next_event.time"] == pytest.approx(100.0 + early["next_event.time"], rel=1e-12)
    assert late["position.x"] == early["position.x"]


def test_the_first_trials_are_those_of_a_longer_campaign_in_any_order(instance):
    passages, _, outcomes = run_trials(instance, 5000, lines=LINES)
    few_passages, _, few = run_trials(instance, 200, lines=LINES)
    np.testing.assert_array_equal(outcomes[:200], few)
    np.testing.assert_array_equal(passages[:200], few_passages)
    backwards = np.concatenate([run_trials(instance, 1, first=n)[2] for n in reversed(range(100))])[
        ::-1
    ]
    np.testing.assert_array_equal(backwards, outcomes[:100])
    assert len(np.unique(outcomes[:, OUTCOME.time])) > 4900


def test_threads_do_not_change_a_trial(instance):
    _, _, together = run_trials(instance, 2000)
    parts = {}
    threads = [
        threading.Thread(
            target=lambda n=n: parts.update({n: run_trials(instance, 1000, first=n)[2]})
        )
        for n in (0, 1000)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(np.concatenate([parts[0], parts[1000]]), together)


def test_seeds_and_trials_differ(instance):
    ends = {
        run_trials(instance, 1, first=trial, seed=seed)[2][0, OUTCOME.time]
        for seed in range(20)
        for trial in range(20)
    }
    assert len(ends) == 400


def test_the_fmu_replays_a_trial_of_the_campaign(instance):
    _, _, outcomes = run_trials(instance, 20, seed=7)
    for trial in (0, 13, 19):
        rock = moving(seed=7, trial=trial)
        rock.step(0.0, 200.0)
        assert outcomes[trial, OUTCOME.end] == RESTED
        assert mode(rock) == "rest"
        assert (rock["position.x"], rock["position.y"]) == tuple(
            outcomes[trial, [OUTCOME.x, OUTCOME.y]]
        )
        assert rock["impacts"] == outcomes[trial, OUTCOME.impacts]


def test_records_agree_with_the_trajectory(instance):
    """Search lines, stations and largest values of one trial against the same trial read at many instants."""
    passages, peaks, outcomes = run_trials(
        instance, 1, first=4, left=0.0, right=140.0, lines=LINES, stations=141
    )
    rock = moving(trial=4)
    rows, columns = (
        [],
        (
            "position.x",
            "height",
            "velocity.x",
            "velocity.y",
            "angular_velocity",
            "energy.kinetic",
            "mode",
        ),
    )
    for i in range(60_000):
        rock.step(i * 2.5e-4, 2.5e-4)
        rows.append([rock[name] for name in columns])
        if rock["position.x"] > 139.9:
            break
    x, height, vx, vy, omega, kinetic, modes = np.array(rows).T
    speed = np.hypot(vx, vy)
    assert outcomes[0, OUTCOME.height] == pytest.approx(height.max(), abs=1e-3)
    assert outcomes[0, OUTCOME.speed] == pytest.approx(speed.max(), rel=1e-3)
    for line, passage in zip(LINES, passages[0]):
        i = int(np.argmax(x >= line[0]))
        assert passage[PASSAGE.count] == 1
        assert passage[PASSAGE.x] == pytest.approx(line[0], abs=1e-9)
        assert passage[PASSAGE.time] == pytest.approx(i * 2.5e-4, abs=6e-4)
        expected = (height[i], speed[i], omega[i], kinetic[i])
        got = passage[[PASSAGE.height, PASSAGE.speed, PASSAGE.omega, PASSAGE.kinetic]]
        assert got == pytest.approx(expected, rel=2e-2, abs=1e-2)
    for station in range(10, 130, 7):
        i = int(np.argmax(x >= station))
        if modes[i] == FLIGHT:
            assert peaks[0, station, PEAK.height] == pytest.approx(height[i], abs=2e-2)
            assert peaks[0, station, PEAK.speed] == pytest.approx(speed[i], rel=2e-2)


def test_a_search_line_may_be_oblique_and_ends_at_its_points(instance):
    lines = [(62, 0, 70, 200), (60, 190, 60, 200)]
    passages, _, _ = run_trials(instance, 50, lines=lines)
    x, y = passages[:, 0, PASSAGE.x], passages[:, 0, PASSAGE.y]
    assert np.all(passages[:, 0, PASSAGE.count] >= 1)
    np.testing.assert_allclose((x - 62) / 8, y / 200, rtol=1e-9)
    assert np.all(passages[:, 1, PASSAGE.count] == 0)


def test_catalogue_has_it():
    assert component("SlopeRockfall") is SLOPE

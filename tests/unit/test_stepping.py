"""Division of a communication step into internal ones."""

import numpy as np
import pytest

from rockshed.components.falling_rock import COMPONENT as ROCK


def fall(step, internal=1e-5):
    """The rock after one step."""
    rock = ROCK.instance()
    rock["internal_step"], rock["velocity0.x"] = internal, 0.7
    rock.initialise()
    rock.step(0.0, step)
    return rock


@pytest.mark.parametrize("number", [1, 3, 10])
def test_the_last_digits_of_a_step_do_not_reach_the_results(number):
    """Tools compute a step as the difference of two times in seconds."""
    exact = fall(number * 1e-5).w.tobytes()
    for time in (1e-3, 0.1, 20.0):
        step = (time + number * 1e-5) - time
        assert step != number * 1e-5
        assert fall(step).w.tobytes() == exact


@pytest.mark.parametrize(
    ("step", "number"),
    [(0.3e-5, 1), (1.05e-4, 11), (0.95e-4, 10), (1.00001e-4, 11), (0.99999e-4, 10)],
)
def test_any_other_step_is_divided_into_equal_parts(step, number):
    """Velocity first: the position falls by the sum of n velocities, which tells n."""
    rock, g = fall(step), ROCK.instance()["gravity"]
    assert rock["velocity.y"] == pytest.approx(-8.0 - g * step, rel=1e-15)
    assert rock["position.x"] == pytest.approx(0.7 * step, rel=1e-13)
    fallen = (rock["position.y"] - 1.0 + 8.0 * step) / (-g * step**2)
    assert fallen == pytest.approx((number + 1) / (2 * number), rel=1e-4)


def test_a_step_shorter_than_the_internal_one_is_made_at_once():
    assert fall(np.nextafter(1e-5, 0.0)).w.tobytes() == fall(1e-5).w.tobytes()
    assert fall(5e-6)["velocity.y"] == fall(5e-6, internal=5e-6)["velocity.y"]

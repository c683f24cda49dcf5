"""No rock gets into the slope, and none becomes a NaN, however rough things are."""

import numpy as np
import pytest

from rockshed.components.slope_rockfall.declarations import BODY, EXAMPLE
from rockshed.components.slope_rockfall.records import OUTCOME, PASSED_LEFT, PASSED_RIGHT, RESTED
from tests.slope_rocks import SLOPE, deepest, run_trials, slope

ROUGHEST = {
    "tilt__distribution": "uniform",
    "tilt_deviation": 0.5,
    "roughness": 0.6,
    "roughness_deviation": 0.3,
    "hardening": 1.0,
    "friction": 0.4,
    "resistance": 50.0,
    "limit_speed__mean": 6.0,
    "limit_speed__deviation": 3.0,
}
JAGGED = [
    (-5, 45),
    (0, 40),
    (1, 40.5),
    (1.4, 36),
    (3, 36.2),
    (3.1, 35),
    (6, 35),
    (9, 25),
    (9.5, 26),
    (10, 22),
    (16, 24),
    (18, 10),
    (22, 12),
    (23, 6),
    (30, 5),
    (40, 9),
    (60, 9),
]


def nodes_of(instance):
    """The profile with its end cells as long as a rock can see."""
    nodes = np.array(
        [(instance["profile.x"], instance["profile.y"]), *zip(instance["end.x"], instance["end.y"])]
    )
    nodes[0] += 300.0 * (nodes[0] - nodes[1]) / (nodes[1, 0] - nodes[0, 0])
    nodes[-1] += 300.0 * (nodes[-1] - nodes[-2]) / (nodes[-1, 0] - nodes[-2, 0])
    return nodes


CASES = {
    "example slope": lambda: slope(EXAMPLE, **ROUGHEST),
    "jagged, absolute tilt": lambda: slope(
        JAGGED,
        tilt__meaning="absolute",
        position0__x=-1.0,
        position0__y=46.0,
        radius=0.7,
        **ROUGHEST,
    ),
    "jagged, printed restitution": lambda: slope(
        JAGGED,
        tilt__meaning="absolute",
        position0__x=-1.0,
        position0__y=46.0,
        radius=0.3,
        restitution__gravity="printed",
        **ROUGHEST,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_no_rock_below_the_surface_and_no_nan_in_a_hundred_thousand_trials(case):
    instance = CASES[case]()
    count = 100_000 if case == "example slope" else 20_000
    left, right = instance["profile.x"] - 50.0, instance["end.x"][-1] + 50.0
    least, nans, events, endless = deepest(
        nodes_of(instance),
        instance["radius"],
        count,
        0,
        left,
        right,
        3000,
        instance.w,
        instance.x,
        instance.k,
        np.zeros(len(BODY)),
    )
    assert least > -1e-9
    assert nans == 0
    assert events > 5 * count
    assert endless < 1e-3 * count


def test_every_trial_ends():
    instance = SLOPE.instance()
    instance["roughness"][:], instance["roughness_deviation"][:], instance["hardening"][:] = (
        0.5,
        0.2,
        1.0,
    )
    instance.initialise()
    _, _, outcomes = run_trials(instance, 5000, left=-20.0, right=140.0)
    assert np.isfinite(outcomes).all()
    assert set(outcomes[:, OUTCOME.end]) <= {RESTED, PASSED_RIGHT, PASSED_LEFT}


def test_energy_never_rises_over_a_whole_trial():
    """Default options: what is left, with everything booked as dissipated, is the start; and each loss only grows."""
    for trial in range(40):
        rock = SLOPE.instance()
        rock["trial"], rock["tilt.meaning"] = trial, "absolute"
        rock.initialise()
        before = [0.0] * 4
        for i in range(60):
            rock.step(i * 0.5, 0.5)
            losses = [
                rock[f"energy.{name}"] for name in ("impact", "friction", "roughness", "resistance")
            ]
            assert rock["energy.residual"] == pytest.approx(0.0, abs=1e-9 * rock["energy.start"])
            assert all(
                now >= then - 1e-9 * rock["energy.start"] for now, then in zip(losses, before)
            )
            before = losses


def test_a_rock_in_a_valley_comes_to_rest():
    """It bounces and rolls to and fro between two smooth slopes; the end of that takes a finite time."""
    rock = slope(
        [(-50, 50), (0, 0), (50, 50)],
        position0__x=-10.0,
        position0__y=15.0,
        friction=0.5,
        hardening=0.8,
    )
    for second in range(400):
        rock.step(float(second), 1.0)
    assert rock["mode"] == 5.0
    assert rock["position.x"] == pytest.approx(0.0, abs=0.05)
    assert rock["energy.residual"] == pytest.approx(0.0, abs=1e-9 * rock["energy.start"])


def test_a_bouncing_ball_on_a_smooth_floor_comes_to_an_end():
    """Infinitely many bounces in a finite time: they end when a jump is lower than a nanometre."""
    rock = slope(
        [(-50, 0), (50, 0)],
        position0__x=0.0,
        position0__y=3.0,
        velocity0__x=0.0,
        hardening=0.8,
        strength=1e9,
        stiffness=1e7,
        restitution__gravity="none",
    )
    rock.step(0.0, 100.0)
    assert rock["mode"] == 5.0
    assert rock["impacts"] > 50

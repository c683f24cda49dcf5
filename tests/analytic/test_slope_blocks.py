"""Elongated blocks, undulating ground and coefficients of restitution: laws that hold for all of them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.slope_rockfall.declarations import BODY
from rockshed.components.slope_rockfall.records import BARRIER, KNOT, OUTCOME, ROCK
from rockshed.components.slope_rockfall.restitution import Approach, rebound_by_coefficients
from rockshed.components.slope_rockfall.shape import ellipse_contact
from rockshed.components.slope_rockfall.trajectory import trace
from tests.analytic.test_slope_safety import JAGGED, ROUGHEST, nodes_of
from tests.slope_rocks import G, deepest, run_trials, slope

FACE = [
    (-5, 45),
    (0, 40),
    (0.02, 30),
    (6, 29.9),
    (6.02, 20),
    (14, 20.5),
    (15, 12),
    (40, 9),
    (60, 9),
]
"""A quarry: faces of 89.9 degrees, benches that are level or rise."""


def knots_of(instance, number, most=20_000):
    knots = np.zeros((most, len(KNOT)))
    count = trace(
        1,
        number,
        -60.0,
        120.0,
        np.empty((0, 4)),
        np.empty((0, len(BARRIER))),
        instance.w,
        instance.x,
        instance.k,
        np.zeros(len(BODY)),
        knots,
    )
    return knots[:count]


def block(points, **values):
    common = {"tilt__meaning": "absolute", "position0__x": -1.0, "position0__y": 46.0}
    return slope(points, **{**ROUGHEST, **common, **values})


LAWS = {
    "drsp": {"undulation": 0.2},
    "coefficients": {
        "undulation": 0.2,
        "by_coefficients": 1.0,
        "normal_restitution": 0.9,
        "tangential_restitution": 0.95,
    },
    "scaled coefficients": {
        "by_coefficients": 1.0,
        "normal_restitution": 1.0,
        "tangential_restitution": 1.0,
        "scaling_speed": 9.144,
    },
}


@settings(max_examples=40)
@given(
    points=st.sampled_from([JAGGED, FACE]),
    law=st.sampled_from(sorted(LAWS)),
    elongation=st.floats(1.0, 4.0),
    radius=st.floats(0.1, 0.9),
    angle=st.floats(0.0, 3.2),
    spin=st.floats(-20.0, 20.0),
    speed=st.floats(-5.0, 15.0),
    number=st.integers(0, 1000),
)
def test_no_block_gains_energy(points, law, elongation, radius, angle, spin, speed, number):
    rock = block(
        points,
        shape="ellipse",
        elongation=elongation,
        radius=radius,
        angle0=angle,
        angular_velocity0=spin,
        velocity0__x=speed,
        **LAWS[law],
    )
    knots = knots_of(rock, number)
    mass = rock["mass"]
    inertia = 0.2 * mass * radius**2 * (elongation + 1.0 / elongation)
    square = knots[:, KNOT.vx] ** 2 + knots[:, KNOT.vy] ** 2
    energy = (
        mass * (0.5 * square + G * knots[:, KNOT.y]) + 0.5 * inertia * knots[:, KNOT.omega] ** 2
    )
    assert len(knots) > 2
    assert np.diff(energy).max() <= 1e-9 * abs(energy).max()
    assert np.isfinite(knots).all()


@pytest.mark.parametrize("points", [JAGGED, FACE], ids=["jagged", "quarry"])
@pytest.mark.parametrize("law", LAWS)
def test_no_block_gets_into_the_slope(points, law):
    rock = block(points, shape="ellipse", elongation=1.8, radius=0.6, angle0=0.3, **LAWS[law])
    least, nans, events, endless = deepest(
        nodes_of(rock),
        rock["radius"],
        3000,
        0,
        -60.0,
        120.0,
        3000,
        rock.w,
        rock.x,
        rock.k,
        np.zeros(len(BODY)),
    )
    assert least > -1e-9
    assert nans == 0
    assert events > 10_000
    assert endless < 30


def test_the_events_of_a_trajectory_end_where_the_trial_ends():
    rock = block(JAGGED, shape="ellipse", elongation=1.5, radius=0.6, undulation=0.1)
    for number in range(50):
        _, _, outcomes = run_trials(rock, 1, first=number, left=-60.0, right=120.0)
        last = knots_of(rock, number)[-1]
        assert last[KNOT.x] == outcomes[0, OUTCOME.x]
        assert last[KNOT.y] == outcomes[0, OUTCOME.y]
        assert last[KNOT.time] == outcomes[0, OUTCOME.time]


def test_rocks_of_one_radius_share_a_path_and_each_its_own_trial():
    """A table of rocks gives the bits of instances that have their values."""
    rock = block(JAGGED, shape="ellipse", elongation=1.5, radius=0.6)
    rocks = np.zeros((6, len(ROCK)))
    alone = []
    for i in range(6):
        values = {
            "mass": 500.0 + 100.0 * i,
            "radius": (0.3, 0.6, 0.5)[i % 3],
            "moment_of_inertia": 1.0,
            "elongation": 1.0 + 0.2 * i,
            "position0.x": -1.0 + 0.1 * i,
            "position0.y": 46.5,
            "velocity0.x": 0.5 * i,
            "velocity0.y": 0.0,
            "angular_velocity0": -1.0,
            "angle0": 0.4 * i,
        }
        rocks[i] = list(values.values())
        one = block(
            JAGGED,
            shape="ellipse",
            **{name.replace(".", "__"): value for name, value in values.items()},
        )
        alone.append(run_trials(one, 1, first=i, left=-60.0, right=120.0)[2][0])
    _, _, outcomes = run_trials(rock, 6, left=-60.0, right=120.0, rocks=rocks)
    np.testing.assert_array_equal(outcomes, alone)


@given(elongation=st.floats(1.0, 10.0), angle=st.floats(-7.0, 7.0))
def test_the_contact_of_an_ellipse_is_its_lowest_point(elongation, angle):
    a, b = elongation**0.5, elongation**-0.5
    turn = np.linspace(0.0, 2.0 * math.pi, 20_001)
    x = a * np.cos(turn) * math.cos(angle) - b * np.sin(turn) * math.sin(angle)
    y = a * np.cos(turn) * math.sin(angle) + b * np.sin(turn) * math.cos(angle)
    distance, side = ellipse_contact(1.0, elongation, angle)
    assert -distance * math.cos(side) == pytest.approx(y.min(), abs=1e-6)
    assert distance * math.sin(side) == pytest.approx(x[np.argmin(y)], abs=2e-3 * elongation)


def test_a_block_that_neither_slips_nor_rebounds_turns_about_its_contact_point():
    """Bozzolo and Pamini 1986: the angular momentum about the contact point stays."""
    elongation, angle, speed, drop = 2.0, 0.6, 6.0, 1e-3
    rock = slope(
        [(-50, 0), (50, 0)],
        shape="ellipse",
        elongation=elongation,
        angle0=-angle,
        position0__x=0.0,
        position0__y=0.5 + drop,
        velocity0__x=speed,
        radius=0.5,
        hardening=0.0,
        friction=50.0,
        strength=1e20,
        stiffness=1e20,
        mass=1000.0,
    )
    fall = math.sqrt(2.0 * G * drop)
    distance, side = ellipse_contact(0.5, elongation, -angle)
    inertia = 0.2 * 1000.0 * 0.25 * 2.5
    right, down = distance * math.sin(side), distance * math.cos(side)
    assert right > 0.0
    before = 1000.0 * (-right * -fall - down * speed)
    rock.step(0.0, fall / G + 1e-6)
    u, v, spin = rock["velocity.x"], rock["velocity.y"], rock["angular_velocity"]
    assert rock["impacts"] == 1.0
    assert v > 0.0
    after = inertia * spin + 1000.0 * (-right * v - down * u)
    assert after == pytest.approx(before, rel=1e-3)
    assert (u + down * spin, v + right * spin) == pytest.approx((0.0, 0.0), abs=5e-3 * speed)


@given(
    u=st.floats(-30, 30),
    v=st.floats(-30, 0),
    omega=st.floats(-60, 60),
    normal=st.floats(0, 1),
    tangential=st.floats(0, 1),
    ratio=st.floats(0.1, 2.0),
)
def test_coefficients_of_restitution_are_those_of_the_velocity_and_take_energy(
    u, v, omega, normal, tangential, ratio
):
    after_u, after_v, after_omega = rebound_by_coefficients(
        Approach(u, v, omega, 9.8, 0.5), normal, tangential, ratio
    )
    assert after_u == tangential * u
    assert after_v == -normal * v
    before = u * u + ratio * (0.5 * omega) ** 2
    after = after_u**2 + ratio * (0.5 * after_omega) ** 2
    assert after <= before * (1.0 + 1e-12) + 1e-300


def test_a_rolling_rock_keeps_rolling_over_an_impact_by_coefficients():
    u, v, omega = rebound_by_coefficients(Approach(8.0, -3.0, -16.0, 9.8, 0.5), 0.35, 0.85, 0.4)
    assert (u, v, omega) == pytest.approx((6.8, 1.05, -13.6))


def test_undulation_spreads_rocks_on_level_ground_where_a_relative_tilt_spreads_none():
    points = [(-100, 0), (100, 0)]
    common = {
        "position0__x": 0.0,
        "position0__y": 10.0,
        "velocity0__x": 5.0,
        "friction": 0.5,
        "tilt_deviation": 0.3,
        "hardening": 0.5,
    }
    _, _, none = run_trials(slope(points, **common), 200)
    _, _, some = run_trials(slope(points, undulation=0.15, **common), 200)
    assert np.ptp(none[:, OUTCOME.x]) == 0.0
    assert np.std(some[:, OUTCOME.x]) > 0.5

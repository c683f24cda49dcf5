"""Sliding and rolling discs against closed forms."""

import math

import numpy as np
import pytest

from tests.sand_discs import RADIUS, discs_at, masses, rows, run, sand_stiffness

G = 9.80665
ON_FLOOR = {"base.y": 0.0, "gravity": G}
MU = math.tan(math.radians(30.0))


def resting_height(number=1):
    """Height of a disc's centre that carries its own weight and that of number - 1 discs, in the
    literal model."""
    disc = discs_at([(0.0, 1.0)], parameters=ON_FLOOR)
    return RADIUS - number * masses(disc)[0] * G / sand_stiffness(disc)


CARRIERS = {
    "floor": ((0.0, 0.0), None, {"base.y": 0.0}),
    "rock": ((0.0, 0.02), 0.02, {"rock.position.y": 0.0, "rock.radius": 0.02}),
    "beam": ((0.025, 0.0), 0.025, {"base": "beam_discs", "box.left": 0.0, "box.width": 0.2}),
    "beam surface": (
        (0.06, 0.0),
        0.025,
        {"base": "beam_surface", "box.left": 0.0, "box.width": 0.2},
    ),
}
"""What a disc can lie on: the point, the carrier's radius, the parameters."""


@pytest.mark.parametrize(
    ("carrier", "ratio"), [("floor", 1.0), ("beam surface", 1.0), ("beam", 1.0), ("rock", 2 / 5)]
)
def test_a_disc_comes_to_rest_with_the_overlap_that_carries_it(carrier, ratio):
    """Eq. (1) with dD = 2 r and R_ij0 = r + R: k_n = E_bar dL 2 r / (r + R); a plane counts as the
    disc's mirror image."""
    (x, y), _, parameters = CARRIERS[carrier]
    disc = discs_at([(x, y + RADIUS)], parameters={"gravity": G, "damping": 0.5, **parameters})
    run(disc, 0.1)
    overlap = y + RADIUS - rows(disc)[0, 1]
    assert overlap == pytest.approx(masses(disc)[0] * G / (ratio * sand_stiffness(disc)), rel=1e-9)
    assert disc["transmitted_force"] - disc["rock.force.y"] == pytest.approx(
        masses(disc)[0] * G, rel=1e-12
    )


def test_a_locked_disc_slides_with_the_deceleration_mu_g():
    disc = discs_at(
        [(0.0, resting_height())], [(1.0, 0.0)], parameters={**ON_FLOOR, "rotation": "locked"}
    )
    run(disc, 0.1)
    assert rows(disc)[0, 2] == pytest.approx(1.0 - MU * G * 0.1, rel=1e-9)
    run(
        disc, 0.2
    )  # it stops at 0.177 s; the tangential spring then swings and its dashpot calms it
    assert rows(disc)[0, 2] == pytest.approx(0.0, abs=1e-9)
    assert rows(disc)[0, 0] == pytest.approx(1.0 / (2.0 * MU * G), rel=1e-3)


def test_a_sliding_disc_ends_rolling_at_two_thirds_of_its_speed():
    """I = m r^2 / 2: v = v0 - mu g t, omega r = -2 mu g t; they meet at t = v0 / (3 mu g)."""
    disc = discs_at([(0.0, resting_height())], [(1.0, 0.0)], parameters=ON_FLOOR)
    rolling_from = 1.0 / (3.0 * MU * G)
    run(disc, 0.5 * rolling_from)
    assert rows(disc)[0, 2] == pytest.approx(5.0 / 6.0, rel=1e-3)
    assert rows(disc)[0, 4] == pytest.approx(-1.0 / 3.0, rel=1e-3)
    run(disc, 0.49 * rolling_from)
    assert rows(disc)[0, 2] + rows(disc)[0, 4] > 5e-3
    run(disc, 0.03 * rolling_from)
    assert rows(disc)[0, 2] + rows(disc)[0, 4] == pytest.approx(0.0, abs=3e-3)
    run(disc, rolling_from)
    assert rows(disc)[0, 2] == pytest.approx(2.0 / 3.0, rel=1e-9)
    assert rows(disc)[0, 4] == pytest.approx(-2.0 / 3.0, rel=1e-9)
    assert disc["energy.sliding"] == pytest.approx(masses(disc)[0] / 6.0, rel=1e-2)


TURNING = ["rock", "beam", "beam surface"]


def on_top(carrier, velocity, spin):
    """A disc that falls on the top of rock or beam, which turns with ``spin``; the carrier's force
    to the right and torque."""
    (x, y), radius, parameters = CARRIERS[carrier]
    disc = discs_at([(x, y + RADIUS)], [velocity], parameters=parameters)
    name = "rock" if carrier == "rock" else "beam"
    disc[f"{name}.angular_velocity"] = spin
    run(disc, 1e-5, 1e-6)
    return disc, np.sum(disc[f"{name}.force.x"]), np.sum(disc[f"{name}.torque"]), radius


@pytest.mark.parametrize("carrier", TURNING)
def test_friction_on_the_top_of_rock_or_beam_turns_it_clockwise(carrier):
    disc, force, torque, radius = on_top(carrier, (3.0, -1.0), 0.0)
    assert force == pytest.approx(MU * (disc["transmitted_force"] - disc["rock.force.y"]), rel=1e-2)
    assert torque == pytest.approx(-radius * force, rel=1e-2)
    assert rows(disc)[0, 2] < 3.0


@pytest.mark.parametrize("carrier", TURNING)
def test_a_turning_rock_or_beam_carries_the_disc_along_and_is_braked(carrier):
    """Counter-clockwise: the top moves to the left."""
    disc, force, torque, radius = on_top(carrier, (0.0, -1.0), 50.0)
    assert rows(disc)[0, 2] < 0.0 < force
    assert torque == pytest.approx(-radius * force, rel=1e-2)


def column(spin, rolling_resistance):
    """Two smooth discs, one upon the other, that turn against each other with +-spin (rad/s)."""
    lower = resting_height(2)
    return discs_at(
        [(0.0, lower), (0.0, lower + RADIUS + resting_height())],
        spins=[spin, -spin],
        parameters={**ON_FLOOR, "friction_angle": 0.0, "rolling_resistance": rolling_resistance},
    )


def test_rolling_resistance_slows_at_its_limit():
    """Two equal discs have the effective radius r/2: moment mu_r m g r/2 on I = m r^2 / 2 is the
    deceleration mu_r g / r. The floor adds mu_r 2 m g r, four times as much, on the lower one."""
    discs = column(30.0, 0.3)
    run(discs, 2e-3)
    before = rows(discs)[:, 4].copy()
    run(discs, 4e-3)
    assert before - rows(discs)[:, 4] == pytest.approx(
        np.array((5.0, -1.0)) * 0.3 * G * 4e-3, rel=1e-6
    )
    assert (
        discs["energy.rolling"]
        > 0.9 * (discs["energy.start"] - discs["energy.kinetic"] - discs["energy.gravity"])
        > 0.0
    )


def test_rolling_resistance_holds_discs_that_turn_slowly():
    held, released = column(0.02, 0.3), column(0.02, 0.0)
    for _ in range(100):
        run(held, 1e-3)
        run(released, 1e-3)
        assert abs(held.state("angle")).max() < 2e-5
    assert released.state("angle") == pytest.approx([2e-3, -2e-3], rel=1e-9)
    assert held["energy.rolling"] == 0.0

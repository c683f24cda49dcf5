"""One collision: restitution, duration and friction against closed forms."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.sand_discs import (
    EMPTY_SPACE,
    RADIUS,
    RockOnSand,
    contact_duration,
    cushion,
    discs_at,
    masses,
    restitution,
    rows,
    run,
    sand_stiffness,
)

HALVINGS = (4e-6, 2e-6, 1e-6)
APPROACHES = {
    "floor": ((0.0, RADIUS), (0.0, -1.0), {"base.y": 0.0}),
    "left wall": ((RADIUS, 0.0), (-1.0, 0.0), {"box.left": 0.0}),
    "right wall": ((1.0 - RADIUS, 0.0), (1.0, 0.0), {"box.left": 0.0, "box.width": 1.0}),
    "beam disc": (
        (0.025, RADIUS),
        (0.0, -1.0),
        {"base": "beam_discs", "box.left": 0.0, "box.width": 0.2},
    ),
    "beam surface": (
        (0.05, RADIUS),
        (0.0, -1.0),
        {"base": "beam_surface", "box.left": 0.0, "box.width": 0.2},
    ),
}


def assert_first_order(errors):
    """Errors at steps halved each time fall at least almost twofold, to below 1e-3."""
    assert abs(errors[-1]) < 1e-3
    assert all(abs(coarse) > 1.8 * abs(fine) for coarse, fine in pairwise(errors))


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.2, 0.5, 0.65, 0.9])
def test_restitution_of_two_equal_discs(damping):
    """The reduced mass is m/2 and c_n = 2 h sqrt(m k_n), so the damping ratio of the pair is h
    sqrt(2)."""
    errors = []
    for step in HALVINGS:
        pair = discs_at(
            [(0.0, 0.0), (2 * RADIUS, 0.0)],
            [(1.0, 0.0), (-1.0, 0.0)],
            parameters={"damping": damping, "internal_step": step},
        )
        run(pair, 4e-3)
        errors.append(
            (rows(pair)[1, 2] - rows(pair)[0, 2]) / 2.0 - restitution(damping * math.sqrt(2.0))
        )
    assert_first_order(errors)


def test_restitution_of_two_unequal_discs_has_the_mean_root_of_their_masses_in_the_dashpot():
    parameters = {"packing": "random", "disc.spread": 0.5, "seed": 17, "internal_step": 1e-6}
    pair = discs_at([(0.0, 0.0), (1.0, 0.0)], parameters=parameters)
    body, (heavy, light) = rows(pair), masses(pair)
    assert max(heavy, light) > 5.0 * min(heavy, light)
    body[1, 0] = body[:, 5].sum()
    body[:, 2] = 1.0, -1.0
    pair.evaluate()
    run(pair, 4e-3)
    reduced = heavy * light / (heavy + light)
    ratio = 0.2 * 0.5 * (math.sqrt(heavy) + math.sqrt(light)) / math.sqrt(reduced)
    assert (body[1, 2] - body[0, 2]) / 2.0 == pytest.approx(restitution(ratio), abs=1e-3)


@pytest.mark.parametrize("damping", [0.0, 0.2, 0.9])
@pytest.mark.parametrize("boundary", APPROACHES)
def test_restitution_of_a_disc_on_a_boundary(boundary, damping):
    position, velocity, parameters = APPROACHES[boundary]
    errors = []
    for step in HALVINGS:
        disc = discs_at(
            [position],
            [velocity],
            parameters={**parameters, "damping": damping, "internal_step": step},
        )
        run(disc, 4e-3)
        errors.append(-rows(disc)[0, 2:4] @ velocity - restitution(damping))
    assert_first_order(errors)


@pytest.mark.parametrize("damping", [0.0, 0.2, 0.9])
def test_duration_of_contact(damping):
    step = 1e-6
    pair = discs_at(
        [(0.0, 0.0), (2 * RADIUS, 0.0)], [(1.0, 0.0), (-1.0, 0.0)], parameters={"damping": damping}
    )
    frequency = math.sqrt(2.0 * sand_stiffness(pair) / masses(pair)[0])
    last_change, speed = 0, rows(pair)[0, 2]
    for count in range(1, 1500):
        pair.step(0.0, step)
        if rows(pair)[0, 2] != speed:
            last_change, speed = count, rows(pair)[0, 2]
    assert last_change * step == pytest.approx(
        contact_duration(damping * math.sqrt(2.0), frequency), abs=4 * step
    )


@pytest.mark.parametrize(
    "boundary", [name for name in APPROACHES if name != "beam disc"]
)  # whose flank turns the normal
def test_oblique_impact_that_slides_throughout(boundary):
    """Tangential impulse = mu * normal impulse; at the radius r it changes the spin by impulse * r
    / I = 2 impulse / (m r)."""
    position, normal_velocity, parameters = APPROACHES[boundary]
    mu, speed = 0.1, 3.0
    towards = np.array(normal_velocity)
    along = np.array((-towards[1], towards[0]))
    disc = discs_at(
        [position],
        [towards + speed * along],
        parameters={
            **parameters,
            "friction_angle": math.atan(mu),
            "wall.friction_angle": math.atan(mu),
        },
    )
    run(disc, 2e-3)
    change = rows(disc)[0, 2:4] - (towards + speed * along)
    normal, tangential = -change @ towards, change @ along
    assert normal > 1.3
    assert tangential == pytest.approx(-mu * normal, rel=1e-12)
    assert rows(disc)[0, 4] == pytest.approx(-2.0 * mu * normal, rel=1e-12)


def test_locked_rotation_takes_the_same_friction_but_no_spin():
    spun, locked = (
        discs_at([(0.0, RADIUS)], [(3.0, -1.0)], parameters={"base.y": 0.0, "rotation": rotation})
        for rotation in ("free", "locked")
    )
    run(spun, 1e-3)
    run(locked, 1e-3)
    assert rows(spun)[0, 4] < -10.0 * RADIUS
    assert rows(locked)[0, 4] == 0.0
    assert locked.state("angle")[0] == 0.0
    assert rows(locked)[0, 2] < 3.0


# --- the rock where there is no sand under it ---

ROCK = 0.0495
ROCK_APPROACHES = {
    "floor": ((0.5, ROCK), (0.0, -1.0), {"base": "floor", "base.y": 0.0}),
    "beam disc": ((0.075, ROCK), (0.0, -1.0), {"base": "beam_discs"}),
    "beam surface": ((0.1, ROCK), (0.0, -1.0), {"base": "beam_surface"}),
    "left wall": ((ROCK, 0.5), (-1.0, 0.0), {}),
    "right wall": ((0.2 - ROCK, 0.5), (1.0, 0.0), {}),
}


@pytest.mark.parametrize("boundary", ROCK_APPROACHES)
def test_rock_rebounds_from_whatever_carries_or_bounds_the_sand(boundary):
    """The rock's own mass is in the dashpot, so its damping ratio is h."""
    position, velocity, parameters = ROCK_APPROACHES[boundary]
    box = {
        **EMPTY_SPACE,
        "box.left": 0.0,
        "box.width": 0.2 if boundary != "floor" else 1.0,
        "base.y": 0.0,
        **parameters,
    }
    sand = cushion(box, discs=1)
    rows(sand)[0, 0:2] = 0.15, 0.3
    pair = RockOnSand(sand, position, velocity, 1e-5)
    on_beam = boundary.startswith("beam")
    impulse = 0.0
    for _ in range(1000):
        pair.advance(1e-5)
        impulse += sand["transmitted_force"] * 1e-5
        if on_beam:
            assert sand["beam.force.x"].sum() == pytest.approx(-sand["rock.force.x"], abs=1e-9)
            assert sand["beam.force.y"].sum() == pytest.approx(-sand["rock.force.y"], rel=1e-12)
            assert sand["transmitted_force"] == pytest.approx(
                -sand["beam.force.y"].sum(), rel=1e-12
            )
    rebound = -np.array((pair.rock["velocity.x"], pair.rock["velocity.y"])) @ velocity
    assert rebound == pytest.approx(restitution(0.2), abs=2e-3)
    assert impulse == pytest.approx(
        0.0 if "wall" in boundary else sand["rock.mass"] * (1.0 + rebound), rel=1e-9
    )

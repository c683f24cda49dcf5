"""Side walls of a finite height: a rock touches them as upright blocks with a flat top."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.components.common.component import ComponentError
from rockshed.components.common.kernels import kernel
from rockshed.components.sand_cushion import boundaries
from rockshed.components.sand_cushion.bodies import bodies_of
from tests.sand_discs import EMPTY_SPACE, RockOnSand, cushion

LEFT, WIDTH, TOP, THICK, RADIUS = -5.0, 10.0, 0.5, 0.2, 0.05
WALLS = {
    **EMPTY_SPACE,
    "box.wall_height": 5.5,
    "box.wall_thickness": THICK,
    "rock.radius": RADIUS,
    "damping": 0.0,
    "friction_angle": 0.0,
    "wall.friction_angle": 0.0,
    "internal_step": 2e-6,
}
ELASTIC = 5e-3
"""Of the rebound's speed, in steps of 2e-6 s."""


@kernel
def touch(i, b, w, x, k, boundary):
    bodies = bodies_of(x, k)
    return boundaries.touch(i, b, boundaries.boundary_of(b, bodies.rock, boundary), w, bodies)


def touching(sand, i, b):
    return touch(i, b, sand.w, sand.x, sand.k, sand.state("boundary"))


def nearest_of_block(x, y, inner, outer):
    """Distance (m) to the nearest of many points on the surface of a block, and the direction to
    it."""
    along, down = np.linspace(inner, outer, 4001), np.linspace(TOP, -2.0, 50_001)
    points = np.concatenate(
        (
            np.column_stack((along, np.full_like(along, TOP))),
            *(np.column_stack((np.full_like(down, side), down)) for side in (inner, outer)),
        )
    )
    away = points - (x, y)
    i = int(np.hypot(*away.T).argmin())
    distance = math.hypot(*away[i])
    return distance, away[i] / distance


@pytest.fixture(scope="module")
def sand():
    return cushion(WALLS, discs=1, elements=1)


@given(st.floats(-0.6, 0.6), st.floats(-0.5, 0.6), st.sampled_from([-1.0, 1.0]))
def test_the_gap_is_the_distance_to_the_block(sand, out, over, side):
    x = (LEFT if side < 0.0 else LEFT + WIDTH) + side * out
    y = TOP + over
    distance = math.hypot(max(-out, 0.0, out - THICK), max(over, 0.0))
    if distance < 1e-3:
        return  # inside the block, where no rock gets
    sand["rock.position.x"], sand["rock.position.y"] = 0.0, 50.0
    body = sand.state("body").reshape(-1, 8)
    body[1, 0], body[1, 1] = x, y
    inner = LEFT if side < 0.0 else LEFT + WIDTH
    nx, ny, gap, vx, vy, _ = touching(sand, 1, 3 if side < 0.0 else 4)
    expected, (ex, ey) = nearest_of_block(x, y, inner, inner + side * THICK)
    assert gap + RADIUS == pytest.approx(expected, abs=1e-6)
    assert (nx, ny) == pytest.approx((ex, ey), abs=2e-3 / expected * 1e-1 + 1e-6)
    assert (vx, vy) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("contact", "from_angle"),
    [
        ((LEFT, TOP - 0.3), 0.0),
        ((LEFT, TOP), 20.0),
        ((LEFT, TOP), 45.0),
        ((LEFT, TOP), 70.0),
        ((LEFT - 0.1, TOP), 90.0),
        ((LEFT - THICK, TOP), 130.0),
        ((LEFT - THICK, TOP - 0.2), 180.0),
        ((LEFT + WIDTH, TOP), 135.0),
        ((LEFT + WIDTH + 0.1, TOP), 90.0),
        ((LEFT + WIDTH + THICK, TOP), 40.0),
    ],
)
def test_a_rock_comes_straight_back_from_faces_and_corners(contact, from_angle):
    """Without friction and dashpots a rock that comes along the normal leaves along it, as fast as
    it came."""
    nx, ny = math.cos(math.radians(from_angle)), math.sin(math.radians(from_angle))
    away, speed = RADIUS + 1e-4, 2.0
    start, velocity = (contact[0] + away * nx, contact[1] + away * ny), (-speed * nx, -speed * ny)
    sand = cushion(
        {**WALLS, "rock.position.x": start[0], "rock.position.y": start[1]}, discs=1, elements=1
    )
    both = RockOnSand(sand, start, velocity, 2e-6)
    both.advance(0.012)
    assert (both.rock["velocity.x"], both.rock["velocity.y"]) == pytest.approx(
        (speed * nx, speed * ny), abs=ELASTIC * speed
    )
    assert abs(both.rock["angular_velocity"]) < 1e-9


def test_a_rock_that_grazes_the_edge_is_turned_by_it():
    """Reflection at the corner: the speed along the normal turns round, that across it is kept."""
    offset, speed = 0.03, 2.0
    nx, ny = offset / RADIUS, math.sqrt(1.0 - (offset / RADIUS) ** 2)
    start = (LEFT + offset, TOP + RADIUS * ny + 1e-4)
    sand = cushion(
        {**WALLS, "modulus": 1e9, "rock.position.x": start[0], "rock.position.y": start[1]},
        discs=1,
        elements=1,
    )
    both = RockOnSand(sand, start, (0.0, -speed), 1e-6)
    both.advance(0.003)
    into = -speed * ny
    expected = (-2.0 * into * nx, -speed - 2.0 * into * ny)
    assert (both.rock["velocity.x"], both.rock["velocity.y"]) == pytest.approx(
        expected, abs=0.03 * speed
    )
    assert math.hypot(both.rock["velocity.x"], both.rock["velocity.y"]) == pytest.approx(
        speed, rel=ELASTIC
    )


def test_a_rock_on_a_wall_that_stands_on_the_beam_weighs_on_the_beam():
    """The wall counts its height from the beam's top beside it, and hands the force down by the
    lever rule, with the moment that it has: it stands half a disc outside the first centre."""
    height = 0.3
    sand = cushion(
        {
            "base": "beam_surface",
            "walls": "on_beam",
            "box.left": 0.0,
            "box.width": 0.4,
            "beam.radius": 0.05,
            "box.wall_height": height,
            "box.wall_thickness": THICK,
            "rock.radius": RADIUS,
            "rock.position.x": 0.2,
            "rock.position.y": 2.0,
            "settling.time": 0.0,
            "beam.position.x": (0.05, 0.15, 0.25, 0.35),
            "beam.position.y": (0.02, 0.02, 0.02, 0.02),
        },
        discs=1,
        elements=4,
    )
    top = 0.02 + 0.05 + height
    sand["rock.position.x"], sand["rock.position.y"] = -0.1, top + RADIUS + 1e-6
    sand.evaluate()
    without = np.array(sand["beam.force.y"])
    sand["rock.position.y"] = top + RADIUS - 1e-3
    sand.step(0.0, 1e-6)
    force = sand["rock.force.y"]
    assert force > 10.0
    assert sand["rock.force.x"] == 0.0
    brought = sand["beam.force.y"] - without
    assert np.sum(brought) == pytest.approx(-force, rel=1e-6)
    assert sand["beam.position.x"] @ brought == pytest.approx(0.0, abs=1e-6 * force)
    assert brought[:2] == pytest.approx((-1.5 * force, 0.5 * force), rel=1e-6)


def test_sand_does_not_see_where_a_wall_ends(sand):
    body = sand.state("body").reshape(-1, 8)
    body[0, 0], body[0, 1] = LEFT + 0.004, TOP + 3.0
    nx, ny, gap, *_ = touching(sand, 0, 3)
    assert (nx, ny, gap) == (-1.0, 0.0, pytest.approx(-0.001))


def test_a_rock_may_start_beside_the_box_only_above_its_walls():
    beside = {**WALLS, "rock.position.x": LEFT - 0.1}
    cushion({**beside, "rock.position.y": TOP + RADIUS}, discs=1)
    for values in (
        {"rock.position.y": TOP + RADIUS - 1e-3},
        {"rock.position.y": 50.0, "box.wall_height": 1e30},
    ):
        with pytest.raises(ComponentError, match="in or behind a side wall"):
            cushion({**beside, **values}, discs=1)

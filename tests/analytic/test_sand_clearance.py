"""Distance of the rock from the base: plain geometry for each kind of base, and the contact's own."""

import math

import numpy as np
import pytest

from tests.sand_discs import EMPTY_SPACE, cushion, rows

ELEMENTS, SPACING, RADIUS = 8, 0.1, 0.03
PLACES = (np.arange(ELEMENTS) + 0.5) * SPACING


def rock_above(base, x, y, heights=0.0, **parameters):
    """A rock at a place above eight beam discs or a floor at y = 0; one disc of sand far away."""
    made = cushion(
        {
            **EMPTY_SPACE,
            "base": base,
            "base.y": 0.0,
            "box.left": 0.0,
            "box.width": ELEMENTS * SPACING,
            "beam.radius": 0.5 * SPACING,
            "rock.radius": RADIUS,
            "damping": 0.0,
            "beam.position.x": PLACES,
            "beam.position.y": np.zeros(ELEMENTS) + heights - 0.5 * SPACING,
            "rock.position.x": x,
            "rock.position.y": 1.0,
            **parameters,
        },
        discs=1,
        elements=ELEMENTS,
    )
    rows(made)[0, 0:2] = 0.1, 3.0
    made.evaluate()
    made["rock.position.y"] = y
    made.step(0.0, 1e-5)
    return made


def test_above_a_floor_it_is_the_height_of_the_rocks_lowest_point():
    assert rock_above("floor", 0.3, 0.15)["clearance"] == pytest.approx(0.12, abs=1e-12)


def test_above_a_beam_that_tilts_it_is_the_distance_from_its_top():
    """Tops of the discs on a line of slope 0.1 through y = 0 at x = 0."""
    made = rock_above("beam_surface", 0.3, 0.15, 0.1 * PLACES)
    distance = (0.15 - 0.1 * 0.3) / math.hypot(1.0, 0.1)
    assert made["clearance"] == pytest.approx(distance - RADIUS, abs=1e-12)


def test_above_discs_it_is_the_distance_from_the_nearest_of_them():
    """Midway between two: from either by Pythagoras."""
    made = rock_above("beam_discs", 0.4, 0.1)
    centres = math.hypot(0.5 * SPACING, 0.1 + 0.5 * SPACING)
    assert made["clearance"] == pytest.approx(centres - RADIUS - 0.5 * SPACING, abs=1e-12)


def test_a_beam_that_has_moved_since_the_start_counts_where_it_is():
    made = rock_above("beam_surface", 0.43, 0.15)
    assert made["clearance"] == pytest.approx(0.12, abs=1e-12)
    made["beam.position.y"] = made["beam.position.y"] - 0.025
    made.step(1e-5, 1e-5)
    assert made["clearance"] == pytest.approx(0.145, abs=1e-12)


@pytest.mark.parametrize("base", ["floor", "beam_surface", "beam_discs"])
def test_where_it_is_negative_the_contact_presses_in_proportion(base):
    forces, overlaps = [], []
    for depth in (1e-3, 2e-3):
        made = rock_above(base, 0.35, RADIUS - depth)
        forces.append(made["rock.force.y"])
        overlaps.append(-made["clearance"])
    assert overlaps == pytest.approx([1e-3, 2e-3], rel=1e-9)
    assert forces[0] > 0.0
    assert forces[1] / forces[0] == pytest.approx(2.0, rel=1e-9)


def test_beside_the_box_the_base_goes_on():
    made = rock_above("floor", -0.5, 0.15, **{"box.wall_height": 0.05, "box.wall_thickness": 0.01})
    assert made["clearance"] == pytest.approx(0.12, abs=1e-12)

"""Rules for the effective width beside the spread of a load that was computed with spheres."""

import math

import numpy as np
import pytest

from rockshed.sites.shed.effective_width import RULES, Spread, band

RINGS = np.array([378, 459, 387, 291, 277, 188, 167, 109, 87, 57, 42, 27, 20, 17]) * 1e3
"""Mean pressure (Pa) in rings of 12.5 cm around the axis at the peak: 1 t from 10 m on 90 cm."""
RING = 0.125
SPREAD = Spread(rock_radius=0.456, thickness=0.9, spacing=1.7)


def line_load(y):
    """Load by length (N/m) on the line at a distance y (m) from the axis."""
    x = np.linspace(-1.75, 1.75, 3501)
    ring = (np.hypot(x, y) / RING).astype(int)
    return np.trapezoid(np.where(ring < 14, RINGS[np.minimum(ring, 13)], 0.0), x)


PLACES = np.linspace(0.0, 1.75, 351)
LINES = np.array([line_load(y) for y in PLACES])
FORCE = 2.0 * np.trapezoid(LINES, PLACES)


def share(width):
    """Part of the load within a strip of this width over the axis."""
    parts = 0.5 * (LINES[1:] + LINES[:-1]) * np.diff(PLACES)
    return float(
        np.interp(0.5 * width, PLACES, np.concatenate(([0.0], np.cumsum(parts)))) * 2 / FORCE
    )


@pytest.mark.parametrize(
    ("rule", "width", "part"),
    [
        ("girder spacing", 1.70, 0.84),
        ("spheres", 1.50, 0.78),
        ("rock and cushion", 1.81, 0.86),
        ("45 degrees", 2.71, 0.97),
    ],
)
def test_the_table_of_the_documentation_has_the_rules_beside_the_spheres(rule, width, part):
    found = RULES[rule].width(SPREAD)
    assert found == pytest.approx(width, abs=0.005)
    assert share(found) == pytest.approx(part, abs=0.005)


def test_the_even_strips_that_stand_for_the_spheres_are_one_and_a_half_to_two_metres_wide():
    by_peak = FORCE / LINES[0]
    by_moment = math.sqrt(12.0 * 2.0 * np.trapezoid(LINES * PLACES**2, PLACES) / FORCE)
    assert by_peak == pytest.approx(1.50, abs=0.005)
    assert by_moment == pytest.approx(2.09, abs=0.005)
    assert by_peak == pytest.approx(RULES["spheres"].width(SPREAD), abs=0.01)
    assert by_peak < RULES["rock and cushion"].width(SPREAD) < by_moment


def test_the_band_leaves_out_rules_without_a_meaning():
    assert band(SPREAD) == pytest.approx((1.50, 2.71), abs=0.01)
    assert band(Spread(0.456, 0.9, 0.0)) == band(SPREAD)
    assert band(Spread(0.456, 0.9, 1.2))[0] == 1.2

"""The path of the centre against the exact outline of a sphere that rolls over the polygon."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.slope_rockfall.declarations import PATH
from rockshed.components.slope_rockfall.geometry import line_below, path_y
from tests.slope_rocks import clearance, plane, slope

cells = st.lists(st.tuples(st.floats(0.05, 5.0), st.floats(-1.3, 1.3)), min_size=1, max_size=20)


def nodes_of(cells):
    """Nodes of cells given by width and inclination, the end cells as long as the path takes them to be."""
    widths, angles = np.array(cells).T
    x, y = np.r_[0.0, np.cumsum(widths)], np.r_[0.0, np.cumsum(-widths * np.tan(angles))]
    longer = np.c_[x, y].copy()
    longer[0] -= 1000.0 * np.array([1.0, -math.tan(angles[0])])
    longer[-1] += 1000.0 * np.array([1.0, -math.tan(angles[-1])])
    return np.c_[x, y], longer


@settings(max_examples=150)
@given(cells, st.sampled_from([0.01, 0.1, 0.5, 2.0]))
def test_the_path_touches_the_slope_and_never_cuts_it(cells, radius):
    nodes, longer = nodes_of(cells)
    instance = slope(
        nodes, radius=radius, friction=0.1, on_slope=1.0, position0__x=float(nodes[0, 0])
    )
    path, lines = instance.state("path"), int(instance.state("lines")[0])
    gaps = []
    for x in np.linspace(nodes[0, 0] - 1.0, nodes[-1, 0] + 1.0, 300):
        gaps.append(clearance(longer, x, path_y(line_below(x, lines, path), x, path), radius))
    assert min(gaps) > -1e-9
    assert max(gaps) < radius * (1.0 / math.cos(math.radians(15.0)) - 1.0) + 1e-9
    ends = path[PATH.right : len(PATH) * lines : len(PATH)]
    assert np.all(np.diff(ends) >= 0.0)


def test_on_one_cell_the_rock_lies_its_radius_off_it():
    rock = plane(0.5, radius=0.7)
    assert rock["position.y"] == pytest.approx(0.7 / math.cos(0.5), rel=1e-12)
    assert rock["height"] == pytest.approx(0.0, abs=1e-12)


def test_a_notch_too_narrow_for_the_rock_is_passed_over():
    rock = slope(
        [(-50, 0), (0, 0), (0.1, -5), (0.2, 0), (50, 0)],
        radius=0.5,
        on_slope=1.0,
        position0__x=-2.0,
        velocity0__x=5.0,
        angular_velocity0=-10.0,
        friction=0.5,
    )
    rock.step(0.0, 1.0)
    assert rock["position.x"] > 2.5
    assert rock["position.y"] == pytest.approx(0.5, abs=1e-2)


def test_a_small_bump_lifts_a_large_rock_by_its_height_only():
    rock = slope([(-50, 0), (0, 0), (0.02, 0.02), (0.04, 0), (50, 0)], radius=1.0, start=False)
    rock["on_slope"], rock["position0.x"] = 1.0, 0.02
    rock.initialise()
    assert 1.02 - 1e-12 <= rock["position.y"] < 1.02 + 0.036

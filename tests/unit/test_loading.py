"""Load-penetration curves of known shape."""

import numpy as np
import pytest

from rockshed.metrics.load_curve import DEPTH, WINDOW, LoadCurve, load_curve


def curve(load, depth=0.042, points=843):
    places = np.linspace(0.0, depth, points)
    return LoadCurve(places, load(places))


def test_a_straight_line_is_its_own_secant():
    line = curve(lambda x: 3e4 * x)
    assert float(line.at(DEPTH)) == pytest.approx(1200.0, rel=1e-5)
    assert line.departure(DEPTH) < 1e-5


def test_departure_of_a_parabola():
    """Root mean square of (x/d)^2 - x/d is 1/sqrt(30)."""
    assert curve(lambda x: x**2).departure(DEPTH) == pytest.approx(30.0**-0.5, rel=1e-2)


def test_jumps_within_the_window_are_averaged():
    saw = curve(lambda x: 1000.0 + 500.0 * np.sign(np.sin(4.0 * np.pi * x / WINDOW)), points=84001)
    assert float(saw.at(0.02)) == pytest.approx(1000.0, rel=1e-3)


def test_a_depth_is_reached_when_the_whole_window_is():
    assert curve(lambda x: x).reaches(DEPTH)
    assert not curve(lambda x: x, depth=DEPTH).reaches(DEPTH)
    assert not LoadCurve(np.array([0.03]), np.array([1.0])).reaches(0.03)


def test_only_rows_of_a_sinking_rock_count():
    series = {
        "sand.penetration": np.array([-0.1, 0.0, 0.1, 0.05, 0.2]),
        "sand.rock.force.y": np.arange(5.0),
    }
    found = load_curve(series, "sand")
    assert list(found.depth) == [-0.1, 0.0, 0.1, 0.2]
    assert list(found.load) == [0.0, 1.0, 2.0, 4.0]
    assert load_curve({}, "sand") is None

"""The part of the world that a picture of the sand shows."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from rockshed.pictures.sand import Frame, _window

STRIP = 0.06 * (0.4 + 2 * 0.024)
"""Height (m) of the strip with the scale, below a box of 40 cm with its margins."""


def state(beam, rock):
    """Sand 10 cm high in a box of 40 cm on beam discs, at height 0.025 m, that have gone down."""

    def discs(y, radius):
        y = np.atleast_1d(np.array(y, float))
        return SimpleNamespace(x=np.zeros_like(y), y=y, radius=np.full_like(y, radius))

    box = SimpleNamespace(left=0.0, width=0.4, base=0.025, wall_top=math.inf, wall_thickness=0.2)
    return SimpleNamespace(
        box=box, beam=discs(beam, 0.025), rock=discs(rock, 0.05), discs=discs([0.03, 0.12], 0.005)
    )


def bottom(*pairs):
    return _window([Frame(0.0, state(*pair)) for pair in pairs])[2]


def test_the_beam_stays_in_the_picture_however_far_it_gives_way():
    assert bottom(([0.0, 0.0], 0.2)) == pytest.approx(0.025 - 0.055 - STRIP)
    deep = ([-0.1, -0.15, -0.1], 0.1)
    assert bottom(([0.0, 0.0], 0.2), deep) < -0.15 - 0.025
    assert bottom(([0.0, 0.0], -0.2)) < -0.25


def test_a_rock_that_is_far_below_does_not_make_the_sand_small():
    assert bottom(([0.0, 0.0], -100.0)) == pytest.approx(0.025 - 1.2 * 0.4 - STRIP)

"""The published stable step against the growth of small disturbances."""

import numpy as np
import pytest

from tests.sand_discs import SMALL_BOX, cushion, rows

ROUGH = {"friction_angle": 1.4, "wall.friction_angle": 1.4}
"""No contact slides, so that the motion about rest is linear."""


def grows(step_ratio, **parameters):
    """Whether a disturbance of 1e-9 m/s grows thousandfold within 3000 steps of ``step_ratio``
    stable steps."""
    sand = cushion(
        {**SMALL_BOX, **ROUGH, "packing": "hexagonal", "internal_step": 1.0, **parameters}, discs=95
    )
    random, step = np.random.default_rng(1), step_ratio * sand["stable_step"]
    rows(sand)[:, 2:4] += random.normal(0.0, 1e-9, (95, 2))
    if parameters["rotation"] == "free":
        rows(sand)[:, 4] += random.normal(0.0, 1e-7, 95)
    for _ in range(3000):
        sand.step(0.0, step)
        if abs(rows(sand)[:, 2:4]).max() > 1e-6:
            return True
    return False


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"damping": 0.05},
        {"damping": 1.0},
        {"tangential_ratio": 1.0},
        {"tangential_ratio": 3.0},
        {"rolling_resistance": 1.0},
        {"modulus": 1e7},
        {"disc.radius": 0.004},
    ],
    ids=str,
)
@pytest.mark.parametrize("rotation", ["free", "locked"])
def test_the_stable_step_is_stable_and_not_much_too_small(rotation, changes):
    """Measured limits on a hexagonal packing: 1.01 to 1.39 times the published step."""
    assert not grows(1.0, rotation=rotation, **changes)
    assert grows(1.45, rotation=rotation, **changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"unloading_ratio": 5.0},
        {"cohesion": 5e3},
        {"unloading_ratio": 3.0, "cohesion": 5e3, "rolling_resistance": 0.3},
        {"base": "beam_discs", "beam.disc_mass": 1.5},
        {"base": "beam_surface", "beam.disc_mass": 1.5},
    ],
    ids=str,
)
@pytest.mark.parametrize("rotation", ["free", "locked"])
def test_the_stable_step_knows_the_options(rotation, changes):
    assert not grows(1.0, rotation=rotation, **changes)


def test_heavy_beam_discs_in_the_dashpots_ask_for_shorter_steps():
    """Without them in the published step the sand would be told to go unstable."""
    light, heavy = (
        cushion({**SMALL_BOX, "base": "beam_discs", "beam.disc_mass": m})["stable_step"]
        for m in (0.0, 1.5)
    )
    assert heavy < 0.5 * light
    assert grows(light / heavy, rotation="locked", base="beam_discs", **{"beam.disc_mass": 1.5})

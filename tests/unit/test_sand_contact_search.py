"""The contact search finds every contact, and keeps what the contacts remember."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.sand_discs import (
    RADIUS,
    SMALL_BOX,
    cushion,
    discs_at,
    force_rebuild,
    masses,
    rows,
    run,
    sand_stiffness,
    stirred,
)

SOFT = {
    "friction_angle": 0.0,
    "damping": 0.0,
    "wall.stiffness_ratio": 1e-9,
    "base.stiffness_ratio": 1e-9,
}
"""Elastic smooth discs; boundaries so soft that they do not count."""
CHANGES = [
    {"rotation": "free"},
    {"rotation": "locked"},
    {"rotation": "free", "rolling_resistance": 0.3},
]


def spring_forces(instance):
    """Forces on all discs by looking at every pair."""
    body, stiffness = rows(instance), sand_stiffness(instance)
    apart = body[None, :, :2] - body[:, None, :2]
    distance = np.hypot(apart[..., 0], apart[..., 1]) + np.eye(len(body))
    overlap = np.maximum(0.0, body[:, None, 5] + body[None, :, 5] - distance) * (
        1.0 - np.eye(len(body))
    )
    return -(stiffness * overlap / distance)[..., None] * apart


@settings(max_examples=30)
@given(
    count=st.integers(1, 60),
    seed=st.integers(0, 10**6),
    crowd=st.floats(1.2, 6.0),
    speed=st.floats(0.0, 5.0),
    box=st.sampled_from([(-5.0, 10.0, -5.0), (-0.02, 0.04, -0.02), (-0.3, 0.1, -0.3)]),
    spread=st.sampled_from([0.0, 0.5]),
)
def test_forces_are_those_of_all_pairs_while_discs_fly_about(
    count, seed, crowd, speed, box, spread
):
    """Also for discs outside the box, on whose width the grid of the search is laid."""
    random = np.random.default_rng(seed)
    half = crowd * RADIUS * np.sqrt(count)
    parameters = {
        **SOFT,
        "packing": "random",
        "disc.spread": spread,
        "rotation": "locked",
        **dict(zip(("box.left", "box.width", "base.y"), box)),
    }
    discs = discs_at(
        random.uniform(-half, half, (count, 2)),
        random.normal(0.0, speed + 1e-9, (count, 2)),
        parameters=parameters,
    )
    step = 1e-5
    for _ in range(60):
        expected = spring_forces(discs).sum(axis=1)
        before = rows(discs)[:, 2:4].copy()
        discs.step(0.0, step)
        force = (rows(discs)[:, 2:4] - before) / step * masses(discs)[:, None]
        assert force == pytest.approx(expected, abs=1e-3 + 1e-9 * abs(expected).max())


@pytest.mark.parametrize("changes", CHANGES, ids=str)
@pytest.mark.parametrize("base", ["floor", "beam_surface", "beam_discs"])
def test_a_rebuild_in_every_step_changes_no_bit(base, changes):
    """Tangential springs and rolling moments survive it, and the order of contacts does not matter
    or stays."""
    rare, often = (
        stirred(cushion({**SMALL_BOX, "base": base, "packing": "hexagonal", **changes}), 0.1)
        for _ in range(2)
    )
    for _ in range(300):
        force_rebuild(often)
        run(rare, 2e-5)
        run(often, 2e-5)
    assert rare["energy.sliding"] > 0.0
    np.testing.assert_array_equal(rows(rare), rows(often))
    np.testing.assert_array_equal(rare.state("angle"), often.state("angle"))


def test_a_sheared_contact_holds_the_disc_across_rebuilds():
    """A locked disc that has been pushed sideways swings about the point where it touched down, as
    only its spring can tell."""
    disc = discs_at(
        [(0.0, RADIUS - 1e-6)],
        [(1e-4, 0.0)],
        parameters={"base.y": 0.0, "gravity": 20.0, "rotation": "locked", "damping": 0.0},
    )
    furthest = 0.0
    for _ in range(2000):
        force_rebuild(disc)
        run(disc, 1e-5)
        furthest = max(furthest, abs(rows(disc)[0, 0]))
    amplitude = 1e-4 / np.sqrt(disc["tangential_ratio"] * sand_stiffness(disc) / masses(disc)[0])
    assert furthest == pytest.approx(amplitude, rel=0.05)


def test_a_newcomer_in_the_list_leaves_the_others_their_springs():
    """A disc with a lower number comes down on the floor far away, and two more meet in the air."""
    on_floor = {"base.y": 0.0, "gravity": 20.0, "rotation": "locked", "damping": 0.0}
    sheared, pressed = (0.0, RADIUS - 1e-6), (1.0, RADIUS - 1e-6)
    others = [(-1.0, 2.2 * RADIUS), (-2.0, 0.5), (-2.0 + 2.4 * RADIUS, 0.5)]
    alone = discs_at([sheared, pressed], [(1e-3, 0.0), (0.01, 0.0)], parameters=on_floor)
    crowd = discs_at(
        [*others, sheared, pressed],
        [(0.0, -1.0), (1.0, 0.0), (0.0, 0.0), (1e-3, 0.0), (0.01, 0.0)],
        parameters=on_floor,
    )
    for _ in range(1000):
        run(alone, 1e-5)
        run(crowd, 1e-5)
    assert rows(crowd)[0, 3] > 0.0
    assert rows(crowd)[2, 2] > 0.0
    np.testing.assert_array_equal(rows(crowd)[3:], rows(alone))


def test_a_contact_that_opens_forgets():
    """The second touch of a disc that has rubbed the floor begins with a slack spring: no push back
    where it did not come from."""
    disc = discs_at(
        [(0.0, RADIUS)],
        [(0.2, -0.2)],
        parameters={"base.y": 0.0, "rotation": "locked", "damping": 0.0},
    )
    run(disc, 5e-3)
    assert rows(disc)[0, 3] > 0.0
    rows(disc)[0, 2:4] = 0.0, -0.2
    force_rebuild(disc)
    run(disc, 0.2)
    assert rows(disc)[0, 3] == pytest.approx(0.2, rel=1e-2)
    assert rows(disc)[0, 2] == pytest.approx(0.0, abs=1e-12)

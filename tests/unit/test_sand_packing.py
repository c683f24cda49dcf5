"""Where the discs lie at the start."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rockshed.components.common.component import ComponentError
from tests.sand_discs import RADIUS, SMALL_BOX, cushion, masses, rows

BOX = {**SMALL_BOX, "settling.time": 0.0, "rock.position.y": 10.0}


def test_the_paper_s_square_lattice_has_ten_rows_of_37():
    sand = cushion({**SMALL_BOX, "box.width": 0.37, "gravity": 0.0}, discs=370)
    x, y = rows(sand)[:, 0].reshape(10, 37), rows(sand)[:, 1].reshape(10, 37)
    assert x == pytest.approx(np.tile(RADIUS + 0.01 * np.arange(37), (10, 1)))
    assert y == pytest.approx(np.tile((RADIUS + 0.01 * np.arange(10))[:, None], (1, 37)))
    assert sand["surface_height"] == pytest.approx(0.1)


def test_a_hexagonal_lattice_has_its_rows_in_the_gaps_of_the_one_below():
    sand = cushion({**BOX, "packing": "hexagonal", "gravity": 0.0}, discs=57)
    heights, counts = np.unique(rows(sand)[:, 1].round(12), return_counts=True)
    assert counts.tolist() == [10, 9, 10, 9, 10, 9]
    assert np.diff(heights) == pytest.approx(math.sqrt(3.0) * RADIUS)
    assert rows(sand)[10:19, 0] == pytest.approx(0.01 + 0.01 * np.arange(9))


@pytest.mark.parametrize("spread", [0.0, 0.25, 0.5])
def test_random_radii_fill_the_spread(spread):
    sand = cushion({**BOX, "packing": "random", "disc.spread": spread}, discs=500)
    scaled = rows(sand)[:, 5] / RADIUS - 1.0
    assert abs(scaled).max() <= spread + 1e-12
    assert scaled.mean() == pytest.approx(0.0, abs=4.0 * spread / math.sqrt(3.0 * 500) + 1e-12)
    assert scaled.std() == pytest.approx(spread / math.sqrt(3.0), rel=0.1, abs=1e-12)
    assert masses(sand) == pytest.approx(1800.0 * math.pi * rows(sand)[:, 5] ** 2 * 0.1)


def test_a_random_heap_starts_without_touching():
    sand = cushion({**BOX, "packing": "random", "disc.spread": 0.5}, discs=200)
    assert sand["energy.elastic"] == 0.0
    assert sand["transmitted_force"] == 0.0


def test_seeds_give_samples():
    random = {**SMALL_BOX, "packing": "random", "disc.spread": 0.25}
    first, again, other = (rows(cushion({**random, "seed": seed})) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first[:, 5], other[:, 5])
    assert abs(first[:, :2] - other[:, :2]).max() > RADIUS


def test_lattice_shift_moves_each_disc_by_up_to_its_part_of_the_diameter():
    plain, moved = (rows(cushion({**BOX, "lattice_shift": shift}))[:, :2] for shift in (0.0, 0.1))
    way = abs(moved - plain)
    assert way.max() <= 0.1 * 2 * RADIUS
    assert way.mean() == pytest.approx(0.05 * 2 * RADIUS, rel=0.2)


@pytest.mark.parametrize("packing", ["square", "hexagonal", "random"])
def test_settled_discs_lie_in_the_box(packing):
    sand = cushion({**SMALL_BOX, "packing": packing, "disc.spread": 0.25, "rotation": "free"})
    x, y, radius = rows(sand)[:, 0], rows(sand)[:, 1], rows(sand)[:, 5]
    slack = 5e-5
    assert (x - radius).min() > -slack
    assert (x + radius).max() < 0.1 + slack
    assert (y - radius).min() > -slack
    assert sand["surface_height"] <= (y + radius).max() + 1e-15


def test_surface_height_is_that_under_the_rock():
    """Lattice of six discs in a box for ten: nothing lies under a rock at the right end."""
    narrow = {**BOX, "rock.radius": 0.01}
    assert cushion({**narrow, "rock.position.x": 0.01}, discs=16)[
        "surface_height"
    ] == pytest.approx(0.02, rel=1e-3)
    assert cushion({**narrow, "rock.position.x": 0.09}, discs=16)[
        "surface_height"
    ] == pytest.approx(0.01, rel=1e-3)


@pytest.mark.parametrize(("packing", "discs"), [("square", 60), ("hexagonal", 48)])
def test_the_level_of_a_lattice_with_a_full_row_on_top_is_its_top(packing, discs):
    sand = cushion({**BOX, "packing": packing, "gravity": 0.0}, discs=discs)
    assert sand["surface_level"] == pytest.approx(sand["surface_height"], rel=1e-12)


def test_the_level_of_the_surface_is_the_mean_of_the_highest_discs_in_its_columns():
    """Six of the ten columns of a square lattice have a disc more."""
    sand = cushion({**BOX, "gravity": 0.0}, discs=16)
    assert sand["surface_level"] == pytest.approx(0.016, rel=1e-12)


def bent_beam(lift, turn):
    """Beam discs under a box of 0.2 m whose tops lie on lift(x), with the angles turn(x)."""
    count, spacing = 12, 0.02
    x = -0.02 + (np.arange(count) + 0.5) * spacing
    angle = turn(x)
    return {
        "base": "beam_surface",
        "box.left": 0.0,
        "box.width": 0.2,
        "beam.radius": 0.5 * spacing,
        "beam.position.x": x + 0.5 * spacing * angle,
        "beam.position.y": np.array([lift(place) for place in x]) - 0.5 * spacing,
        "beam.angle": angle,
    }


def level_of(beam, left=0.0, width=0.2):
    """Mean level of a beam's surface under a box, from the height of the layer and its discs."""
    given = {**beam, "box.left": left, "box.width": width}
    sand = cushion({**BOX, **given, "gravity": 0.0, "rotation": "free"}, discs=20, elements=12)
    centre = (masses(sand) @ rows(sand)[:, 1]) / masses(sand).sum()
    return centre - 0.5 * sand["layer.height"]


@pytest.mark.parametrize(("left", "width"), [(0.0, 0.2), (0.013, 0.111), (-0.02, 0.24)])
@pytest.mark.parametrize("slope", [0.0, 0.1, -0.1])
def test_the_mean_level_of_a_tilted_beam_is_that_at_the_middle_of_the_box(slope, left, width):
    beam = bent_beam(lambda x: 0.01 + slope * x, lambda x: 0.0 * x)
    level = 0.01 + slope * (left + 0.5 * width)
    assert level_of(beam, left, width) == pytest.approx(level, abs=1e-12)


@pytest.mark.parametrize(("left", "width"), [(0.0, 0.2), (0.013, 0.111)])
def test_the_mean_level_of_a_bent_beam_is_that_of_its_chords(left, width):
    """Chords of the length a lie over the parabola c x^2 by c a^2 / 6 on average."""
    bend = 0.5
    beam = bent_beam(lambda x: bend * (x - 0.1) ** 2, lambda x: 0.05 * np.sin(40.0 * x))
    right = left + width
    parabola = bend * ((right - 0.1) ** 3 - (left - 0.1) ** 3) / (3.0 * width)
    chords = bend * 0.02**2 / 6.0
    assert level_of(beam, left, width) == pytest.approx(parabola + chords, abs=0.2 * chords)


PREPARED = {
    "packing": "prepared",
    "disc.spread": 0.25,
    "rotation": "free",
    "stiffness_factor": 1.0,
    "rolling_resistance": 0.3,
    "settling.time": 0.2,
    "rock.position.y": 2.0,
    "base": "floor",
    "box.left": 0.0,
    "box.width": 0.2,
}


@pytest.mark.parametrize("share", [0.735, 0.75])
def test_a_prepared_layer_has_the_solid_fraction_that_was_asked_for(share):
    sand = cushion({**PREPARED, "solid_fraction": share}, discs=200)
    assert sand["layer.solid_fraction"] == pytest.approx(share, abs=0.006)
    height = 2.0 * (masses(sand) @ rows(sand)[:, 1]) / masses(sand).sum()
    assert sand["layer.height"] == pytest.approx(height)
    assert math.pi * (rows(sand)[:, 5] ** 2).sum() / (0.2 * height) == pytest.approx(
        sand["layer.solid_fraction"]
    )


@settings(max_examples=6, suppress_health_check=list(HealthCheck))
@given(
    width=st.floats(30.0, 60.0),
    thickness=st.floats(16.0, 24.0),
    share=st.floats(0.735, 0.745),
    seed=st.integers(1, 10_000),
)
def test_a_levelled_layer_ends_near_the_thickness_that_its_discs_give(
    width, thickness, share, seed
):
    """Lengths in mean radii. As settled, single discs stand out by up to 4.

    The radii are drawn, so the discs' own area gives the thickness, not the mean one: it differs by
    up to 1.2. Of 500 layers drawn, the highest discs were 0.1 under to 1.3 over it, the levels 0.1
    to 0.9 under it.
    """
    discs = round(share * width * thickness / (math.pi * (1.0 + 0.25**2 / 3.0)))
    given = {"box.width": width * RADIUS, "solid_fraction": share, "seed": seed}
    sand = cushion({**PREPARED, **given, "surface": "levelled"}, discs=discs)
    radii = rows(sand)[:, 5]
    given_by_discs = math.pi * (radii**2).sum() / (width * share * RADIUS**2)
    assert -0.5 < (rows(sand)[:, 1] + radii).max() / RADIUS - given_by_discs < 1.6
    assert -1.2 < sand["surface_level"] / RADIUS - given_by_discs < 0.0


def test_levelling_is_for_prepared_layers_only():
    lattice = {**BOX, "lattice_shift": 0.1}
    plain, levelled = (rows(cushion({**lattice, **more})) for more in ({}, {"surface": "levelled"}))
    np.testing.assert_array_equal(plain, levelled)


def test_a_lattice_has_the_height_of_its_columns():
    sand = cushion({**SMALL_BOX, "gravity": 0.0, "settling.time": 0.0}, discs=60)
    assert sand["layer.height"] == pytest.approx(0.06)
    assert sand["layer.solid_fraction"] == pytest.approx(math.pi / 4.0)


@pytest.mark.parametrize(
    ("share", "why"),
    [
        (0.85, "cannot be packed as densely as solid_fraction = 0.85: it reaches 0.7"),
        (0.6, "cannot lie as loosely as solid_fraction = 0.6: with its friction it falls to 0.7"),
    ],
)
def test_a_solid_fraction_out_of_reach_is_refused_with_what_is(share, why):
    with pytest.raises(ComponentError, match=why):
        cushion({**PREPARED, "solid_fraction": share}, discs=200)


def test_cohesion_does_not_hold_a_layer_up_while_it_is_prepared():
    dry, moist = (
        cushion({**PREPARED, "solid_fraction": 0.74, "cohesion": c}, discs=200) for c in (0.0, 5e3)
    )
    assert moist["layer.solid_fraction"] == pytest.approx(dry["layer.solid_fraction"], abs=0.01)
    assert moist["energy.capillary"] < 0.0 == dry["energy.capillary"]


def test_the_density_of_the_layer_is_carried_by_its_discs():
    sand = cushion({**PREPARED, "solid_fraction": 0.74, "density_of": "layer"}, discs=200)
    assert masses(sand).sum() == pytest.approx(
        1800.0 * 0.2 * sand["layer.height"] * sand["thickness"], rel=0.01
    )

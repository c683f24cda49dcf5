"""Where the discs lie at the start."""

import math

import numpy as np
import pytest

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

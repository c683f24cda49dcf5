"""Settled sand: what it weighs on base and walls."""

import pytest

from tests.sand_discs import SMALL_BOX, cushion, rows, run, weight

BASES = ["floor", "beam_surface", "beam_discs"]
PACKINGS = ["square", "hexagonal", "random"]


def settled(base, packing, **changes):
    return cushion({**SMALL_BOX, "base": base, "packing": packing, "disc.spread": 0.25, **changes})


@pytest.mark.parametrize("rotation", ["free", "locked"])
@pytest.mark.parametrize("packing", PACKINGS)
@pytest.mark.parametrize("base", BASES)
def test_base_between_smooth_walls_carries_the_weight(base, packing, rotation):
    sand = settled(base, packing, rotation=rotation, **{"wall.friction_angle": 0.0})
    assert sand["transmitted_force"] == pytest.approx(weight(sand), rel=1e-5)
    run(sand, 0.01)
    assert sand["transmitted_force"] == pytest.approx(weight(sand), rel=1e-4)
    assert abs(rows(sand)[:, 2:4]).max() < 1e-6


@pytest.mark.parametrize("base", ["beam_surface", "beam_discs"])
def test_transmitted_force_is_what_the_beam_feels(base):
    sand = settled(base, "random", rotation="free")
    assert sand["transmitted_force"] == pytest.approx(-sand["beam.force.y"].sum(), rel=1e-12)


@pytest.mark.parametrize("base", ["beam_surface", "beam_discs"])
def test_rough_walls_carry_their_part_which_reaches_the_beam_when_they_stand_on_it(base):
    fixed, standing = (
        settled(base, "random", rotation="free", walls=walls) for walls in ("fixed", "on_beam")
    )
    carried = 1.0 - fixed["transmitted_force"] / weight(fixed)
    assert 0.01 < abs(carried) < 0.2  # friction holds the pack up, or down where it sprang back
    assert standing["transmitted_force"] == pytest.approx(weight(standing), rel=1e-4)
    assert -standing["beam.force.y"].sum() == pytest.approx(weight(standing), rel=1e-4)
    brought = fixed["beam.force.y"] - standing["beam.force.y"]
    assert brought.sum() == pytest.approx(carried * weight(fixed), rel=1e-3)
    right = 2.0 * brought[2]  # that wall stands midway between discs 2 and 3, the left one at x = 0
    assert standing["beam.position.x"] @ brought == pytest.approx(0.1 * right)


def test_a_square_lattice_on_the_floor_needs_no_settling():
    """Every disc starts with the overlap that its load asks for."""
    sand = settled("floor", "square", **{"settling.time": 0.0})
    run(sand, 0.01)
    assert abs(rows(sand)[:, 2:4]).max() < 1e-9
    assert sand["transmitted_force"] == pytest.approx(weight(sand), rel=1e-9)


def test_the_start_is_at_rest_and_settling_leaves_no_trace_in_the_balance():
    sand = settled("beam_discs", "random", rotation="free")
    assert sand["energy.kinetic"] == 0.0
    assert sand["energy.start"] == pytest.approx(
        sand["energy.elastic"] + sand["energy.gravity"], rel=1e-12
    )
    for name in (
        "normal_dashpot",
        "tangential_dashpot",
        "sliding",
        "rolling",
        "work.rock",
        "work.beam",
        "residual",
    ):
        assert sand[f"energy.{name}"] == 0.0

"""The cushion says how far it was from rest at the start."""

from tests.sand_discs import SMALL_BOX, cushion


def test_settled_sand_is_at_rest():
    assert (
        cushion({**SMALL_BOX, "packing": "random", "disc.spread": 0.2})["unbalanced_force_ratio"]
        < 1e-5
    )


def test_a_lattice_with_its_own_overlaps_is_at_rest_without_settling():
    assert (
        cushion({**SMALL_BOX, "base": "floor", "packing": "square", "settling.time": 0.0})[
            "unbalanced_force_ratio"
        ]
        < 1e-9
    )


def test_a_heap_that_has_not_settled_is_not():
    assert (
        cushion({**SMALL_BOX, "packing": "random", "settling.time": 0.0})["unbalanced_force_ratio"]
        > 0.5
    )

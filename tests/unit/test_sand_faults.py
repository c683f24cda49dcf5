"""What the sand cushion refuses, and what it says then."""

import math

import numpy as np
import pytest

from rockshed.components.common.component import ComponentError
from rockshed.components.sand_cushion import COMPONENT
from rockshed.components.sand_cushion.faults import ROCK_TOO_FAST
from tests.sand_discs import SMALL_BOX, cushion, discs_at, run, stirred


def test_all_bad_values_are_named_at_once():
    with pytest.raises(ComponentError) as refusal:
        cushion(
            {
                "disc.radius": -0.005,
                "modulus": math.nan,
                "thickness": 0.0,
                "damping": -0.1,
                "packing": 9.0,
                "rock.position.y": math.inf,
            }
        )
    assert len(refusal.value.problems) == 6
    assert "disc.radius = -0.005 m: allowed is 1e-09 m or more" in str(refusal.value)
    assert "modulus = nan: must be a finite number" in str(refusal.value)


def test_an_unknown_choice_is_answered_with_the_known_ones():
    with pytest.raises(ComponentError, match="rotation = frei: choose one of free, locked"):
        cushion({"rotation": "frei"})


def test_cohesion_without_friction_has_no_force():
    with pytest.raises(
        ComponentError, match=r"cohesion = 500 Pa needs friction.*friction_angle is 0"
    ):
        cushion({**SMALL_BOX, "cohesion": 500.0, "friction_angle": 0.0})


def test_smooth_contacts_that_yield_are_no_fault():
    sand = cushion({**SMALL_BOX, "unloading_ratio": 3.0, "friction_angle": 0.0})
    run(sand, 1e-3)
    assert math.isfinite(
        sand["energy.kinetic"] + sand["energy.plastic"] + sand["transmitted_force"]
    )


@pytest.mark.parametrize("sizes", [{"discs": 0}, {"elements": 0}])
def test_nothing_is_no_size(sizes):
    with pytest.raises(ComponentError, match="allowed is 1 to"):
        COMPONENT.instance(**sizes)


@pytest.mark.parametrize("base", ["beam_discs", "beam_surface", "floor"])
@pytest.mark.parametrize("y", [-0.02, -0.06, -0.3, -5.0])
def test_a_rock_that_starts_in_or_under_what_carries_the_sand_is_refused(base, y):
    """The beam's discs, of a radius of 25 mm, have their centres at y = 0, the floor is there."""
    with pytest.raises(ComponentError, match=r"starts (inside the sand|in or under what carries)"):
        cushion({**SMALL_BOX, "base": base, "rock.position.y": y, "rock.radius": 0.04}, elements=3)


def test_a_rock_may_start_on_the_base_beside_the_sand():
    on_floor = {**SMALL_BOX, "rock.position.y": 0.02, "rock.radius": 0.02}
    assert cushion({**on_floor, "rock.position.x": 0.079}, discs=5)["rock.force.y"] == 0.0


def test_a_rock_that_comes_over_a_low_wall_may_start_below_the_base():
    beside = {"box.wall_height": 0.2, "rock.position.x": -1.0, "rock.position.y": -0.5}
    for base in ("beam_discs", "beam_surface", "floor"):
        cushion({**SMALL_BOX, **beside, "base": base}, elements=3)


@pytest.mark.parametrize(("kinematics", "reach"), [("held", 1e-3), ("linear", 1e-5)])
def test_a_rock_that_jumps_over_contacts_is_refused_in_the_step(kinematics, reach):
    """Held inputs move the rock once in a communication step, linear ones in each internal step."""
    sand = cushion({**SMALL_BOX, "kinematics": kinematics, "internal_step": 1e-5})
    for velocity, status in ((0.99, 0), (1.01, ROCK_TOO_FAST)):
        sand["rock.velocity.y"] = -velocity * 0.005 / reach
        assert COMPONENT.step(0.0, 1e-3, sand.w, sand.x, sand.k) == status
    assert "moves on by more than the radius of a sand disc, 0.005 m" in sand.message(status)


def test_a_rock_inside_the_sand():
    with pytest.raises(
        ComponentError,
        match=r"reaches up to 0\.05997\d* m.*position0\.y, at 0\.0895 m.*radius of 0\.0495 m",
    ):
        cushion({**SMALL_BOX, "rock.position.y": 0.06 - 0.02 + 0.0495})


def test_a_rock_that_touches_the_sand_is_no_fault():
    surface = cushion(SMALL_BOX)["surface_height"]
    cushion(
        {
            **SMALL_BOX,
            "rock.radius": 0.04,
            "rock.position.x": 0.055,
            "rock.position.y": surface + 0.04,
        }
    )


@pytest.mark.parametrize(
    "box", [{"box.left": -0.01, "box.width": 0.1}, {"box.left": 0.15, "box.width": 0.1}], ids=str
)
@pytest.mark.parametrize("base", ["beam_discs", "beam_surface"])
def test_a_beam_narrower_than_the_cushion(base, box):
    with pytest.raises(
        ComponentError,
        match=f"beam is narrower.*box.left = {box['box.left']}.*make the beam longer",
    ):
        cushion({**SMALL_BOX, "base": base, **box})
    cushion({**SMALL_BOX, "base": "floor", **box})


def test_beam_discs_out_of_order():
    with pytest.raises(ComponentError, match="from left to right"):
        cushion(
            {
                **SMALL_BOX,
                "base": "beam_discs",
                "beam.position.x": np.array((0.025, 0.125, 0.075, 0.175)),
            }
        )


@pytest.mark.parametrize("place", [-1.0, 0.02, 0.08, 0.3])
def test_a_rock_in_or_behind_a_side_wall(place):
    with pytest.raises(
        ComponentError,
        match=r"side wall.*radius of 0\.0495 m at x = .*box from 0 m on, 0\.1 m wide",
    ):
        cushion({**SMALL_BOX, "rock.position.x": place, "rock.radius": 0.0495})


def test_discs_wider_than_the_box():
    with pytest.raises(ComponentError, match=r"disc of radius 0\.06 m.*0\.1 m wide"):
        cushion({**SMALL_BOX, "disc.radius": 0.06}, discs=1)


def test_gaps_between_the_beam_discs():
    spread = {"base": "beam_discs", "beam.radius": 0.02}
    with pytest.raises(
        ComponentError, match=r"gaps between the beam discs: beam\.radius = 0\.02 m"
    ):
        cushion({**SMALL_BOX, **spread})
    cushion({**SMALL_BOX, **spread, "base": "beam_surface", "box.left": 0.01})


def test_more_neighbours_than_there_is_room_for():
    with pytest.raises(ComponentError, match="no more room for contact candidates"):
        discs_at([(1e-5 * i, 1e-5 * i * i) for i in range(60)])


def test_a_step_far_above_the_stable_one_ends_with_both_numbers():
    sand = stirred(cushion({**SMALL_BOX, "packing": "hexagonal", "internal_step": 1e-3}), 0.1)
    both = rf"internal step 0\.001 s stands against a stable step of {sand['stable_step']:.6g} s"
    with pytest.raises(ComponentError, match=rf"at t = .*{both}"):
        run(sand, 5.0, 1e-3)

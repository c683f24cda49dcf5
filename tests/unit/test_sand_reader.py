"""A serialized state, decoded."""

import dataclasses
import math

import numpy as np
import pytest

from rockshed.components.common.component import ComponentError
from rockshed.components.sand_cushion import reader
from tests.sand_discs import (
    RADIUS,
    SMALL_BOX,
    cushion,
    discs_at,
    masses,
    rows,
    run,
    sand_stiffness,
    weight,
)

SIZES = {"discs": 60, "elements": 4}


def pressed(**changes):
    """A random packing that the rock has pressed into at 2 m/s for 5 ms, its state serialized."""
    parameters = {
        **SMALL_BOX,
        "base": "beam_discs",
        "packing": "random",
        "disc.spread": 0.2,
        "rotation": "free",
        "rock.radius": 0.02,
        "kinematics": "linear",
    }
    sand = cushion({**parameters, **changes})
    sand["rock.position.y"], sand["rock.velocity.y"] = sand["surface_height"] + 0.02, -2.0
    run(sand, 5e-3)
    return sand, reader.read(sand.to_bytes(), SIZES)


def test_bodies_and_box_are_where_the_state_has_them():
    sand, state = pressed()
    np.testing.assert_array_equal(
        np.column_stack(
            (state.discs.x, state.discs.y, state.discs.velocity_x, state.discs.velocity_y)
        ),
        rows(sand)[:, :4],
    )
    np.testing.assert_array_equal(state.discs.radius, rows(sand)[:, 5])
    np.testing.assert_array_equal(state.discs.angle, sand.state("angle"))
    assert abs(state.discs.angle).max() > 0.0
    assert (state.rock.x[0], state.rock.radius[0]) == (0.05, 0.02)
    assert state.rock.y[0] == pytest.approx(sand["surface_height"] + 0.01, abs=1e-4)
    np.testing.assert_array_equal(state.beam.x, sand["beam.position.x"])
    assert state.beam.radius.tolist() == [0.025] * 4
    assert dataclasses.astuple(state.box) == (0.0, 0.1, 0.0, math.inf, 0.2)


def test_contacts_are_all_pairs_that_overlap():
    _, state = pressed()
    x, y, radius = (
        np.concatenate([getattr(bodies, name) for bodies in (state.discs, state.rock, state.beam)])
        for name in ("x", "y", "radius")
    )
    expected = {
        (i, j)
        for i in range(61)
        for j in range(i + 1, 65)
        if np.hypot(x[j] - x[i], y[j] - y[i]) < radius[i] + radius[j]
    }
    expected |= {(i, 65) for i in range(61) if x[i] < radius[i]} | {
        (i, 66) for i in range(61) if 0.1 - x[i] < radius[i]
    }
    contacts = state.contacts
    assert set(zip(contacts.first.tolist(), contacts.second.tolist())) == expected
    assert {60, 61, 62, 65, 66} <= set(contacts.second.tolist())
    assert (contacts.overlap > 0.0).all()


def test_points_lie_on_the_bodies():
    _, state = pressed()
    contacts = state.contacts
    among_discs = contacts.second < 60
    np.testing.assert_allclose(
        state.discs.x[contacts.second[among_discs]], contacts.x2[among_discs], atol=1e-15
    )
    np.testing.assert_allclose(
        state.discs.y[contacts.second[among_discs]], contacts.y2[among_discs], atol=1e-15
    )
    np.testing.assert_array_equal(
        state.discs.x[contacts.first[among_discs]], contacts.x1[among_discs]
    )
    assert contacts.x2[contacts.second == 65] == pytest.approx(0.0, abs=1e-15)
    assert contacts.x2[contacts.second == 66] == pytest.approx(0.1)


@pytest.mark.parametrize("base", ["floor", "beam_surface"])
def test_normal_forces_of_settled_sand_on_a_flat_base_carry_its_weight(base):
    sand = cushion({**SMALL_BOX, "base": base, "packing": "random", "wall.friction_angle": 0.0})
    state = reader.read(sand.to_bytes(), SIZES)
    on_base = state.contacts.second == 67
    assert state.contacts.normal_force[on_base].sum() == pytest.approx(weight(sand), rel=1e-4)
    assert state.contacts.y2[on_base] == pytest.approx(state.box.base, abs=1e-15)


def test_tangential_force_is_that_of_the_slider_and_turns_the_first_body():
    """A disc that slides to the right over the floor is pushed to the left below its centre:
    clockwise."""
    disc = discs_at(
        [(0.0, RADIUS)],
        [(1.0, -0.1)],
        parameters={"base.y": 0.0, "damping": 0.0, "friction_angle": 0.1},
    )
    run(disc, 1e-4)
    contacts = reader.snapshot(disc).contacts
    assert contacts.overlap.shape == (1,)
    assert contacts.normal_force[0] == pytest.approx(
        sand_stiffness(disc) * (RADIUS - rows(disc)[0, 1]), rel=1e-9
    )
    push = masses(disc)[0] * (rows(disc)[0, 2] - 1.0)
    assert push < 0.0
    assert contacts.tangential_force[0] == pytest.approx(
        -np.tan(0.1) * contacts.normal_force[0], rel=0.2
    )


def test_the_picture_does_not_change_with_the_state_it_was_taken_of():
    sand, state = pressed()
    before = np.copy(state.discs.y)
    run(sand, 1e-3)
    np.testing.assert_array_equal(state.discs.y, before)
    assert not np.array_equal(rows(sand)[:, 1], before)


def test_another_size_is_refused():
    sand, _ = pressed()
    with pytest.raises(ComponentError, match="no serialized state"):
        reader.read(sand.to_bytes(), {"discs": 61, "elements": 4})

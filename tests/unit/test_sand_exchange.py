"""What a communication step does with inputs and outputs, and what a serialized state holds."""

import numpy as np
import pytest

from rockshed.components.common.component import ComponentError
from rockshed.components.sand_cushion import COMPONENT
from tests.sand_discs import SMALL_BOX, cushion, rows, run, stirred

FORCES = (
    "rock.force.x",
    "rock.force.y",
    "rock.torque",
    "beam.force.x",
    "beam.force.y",
    "beam.torque",
    "transmitted_force",
)


def struck(**changes):
    """A small cushion into which the rock sinks at 2 m/s, turning and drifting, while the beam
    gives way."""
    parameters = {
        **SMALL_BOX,
        "base": "beam_discs",
        "packing": "hexagonal",
        "rotation": "free",
        "rock.radius": 0.02,
    }
    sand = cushion({**parameters, **changes})
    for name, value in {
        "rock.position.y": sand["surface_height"] + 0.02,
        "rock.velocity.x": 0.3,
        "rock.velocity.y": -2.0,
        "rock.angular_velocity": 5.0,
    }.items():
        sand[name] = value
    sand.evaluate()
    sand["beam.velocity.y"] = np.array((-0.1, -0.2, -0.2, -0.1))
    sand["beam.angular_velocity"] = np.array((-1.0, -0.5, 0.5, 1.0))
    return sand


def move_boundaries(sand, start, time):
    """Rock and beam where their velocity brings them by ``time`` from ``start``."""
    for position, velocity in (
        ("rock.position.x", "rock.velocity.x"),
        ("rock.position.y", "rock.velocity.y"),
        ("rock.angle", "rock.angular_velocity"),
        ("beam.position.y", "beam.velocity.y"),
        ("beam.angle", "beam.angular_velocity"),
    ):
        sand[position] = start[position] + sand[velocity] * time


def boundary_start(sand):
    names = ("rock.position.x", "rock.position.y", "rock.angle", "beam.position.y", "beam.angle")
    return {name: np.copy(sand[name]) for name in names}


def test_linear_motion_and_mean_forces_are_the_impulse_of_single_steps():
    dt, parts, exchanges = 1e-5, 10, 5
    coarse, fine = (
        struck(kinematics="linear", forces="mean", internal_step=dt),
        struck(internal_step=dt),
    )
    start = boundary_start(fine)
    for exchange in range(exchanges):
        move_boundaries(coarse, start, exchange * parts * dt)
        begin = boundary_start(coarse)
        coarse.step(0.0, parts * dt)
        impulses = {name: 0.0 for name in FORCES}
        for s in range(parts):
            move_boundaries(fine, begin, s * (parts * dt / parts))
            fine.step(0.0, dt)
            impulses = {name: value + fine[name] * dt for name, value in impulses.items()}
        assert abs(impulses["rock.force.y"]) > 1e-4
        for name, impulse in impulses.items():
            assert coarse[name] * parts * dt == pytest.approx(impulse, rel=1e-9, abs=1e-12), name
        assert rows(coarse) == pytest.approx(rows(fine), rel=1e-12, abs=1e-12)
        for name in ("energy.work.rock", "energy.work.beam", "energy.residual"):
            assert coarse[name] == pytest.approx(fine[name], rel=1e-6, abs=1e-10), name


def test_held_motion_freezes_the_rock_within_a_step():
    held, linear = struck(), struck(kinematics="linear")
    held["rock.velocity.y"] = linear["rock.velocity.y"] = -4.0
    run(held, 1e-3)
    run(linear, 1e-3)
    assert linear["rock.force.y"] > 10.0 > held["rock.force.y"]
    way = held["rock.above_surface"] - linear["rock.above_surface"]
    assert way == pytest.approx(4e-3, rel=1e-9)


def test_schemes_agree_to_the_bit_with_one_internal_step_per_exchange():
    variants = [
        struck(kinematics=kinematics, forces=forces)
        for kinematics in ("held", "linear")
        for forces in ("last", "mean")
    ]
    for sand in variants:
        run(sand, 1e-3, 1e-5)
    for sand in variants[1:]:
        np.testing.assert_array_equal(rows(sand), rows(variants[0]))
        for name in FORCES:
            np.testing.assert_array_equal(sand[name], variants[0][name])


def test_a_step_that_is_no_multiple_is_divided_into_equal_parts():
    divided, single = struck(internal_step=1e-5), struck(internal_step=1.0)
    for _ in range(20):
        divided.step(0.0, 2.5e-5)
        for _ in range(3):
            single.step(0.0, 2.5e-5 / 3)
    np.testing.assert_array_equal(rows(divided), rows(single))


def test_penetration_counts_from_the_mean_level_of_the_surface_at_the_start():
    sand = struck()
    lowest = sand["rock.position.y"] - 0.02
    assert sand["rock.above_surface"] == pytest.approx(lowest - sand["surface_level"], abs=1e-12)
    sand["rock.position.y"] -= 0.01
    sand.step(0.0, 1e-5)
    assert sand["rock.force.y"] > 0.0
    assert sand["penetration"] == pytest.approx(sand["surface_level"] - lowest + 0.01, rel=1e-9)
    assert sand["penetration"] == -sand["rock.above_surface"]


def test_penetration_is_zero_until_the_rock_first_touches_and_above_the_level():
    """A column of three discs left of the rock, one disc right of it: a rock between them comes
    under the mean level without a touch."""
    sand = cushion({**SMALL_BOX, "base": "floor", "rock.radius": 0.02}, discs=4)
    rows(sand)[:, :2] = [[0.005, 0.005], [0.005, 0.015], [0.005, 0.025], [0.055, 0.005]]
    sand["rock.position.x"], sand["rock.position.y"] = 0.055, 0.0301
    sand.evaluate()
    assert sand["surface_level"] == pytest.approx(0.02, abs=1e-5)
    for lowest, touches in ((0.0101, False), (0.0099, True), (0.0101, True), (0.03, True)):
        sand["rock.position.y"] = 0.02 + lowest
        sand.step(0.0, 1e-6)
        assert sand["rock.above_surface"] == pytest.approx(lowest - sand["surface_level"])
        depth = max(0.0, sand["surface_level"] - lowest) if touches else 0.0
        assert sand["penetration"] == pytest.approx(depth, abs=1e-12)


def test_same_parameters_same_bits():
    first, second = (
        struck(packing="random", **{"disc.spread": 0.2}),
        struck(packing="random", **{"disc.spread": 0.2}),
    )
    run(first, 1e-3, 1e-5)
    run(second, 1e-3, 1e-5)
    assert first.to_bytes() == second.to_bytes()


def test_a_serialized_state_continues_bitwise():
    sand = stirred(struck(rolling_resistance=0.3), 0.1)
    run(sand, 1e-3, 1e-5)
    state = sand.to_bytes()
    other = COMPONENT.instance(discs=60, elements=4)
    other.from_bytes(state)
    run(sand, 2e-3, 1e-5)
    run(other, 2e-3, 1e-5)
    assert sand["energy.sliding"] > 0.0
    assert other.to_bytes() == sand.to_bytes()
    sand.from_bytes(state)  # rollback
    run(sand, 2e-3, 1e-5)
    assert sand.to_bytes() == other.to_bytes()


def test_a_state_of_another_size_or_cut_short_is_refused():
    state = struck().to_bytes()
    with pytest.raises(ComponentError, match="no serialized state"):
        COMPONENT.instance(discs=61, elements=4).from_bytes(state)
    with pytest.raises(ComponentError, match="no serialized state"):
        COMPONENT.instance(discs=60, elements=4).from_bytes(state[:-8])

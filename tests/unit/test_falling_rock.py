"""The rock as a component: start, refusals, states that are restored."""

import math

import pytest

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError

ROCK = component("FallingRock")


def test_starts_where_the_parameters_say():
    rock = ROCK.instance()
    for number, name in enumerate(
        ("position0.x", "position0.y", "angle0", "velocity0.x", "velocity0.y", "angular_velocity0")
    ):
        rock[name] = 1.0 + number
    rock.initialise()
    names = ("position.x", "position.y", "angle", "velocity.x", "velocity.y", "angular_velocity")
    assert [rock[name] for name in names] == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert rock["energy.kinetic"] == pytest.approx(
        0.5 * 4 * (16 + 25) + 0.5 * 0.4 * 4 * 0.0495**2 * 36
    )
    assert rock["energy.gravity"] == pytest.approx(4 * 9.80665 * 2)
    assert rock["energy.residual"] == 0.0


def test_bad_parameters_are_all_named():
    rock = ROCK.instance()
    rock["mass"], rock["radius"], rock["velocity0.y"] = -4.0, 0.0, math.nan
    with pytest.raises(ComponentError) as error:
        rock.initialise()
    assert [problem.split(" = ")[0] for problem in error.value.problems] == [
        "mass",
        "radius",
        "velocity0.y",
    ]


@pytest.mark.parametrize("motion", ["free", "driven"])
@pytest.mark.parametrize("force", [math.nan, math.inf])
def test_a_force_that_is_no_number_stops_the_rock(force, motion):
    rock = ROCK.instance()
    rock["motion"], rock["velocity0.x"] = motion, 1.0
    rock.initialise()
    rock["force.x"] = force
    with pytest.raises(
        ComponentError, match=r"FallingRock: at t = 0\.5 s .*reduce the exchange step"
    ):
        rock.step(0.5, 1e-5)


def test_state_goes_to_another_instance_bit_for_bit():
    original, copy = ROCK.instance(), ROCK.instance()
    original.initialise()
    original.step(0.0, 0.1)
    copy.from_bytes(original.to_bytes())
    for rock in (original, copy):
        rock["torque"] = 1.0
        rock.step(0.1, 0.1)
    assert original.to_bytes() == copy.to_bytes()


def test_state_of_another_kind_is_refused():
    rock = ROCK.instance()
    rock.initialise()
    for content in (
        b"",
        rock.to_bytes()[:-1],
        b"x" + rock.to_bytes()[1:],
        component("RBSMBeam").instance().to_bytes(),
    ):
        with pytest.raises(ComponentError, match="no serialized state"):
            rock.from_bytes(content)

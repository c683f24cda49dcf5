"""A body that nothing drives is told of; no shipped case has one."""

import pytest

import rockshed
from rockshed.cases.registry import cases
from rockshed.core.run import sources_of
from rockshed.core.system.planning import make_plan
from rockshed.runs.undriven import undriven

ROCK_ON_SAND = (
    "rock.position.x -> sand.rock.position.x",
    "rock.position.y -> sand.rock.position.y",
    "rock.velocity.y -> sand.rock.velocity.y",
)


def told(system):
    """Return what is told of a system."""
    return undriven(make_plan(system.spec, {**sources_of(system.spec), **system.job.sources}))


def empty(**options):
    return rockshed.System.new("made", exchange_step=1e-4, stop_time=1e-3, **options)


def test_a_beam_without_a_force_is_warned_of_in_the_run_and_in_its_description():
    alone = empty().add("beam", "RBSMBeam")
    (warning,) = rockshed.simulate(alone).warnings
    assert warning.startswith("beam: nothing drives force.x, force.y, torque (motion of the discs")
    assert "no force acts on the beam; connect them" in warning
    assert f"warning: {warning}" in str(alone.describe())


def test_a_beam_under_a_given_force_is_not_warned_of():
    assert told(empty().add("beam", "RBSMBeam", {"force.y[12]": -1000.0})) == []


def test_a_sand_whose_rock_is_missing_is_warned_of_and_one_on_a_floor_needs_no_beam():
    on_floor = empty().add("sand", "SandCushion", {"base": "floor"})
    assert [text.partition("(")[0].split()[3].split(".")[0] for text in told(on_floor)] == ["rock"]
    on_beam = told(empty().add("sand", "SandCushion"))
    assert len(on_beam) == 2
    assert "the sand lies on a beam that never moves" in on_beam[1]


def test_a_rock_that_moves_the_sand_and_gets_no_force_back_is_warned_of():
    pair = empty().add("rock", "FallingRock").add("sand", "SandCushion", {"base": "floor"})
    half = pair.connect(*ROCK_ON_SAND)
    (warning,) = told(half)
    assert warning.startswith("rock: nothing drives force.x, force.y, torque")
    assert "nothing comes back" in warning
    assert told(half.connect("sand.rock.force.y -> rock.force.y")) == []


def test_a_rock_in_free_fall_is_not_warned_of():
    assert told(empty().add("rock", "FallingRock")) == []


@pytest.mark.parametrize("name", list(cases()))
def test_no_case_is_warned_of(name):
    assert told(rockshed.case(name, in_process=True)) == []


def test_an_old_name_in_a_value_of_a_case_is_among_the_warnings_of_the_run():
    system = rockshed.case(
        "lab-impact", in_process=True, stop_time=1e-4, values={"sand.unit_weight": 1800.0}
    )
    assert any("unit_weight" in text for text in rockshed.simulate(system).warnings)

"""Cases of the catalogue: geometry that belongs together moves together, or is refused by name."""

import pytest

import rockshed
from rockshed.cases.registry import cases
from rockshed.cases.together import moved
from rockshed.core.errors import InputRefused
from rockshed.runs.job import prepare
from rockshed.runs.request import Request

WITH_LAYER = [name for name, case in cases().items() if case.layer and case.layer.dropped]


def job(name, model=None, **values):
    named = {key.replace("__", "."): value for key, value in values.items()}
    return prepare(Request(name, named, in_process=True, model=model))


def value(system, name):
    for entry in system.shared.values():
        if name in entry.targets:
            return entry.value
    owner, _, key = name.partition(".")
    return system.components[owner].parameters[key]


@pytest.mark.parametrize("model", [None, "one-law"])
@pytest.mark.parametrize("name", WITH_LAYER)
def test_nothing_moves_in_a_case_as_it_is(name, model):
    made = job(name, model)
    assert moved(cases()[name].layer, made.system, made.facts["sizes"]) == {}
    assert "changed from the case" not in made.system.description


@pytest.mark.parametrize("name", ["girders-10", "lab-impact", "shed-on-piles"])
def test_another_span_moves_axis_discs_box_and_rock(name):
    spans = {"girders-10": 9.0, "lab-impact": 1.5, "shed-on-piles": 9.0}
    made = job(name, beam__span=spans[name])
    elements = made.facts["sizes"]["beam"]["elements"]
    system = made.system
    element = spans[name] / elements
    assert value(system, "sand.beam.radius") == pytest.approx(0.5 * element)
    assert value(system, "beam.axis.y") == pytest.approx(-0.5 * element)
    assert value(system, "rock.position0.x") == pytest.approx(0.5 * spans[name])
    width = 0.37 if name == "lab-impact" else value(system, "sand.box.width")
    middle = value(system, "sand.box.left") + 0.5 * width
    assert middle == pytest.approx(0.5 * spans[name])
    assert f"on a beam of {spans[name]:g} m (changed from the case)" in system.description


def test_a_larger_rock_starts_higher_with_either_model_of_the_sand():
    for model in (None, "one-law"):
        own = value(job("girders-10", model).system, "rock.position0.y")
        larger = value(job("girders-10", model, rock_radius=0.656).system, "rock.position0.y")
        assert larger - own == pytest.approx(0.656 - 0.456)


def test_a_rock_with_a_place_of_its_own_stays_there():
    made = job("girders-10", beam__span=9.0, rock__position0__x=4.0, box_left=2.0)
    assert value(made.system, "rock.position0.x") == 4.0
    assert value(made.system, "sand.box.left") == 2.0


def test_the_description_of_a_changed_case_has_its_values():
    values = {"rock_mass": 2500.0, "rock.velocity0.y": -22.14}
    system = rockshed.case("girders-10", in_process=True, values=values)
    assert system.spec.description == (
        "2.5 t at 22.1 m/s on 90.2 cm of sand on a beam of 10 m (changed from the case)"
    )


def test_a_roof_on_its_slope_cannot_be_moved_apart_from_it():
    with pytest.raises(InputRefused, match=r"beam\.span: follows from the slope of this case"):
        job("slope-to-cushion", beam__span=9.0)


def test_rock_sand_and_beam_have_one_gravity():
    system = job("girders-10", rock__gravity=1.62).system
    assert {value(system, f"{name}.gravity") for name in ("rock", "sand", "beam")} == {1.62}

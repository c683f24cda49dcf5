"""Models of the sand by name, as a request applies them to a case."""

import math

import pytest

from rockshed.cases import sonoda1993
from rockshed.cases.registry import case, cases, model_changes
from rockshed.components.common.units import cm, kgf
from rockshed.components.sand_cushion.models import MODELS
from rockshed.core.errors import InputRefused
from rockshed.runs.job import Request, prepare


def prepared(target, model, **values):
    return prepare(Request(target, values, model=model, in_process=True))


def test_the_literal_model_is_eq_1_to_the_letter():
    sand = prepared("lab-impact", "literal").system.components["sand"].parameters
    assert (sand["rotation"], sand["stiffness_factor"]) == ("free", 1.0)
    assert (sand["base"], sand["base.shape"]) == ("beam_discs", "round")


def test_a_model_says_which_base_a_beam_is_and_leaves_a_floor_a_floor():
    for target, model, base in (
        ("lab-impact", None, "beam_surface"),
        ("lab-impact", "one-law", "beam_surface"),
        ("girders-8", "literal", "beam_discs"),
        ("rigid-base-pit", "literal", "floor"),
        ("static-test", "literal", "floor"),
    ):
        sand = prepared(target, model).system.components["sand"].parameters
        assert sand.get("base", "beam_surface") == base


@pytest.mark.parametrize(
    "target", ["lab-impact", "lab-impact-9", "static-test", "rigid-base-pit", "girders-10"]
)
def test_one_law_is_one_for_all_cases(target):
    sand = prepared(target, "one-law").system.components["sand"].parameters
    assert {key: sand[key] for key in MODELS["one-law"].parameters} == dict(
        MODELS["one-law"].parameters
    )
    assert (sand["density_of"], sand["packing"]) == ("layer", "prepared")


def test_compaction_and_water_make_the_state_of_the_soil():
    poured, compacted = (sonoda1993.soil(sonoda1993.tests()[number]) for number in (3, 4))
    assert poured.solid_fraction < compacted.solid_fraction
    assert 0.0 < poured.cohesion < compacted.cohesion < 1.0 * kgf / cm**2


def test_a_prepared_layer_is_as_thick_as_in_the_test_and_the_rock_meets_it_as_fast():
    job = prepared("lab-impact", "one-law")
    discs = job.facts["sizes"]["sand"]["discs"]
    assert discs * math.pi * 0.5**2 * (1 + 0.25**2 / 3) / (37 * 10) == pytest.approx(
        0.75, abs=0.002
    )
    rock = job.system.components["rock"].parameters
    fallen = rock["position0.y"] - 0.0495 - 0.10
    assert rock["velocity0.y"] ** 2 + 2 * 9.80665 * fallen == pytest.approx(8.0**2)


def test_another_state_of_the_soil_may_be_asked_for():
    job = prepared("lab-impact", "one-law", **{"sand.solid_fraction": 0.72, "sand.cohesion": 0})
    sand = job.system.components["sand"].parameters
    assert (sand["solid_fraction"], sand["cohesion"]) == (0.72, 0)
    assert (
        job.facts["sizes"]["sand"]["discs"]
        < model_changes(case("lab-impact"), "one-law", {}).sizes["sand.discs"]
    )


def test_what_a_model_sets_is_no_change_of_the_test():
    for target in (name for name, listed in cases().items() if listed.layer):
        assert prepared(target, "one-law").facts["differences"] == {}


def test_an_unknown_model_is_answered_with_the_known_ones():
    with pytest.raises(InputRefused, match=r"model one_law: .*no such model"):
        prepared("lab-impact", "one_law")


def test_a_system_file_takes_no_model(tmp_path):
    file = tmp_path / "some.toml"
    file.write_text("")
    with pytest.raises(InputRefused, match=r"model: is for cases only"):
        prepare(Request(str(file), model="literal"))

"""Quantities of a project in a report: words, and a unit beside every number that has one."""

from dataclasses import asdict
from types import SimpleNamespace

import pytest

from rockshed.cases.shed import shed_case
from rockshed.reports.inputs import derived, project_tables
from rockshed.reports.of_run import title_of
from rockshed.sites.shed.preparation import prepare

GIRDERS = {
    "rock": {"mass": "1.8 t", "drop_height": "18 m"},
    "cushion": {"thickness": "0.9 m", "material": "gravel"},
    "material": {"gravel": {"like": "poured sand", "friction_angle": "38 deg"}},
    "roof": {
        "section": "HE 300 B",
        "steel": "S355",
        "span": "7 m",
        "spacing": "1 m",
        "slab": {"thickness": "12 cm"},
    },
}
SLAB = {
    **GIRDERS,
    "roof": {
        "span": "7 m",
        "concrete": {
            "thickness": "70 cm",
            "cover": "5 cm",
            "bar_diameter": "25 mm",
            "bar_spacing": "10 cm",
            "concrete_strength": "30 MPa",
            "bar_yield_stress": "500 MPa",
        },
    },
}
_NUMBERS_ALONE = ("discs", "elements", "seed", "girders", "strips", "fraction", "slope", "packing")


def run_of(project):
    facts = shed_case(prepare(project)).facts
    return SimpleNamespace(provenance={"name": "shed", **facts})


def rows_of(table):
    return {row["quantity"]: (row["value"], row["unit"]) for row in table}


@pytest.mark.parametrize("project", [GIRDERS, SLAB])
def test_every_number_that_is_derived_has_its_unit(project):
    for name, (value, unit) in rows_of(derived(run_of(project))).items():
        is_number = value.replace(".", "").replace("-", "").isdigit()
        assert unit or not is_number or any(word in name for word in _NUMBERS_ALONE), name


def test_derived_quantities_are_in_the_units_in_which_one_says_them():
    rows = rows_of(derived(run_of(GIRDERS)))
    assert rows["cushion.sand: angle of friction"] == ("38", "deg")
    assert rows["cushion.sand: fictitious modulus E_bar"] == ("3.432", "MPa")
    assert rows["roof: mass of the slab on the girders, by area"] == ("300", "kg/m2")
    assert rows["roof: yield stress"] == ("345", "MPa")
    assert rows["roof: second moment of area of a girder"] == ("25170", "cm4")
    moments = "roof.corners: bending moments of a girder at yield and plastic moment"
    assert rows[moments][1] == "kN m"
    assert len(rows[moments][0].split("; ")) == 2


def test_nothing_that_is_derived_is_a_representation_of_python():
    for project in (GIRDERS, SLAB):
        text = repr(derived(run_of(project)))
        assert not any(sign in text for sign in ("None", "=", "{", "[", "..."))


def test_a_slab_has_no_girders_and_no_plastic_modulus():
    names = [*rows_of(derived(run_of(SLAB)))]
    assert not [name for name in names if "girder" in name or "plastic" in name]
    assert "roof: yield stress of the bars" in names
    assert "strips of 1 m that take part" in names


def test_every_part_of_a_layout_is_among_the_derived_quantities():
    layout = asdict(prepare(GIRDERS).layout)
    shown = repr(derived(run_of(GIRDERS)))
    for words in ("exchange step", "internal step of the beam", "end of the run"):
        assert words in shown
    assert layout["seed"] == 1


def test_criteria_are_in_the_units_of_the_results():
    criteria = [*project_tables(run_of(GIRDERS))][-1]
    shown = {row["criterion"]: row["unit"] for row in criteria}
    assert shown["bending moment of all that takes part"] == "kN m"
    assert shown["bending stress"] == "MPa"


def test_the_title_of_a_report_names_the_material():
    assert title_of(run_of(GIRDERS)) == "shed: 1.8 t from 18 m on 0.9 m of gravel over HE 300 B"

"""A rock shed as a project: form, units, tables, contradictions, and what is derived."""

import math
import tomllib
from contextlib import suppress
from copy import deepcopy

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rockshed
from rockshed.cases import full_scale, sand_models
from rockshed.cases.shed import shed_case
from rockshed.components.catalogue import component
from rockshed.components.common.units import kgf, standard_gravity
from rockshed.components.sand_cushion.models import ONE_LAW_MODULUS, SPREAD
from rockshed.core.errors import InputRefused
from rockshed.runs.projects import TEMPLATES, write_template
from rockshed.sites.shed.effective_width import RULES
from rockshed.sites.shed.geometry import line_mass
from rockshed.sites.shed.materials import shipped_sands
from rockshed.sites.shed.preparation import all_fields, prepare
from rockshed.sites.shed.sections import plastic_modulus, sections
from rockshed.sites.shed.site import ShedProject
from rockshed.sites.shed.steels import steels

EXAMPLE = TEMPLATES["pile"].parent / "trial-shed.toml"
PROJECT = {
    "rock": {"mass": "2.5 t", "drop_height": "25 m"},
    "cushion": {"thickness": "1.2 m"},
    "roof": {"section": "H-400x400x13x21", "span": "9 m", "spacing": "1.5 m"},
}
COMPLETE = {
    "rock": {"mass": "2.5 t", "density": 2600.0, "drop_height": "25 m", "spin": 1.0, "place": 4.0},
    "cushion": {
        "thickness": "1.2 m",
        "width": "8 m",
        "material": "own",
        "effective_width": "spheres",
    },
    "material": {"own": {"like": "poured sand", "modulus": "40 kgf/cm2"}},
    "roof": {"section": "HE 400 B", "steel": "S355", "span": "9 m", "spacing": 1.5, "number": 9}
    | {"slab": {"thickness": 0.2}, "bending": "elastic"},
    "supports": {"kind": "elastic", "stiffness": "60 kN/mm"},
    "criteria": {"deflection": "30 mm", "stress": "200 MPa"},
    "numerics": {"clearance": "20 cm", "seed": 3, "elements": 35},
}
"""A project with fields of every table."""


OWN = {"section": None, "area": "0.02 m2", "second_moment": "7e-4 m4", "height": "0.4 m"}
"""A section of one's own."""


def changed(**tables):
    """Return the project with other fields; None leaves a field out."""
    project = deepcopy(PROJECT)
    for table, fields in tables.items():
        project.setdefault(table, {}).update(fields)
        project[table] = {key: value for key, value in project[table].items() if value is not None}
    return project


def refusals(project):
    with pytest.raises(InputRefused) as refused:
        prepare(project)
    return [str(problem) for problem in refused.value.problems]


# ---------------------------------------------------------------- tables


@pytest.mark.parametrize("name", list(sections()))
def test_printed_properties_of_a_section_follow_from_its_dimensions(name):
    found = sections()[name]
    clear = found.height - 2 * found.flange
    corner = (1 - math.pi / 4) * found.fillet**2
    own = (1 / 3 - math.pi / 16 - 1 / (36 * (1 - math.pi / 4))) * found.fillet**4
    lever = clear / 2 - found.fillet * (10 - 3 * math.pi) / (12 - 3 * math.pi)
    area = 2 * found.width * found.flange + clear * found.web + 4 * corner
    outer = found.width * found.height**3 - (found.width - found.web) * clear**3
    second_moment = outer / 12 + 4 * (own + corner * lever**2)
    plastic = plastic_modulus(found.height, found.width, found.web, found.flange, found.fillet)
    assert found.area == pytest.approx(area, rel=0.01)
    assert found.second_moment == pytest.approx(second_moment, rel=0.01)
    assert found.section_modulus == pytest.approx(2 * second_moment / found.height, rel=0.01)
    assert found.plastic_modulus == pytest.approx(plastic, rel=0.01)
    assert found.mass == pytest.approx(7850 * area, rel=0.01)
    assert 1.05 < found.plastic_modulus / found.section_modulus < 1.3


def test_a_steel_yields_earlier_the_thicker_it_is_and_too_thick_plates_have_no_yield_stress():
    for steel in steels().values():
        assert list(steel.yield_stress) == sorted(steel.yield_stress, reverse=True)
        assert list(steel.thickness) == sorted(steel.thickness)
        assert steel.yield_at(2.0 * steel.thickness[-1]) is None
    assert steels()["SS400"].yield_at(0.021) == 235e6
    assert steels()["S355"].yield_at(0.016) == 355e6


def test_materials_that_ship_are_states_of_the_one_law():
    compacted, poured = (shipped_sands()[f"{state} sand"] for state in ("compacted", "poured"))
    assert compacted.solid_fraction == sand_models.DENSE
    assert poured.solid_fraction == sand_models.LOOSE
    for sand in (compacted, poured):
        assert sand.modulus == pytest.approx(ONE_LAW_MODULUS * kgf * 1e4)
        assert sand.cohesion == pytest.approx(full_scale.FULL_SCALE_SOIL.cohesion)
        assert set(sand.source) == set(sand_models_of_a_material())


def sand_models_of_a_material():
    return ("modulus", "density", "solid_fraction", "cohesion", "friction_angle")


# ---------------------------------------------------------------- files


def test_the_example_is_the_shed_of_the_trial_in_at_most_thirty_lines():
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 30
    shed = prepare(EXAMPLE)
    assert shed.layout.rock.radius == pytest.approx(0.6123, abs=1e-4)
    assert shed.layout.rock.speed == pytest.approx(22.14, abs=0.01)
    assert shed.layout.roof.yield_stress == 235e6
    assert shed.warnings == ()


def test_a_template_can_be_run_as_it_is_and_never_replaces_a_file(tmp_path):
    file = write_template(tmp_path / "new")
    assert prepare(file).layout.cushion.rule == "rock and cushion"
    with pytest.raises(InputRefused, match="is there already, and stays"):
        write_template(tmp_path / "new")


def test_the_template_shows_every_key_that_it_comments_out_as_the_form_has_it():
    lines = TEMPLATES["shed"].read_text(encoding="utf-8").splitlines()
    shown = [line.removeprefix("# ") for line in lines if line.startswith("# ") and " = " in line]
    keys = {name.rpartition(".")[2] for name in all_fields()} | {"slab"}
    for line in shown:
        assert line.partition(" = ")[0] in keys, line
        assert tomllib.loads(line)


# ---------------------------------------------------------------- refusals


def test_everything_wrong_is_told_at_once_with_line_and_column(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text(
        '[rock]\nmass = "2.5 m"\ndrop_height = "25 mm2"\n[cushion]\nthicknes = 1.2\n'
        'thickness = "3 kgff"\n[roof]\nspan = -9.0\nsection = 5\n',
        encoding="utf-8",
    )
    told = refusals(file)
    assert len(told) == 7
    assert "line 2, column 1: rock.mass: must be a mass, in kg (given: '2.5 m'" in told[0]
    assert "cushion.thicknes: there is no such key; did you mean thickness" in told[2]
    assert "there is no unit 'kgff'; did you mean" in told[3]
    assert "roof: spacing is missing" in told[4]
    assert "line 8, column 1: roof.span: must be greater than 0" in told[5]


FAULTS = """
[rock]
mass = "2.5 m"                      # another kind of unit
drop_height = "25 m"
velocity = "22 m/s"                 # two ways to say one thing
angle = "95 deg"                    # strikes nothing
[cushion]
thickness = -1.2                    # impossible
material = "compact sand"           # unknown
effective_width = "girder spacin"   # no rule
[material.own]
like = "poured sandd"               # unknown
modulus = "3 kg"
[roof]
section = "H-400x400x13x22"         # not in the tables
area = "90 cm2"                     # beside a section
steel = "S335"                      # unknown
span = "9 m"
spacng = "1.5 m"                    # no such key
number = 2.5                        # not whole
[supports]
kind = "elastic"                    # without a stiffness
file = "no.toml"                    # of another kind
[criteria]
deflection = "30 kgff"              # no unit
[numerics]
elements = 2                        # too few
"""
TOLD = {
    3: "rock.mass: must be a mass, in kg (given: '2.5 m', which is a length)",
    5: "two ways to say one thing",
    6: "it does not strike",
    8: "cushion.thickness: must be greater than 0",
    9: "there is no material 'compact sand'; did you mean compacted sand",
    10: "effective_width is neither a rule nor a length",
    12: "there is no material 'poured sandd'; did you mean poured sand",
    13: "material.own.modulus: must be a pressure",
    15: "there is no section 'H-400x400x13x22' in the tables; did you mean H-400x400x13x21",
    16: "has its own area",
    17: "there is no steel 'S335'; did you mean S355",
    19: "roof.spacng: there is no such key; did you mean spacing",
    20: "roof.number: must be a whole number",
    21: "supports: stiffness is missing",
    23: "supports.file: is for piles supports",
    25: "there is no unit 'kgff'",
    27: "numerics.elements: must be greater than or equal to 3",
}
"""What is told by line: of each kind of fault one."""


def test_a_fault_of_the_form_hides_no_other_and_no_other_follows_from_it(tmp_path):
    """A key that was meant for another is not missing; a value that is refused contradicts none."""
    file = tmp_path / "wrong.toml"
    file.write_text(FAULTS, encoding="utf-8")
    told = refusals(file)
    for (line, text), problem in zip(TOLD.items(), told, strict=True):
        assert problem.startswith(f"{file}, line {line}, column 1: "), problem
        assert text in problem


@given(st.data())
def test_whatever_is_of_the_wrong_form_is_refused_and_never_ends_in_an_error_of_ours(data):
    """Each value of a complete project in turn as something else."""
    project = deepcopy(COMPLETE)
    fields = [(table, key) for table, entries in project.items() for key in entries]
    wrong = st.sampled_from([None, [], {}, True, -1, "", "5 furlongs", "0.1 kg.m", "nan", {"a": 1}])
    chosen = data.draw(st.lists(st.sampled_from(fields), min_size=1, max_size=4, unique=True))
    for table, key in chosen:
        project[table][key] = data.draw(wrong)
    with suppress(InputRefused):
        prepare(project)


@pytest.mark.parametrize(
    ("project", "text"),
    [
        (changed(rock={"size": "2 m", "density": 2600.0}), "disagree"),
        (changed(rock={"velocity": "20 m/s"}), "two ways to say one thing"),
        (changed(rock={"drop_height": None}), "neither drop_height nor velocity"),
        (changed(rock={"mass": None}), "mass is missing"),
        (changed(rock={"angle": 15.0, "drop_height": None, "velocity": 20.0}), "deg from the vert"),
        (changed(rock={"angle": "15 deg"}), "strikes vertically, and an angle is given"),
        (changed(rock={"place": "0.1 m"}), "rock.place: the rock strikes at x = 0.1 m"),
        (changed(rock={"drop_height": "5 cm"}), "numerics.clearance: the rock starts"),
        (changed(cushion={"width": "10 m"}), "beyond the roof, whose span is 9 m"),
        (changed(cushion={"thickness": None}), "cushion: thickness is missing"),
        (changed(cushion={"material": "compact sand"}), "did you mean compacted sand"),
        (changed(cushion={"effective_width": "girder spacin"}), "neither a rule nor a length"),
        (changed(cushion={"effective_width": "-2 m"}), "effective_width must be above 0"),
        (changed(roof={"section": "H-400x400x13x22"}), "did you mean H-400x400x13x21"),
        (changed(roof={"section": "H-400x400"}), "there is H-400x400x13x21"),
        (changed(roof={"area": "100 cm2"}), "has its own area"),
        (changed(roof={"section": None}), "section is missing"),
        (changed(roof=OWN | {"plastic_modulus": "0.1 m3"}), "times the elastic one, and sections"),
        (changed(roof=OWN | {"section_modulus": "0.1 m3"}), "above 2 I / height"),
        (changed(roof={"steel": "S335"}), "did you mean S355 or S235"),
        (changed(roof={"spacing": None}), "spacing is missing"),
        (changed(roof={"number": 2}, cushion={"effective_width": 4.0}), "the roof has 2"),
        (changed(supports={"kind": "hinged", "stiffness": 1e8}), "is for elastic supports"),
        (changed(numerics={"disc_radius": "20 cm"}), "numerics.disc_radius"),
        (changed(numerics={"disc_radius": "1 mm"}), "1,000,000 are the most"),
        (changed(cushion={"width": "1 m"}), "does not fit on it"),
    ],
)
def test_a_contradiction_is_refused_with_its_field(project, text):
    assert any(text in told for told in refusals(project)), refusals(project)


def test_layers_of_one_material_are_one_layer_and_of_several_are_refused_in_words():
    layer = {"material": "poured sand", "thickness": "60 cm"}
    two = changed(cushion={"thickness": None, "layers": [layer, layer]})
    assert prepare(two).layout.cushion.thickness == pytest.approx(1.2)
    mixed = [layer, {**layer, "material": "compacted sand"}]
    (told,) = refusals(changed(cushion={"thickness": None, "layers": mixed}))
    assert "compacted sand on poured sand cannot be computed" in told
    assert "compute it once with each material alone" in told


@pytest.mark.parametrize(
    ("project", "text"),
    [
        (changed(material={"own": {"modulus": 30.4}}, cushion={"material": "own"}), "kgf/cm2"),
        (changed(material={"own": {"density": 18.0}}, cushion={"material": "own"}), "18 kN/m3"),
        (changed(rock={"density": 4.9e6, "mass": 2500.0}), "rock.density is 4.9e+06 kg/m3"),
        (changed(cushion={"effective_width": 150.0}), "150 cm"),
        (changed(numerics={"stop_time": 410.0}), "410 ms"),
    ],
)
def test_a_value_beyond_what_is_usual_is_computed_with_a_warning_that_names_the_unit(project, text):
    with_discs = deepcopy(project)
    with_discs.setdefault("numerics", {}).setdefault("disc_radius", "5 cm")
    try:
        told = prepare(with_discs).warnings
    except InputRefused:  # the discs are no sand to so small a rock
        with_discs["numerics"]["disc_radius"] = "5 mm"
        told = prepare(with_discs).warnings
    assert any(text in warning for warning in told), told


def test_a_mass_that_lacks_its_ton_is_refused_with_the_number_of_discs_and_the_unit():
    (told,) = refusals(changed(rock={"mass": 2.5}))
    assert "a rock of 2.5 kg" in told
    assert "sand discs of" in told
    assert "if 2.5 t is meant, write that unit" in told
    asked = changed(rock={"mass": 2.5}, numerics={"disc_radius": "6 mm"})
    assert any("2.5 t" in warning for warning in prepare(asked).warnings)


@pytest.mark.parametrize(
    ("name", "offered"),
    [("HEB 305", "HE 300 B"), ("IPE305", "IPE 300"), ("H-400x400x13x20", "H-400x400x13x21")],
)
def test_a_section_that_does_not_exist_is_answered_with_those_next_in_size(name, offered):
    (told,) = refusals(changed(roof={"section": name}))
    assert f"did you mean {offered}" in told


def test_a_limit_of_the_deflection_may_be_written_as_engineers_do():
    limits = [prepare(changed(criteria={"deflection": text})) for text in ("L/250", "span/250")]
    assert {entry.project.criteria.deflection_of(9.0) for entry in limits} == {0.036}


def test_a_material_without_its_stiffness_is_warned_of_and_one_of_the_table_is_not():
    own = changed(material={"gravel": {"density": "19 kN/m3"}}, cushion={"material": "gravel"})
    (told,) = prepare(own).warnings
    assert "material 'gravel' has no modulus" in told
    assert "Sonoda" in told
    stiff = changed(material={"gravel": {"modulus": "4 MPa"}}, cushion={"material": "gravel"})
    assert prepare(stiff).warnings == ()
    assert prepare(PROJECT).warnings == ()


def test_a_material_of_the_project_has_a_caution_among_the_notes_of_its_results():
    own = changed(material={"gravel": {"modulus": "4 MPa"}}, cushion={"material": "gravel"})
    (note,) = shed_case(prepare(own)).facts["design"]["notes"]
    assert note.startswith("gravel is a material of the project")
    assert shed_case(prepare(PROJECT)).facts["design"]["notes"] == []


def test_the_values_of_a_material_tell_from_which_one_they_are_taken():
    own = changed(material={"gravel": {"density": "19 kN/m3"}}, cushion={"material": "gravel"})
    sand = prepare(own).layout.cushion.sand
    assert sand.description == "own material, like compacted sand"
    assert sand.source["modulus"].startswith("that of compacted sand: calibrated")
    assert sand.source["density"] == "given with the project"


# ---------------------------------------------------------------- what is derived


def test_rock_cushion_and_roof_have_the_numbers_of_a_hand_calculation():
    found = prepare(changed(rock={"density": 2600.0})).layout
    assert found.rock.radius == pytest.approx((3 * 2500 / 2600 / (4 * math.pi)) ** (1 / 3))
    assert found.rock.speed == pytest.approx(math.sqrt(2 * standard_gravity * 25))
    assert found.girders == pytest.approx((2 * found.rock.radius + 1.2) / 1.5)
    assert found.box_left == 0.0
    assert found.elements % 2 == 1
    at_surface = found.start_velocity_y**2 + 2 * standard_gravity * found.clearance
    assert at_surface == pytest.approx(found.rock.speed**2)


def test_a_strip_narrower_than_a_bay_lies_on_one_whole_girder():
    narrow = prepare(changed(roof={"spacing": 4.0})).layout
    assert narrow.cushion.effective_width == pytest.approx(2 * narrow.rock.radius + 1.2)
    assert narrow.girders == 1.0


def test_a_block_is_computed_as_the_sphere_of_equal_mass_and_density():
    rock = {"mass": None, "size": "1 m", "shape": "block", "density": 2500.0}
    found = prepare(changed(rock=rock)).layout.rock
    assert found.mass == pytest.approx(2500.0)
    assert 4 / 3 * math.pi * found.radius**3 == pytest.approx(1.0)


def test_the_description_is_made_of_the_values():
    described = shed_case(prepare(changed(rock={"mass": "3 t"}, roof={"span": "8 m"}))).summary
    assert described == (
        "3 t from 25 m on 1.2 m of compacted sand on girders H-400x400x13x21, 1.5 m apart, span 8 m"
    )


def rows_of(**choices):
    """Draw a table: each field from its choices, left out where None is drawn."""
    return st.fixed_dictionaries(choices).map(
        lambda fields: {key: value for key, value in fields.items() if value is not None}
    )


def perhaps(choices):
    return st.one_of(st.none(), choices)


GIRDERS = rows_of(
    section=st.sampled_from(sorted(sections())),
    steel=perhaps(st.sampled_from(sorted(steels()))),
    yield_stress=perhaps(st.floats(2e8, 7e8)),
    slab=perhaps(st.fixed_dictionaries({"thickness": st.floats(0.05, 0.5)})),
    bending=st.sampled_from(["yielding", "elastic"]),
    spacing=st.floats(0.3, 8.0),
    number=perhaps(st.integers(1, 12)),
)
OWN_SECTIONS = st.builds(
    lambda area, height, slenderness, modulus, shape, spacing: (
        {
            "area": area,
            "height": height,
            "second_moment": slenderness * area * height**2,
            "spacing": spacing,
            "yield_stress": 3e8,
        }
        | ({"section_modulus": 2 * slenderness * area * height * modulus} if modulus else {})
        | ({"plastic_modulus": 2 * slenderness * area * height * shape} if shape else {})
    ),
    area=st.floats(1e-3, 0.2),
    height=st.floats(0.1, 2.0),
    slenderness=st.floats(0.05, 0.25),
    modulus=perhaps(st.floats(0.5, 1.0)),
    shape=perhaps(st.floats(1.0, 1.7)),
    spacing=st.floats(0.3, 8.0),
)
STRIPS = st.builds(
    lambda thickness, cover, diameter, spacing, strength, stress: {
        "concrete": {
            "thickness": thickness,
            "cover": cover * thickness,
            "bar_diameter": diameter,
            "bar_spacing": spacing,
            "concrete_strength": strength,
            "bar_yield_stress": stress,
        }
    },
    thickness=st.floats(0.2, 2.0),
    cover=st.floats(0.02, 0.6),
    diameter=st.floats(0.006, 0.04),
    spacing=st.floats(0.08, 0.5),
    strength=st.floats(1.5e7, 8e7),
    stress=st.floats(2e8, 6e8),
)
SUPPORTS = st.one_of(
    st.sampled_from([{"kind": "hinged"}, {"kind": "fixed"}]),
    rows_of(kind=st.just("elastic"), stiffness=st.floats(1e5, 1e11)),
    st.just({"kind": "piles", "file": str(TEMPLATES["pile"])}),
)
ROCKS = st.one_of(
    rows_of(mass=st.floats(10.0, 2e5), drop_height=st.floats(0.2, 200.0)),
    rows_of(
        mass=st.floats(10.0, 2e5),
        velocity=st.floats(1.0, 70.0),
        angle=st.floats(-1.4, 1.4),
        spin=perhaps(st.floats(-20.0, 20.0)),
    ),
    rows_of(
        size=st.floats(0.1, 5.0),
        shape=st.sampled_from(["sphere", "block"]),
        density=perhaps(st.floats(1800.0, 3200.0)),
        velocity=st.floats(1.0, 70.0),
    ),
)
CRITERIA = rows_of(
    deflection=perhaps(st.one_of(st.floats(0.001, 0.5), st.just("span/300"))),
    stress=perhaps(st.floats(1e8, 4e8)),
    plastic_moment=perhaps(st.floats(1e4, 1e7)),
    pile_set=perhaps(st.floats(1e-3, 0.05)),
    penetration=perhaps(st.floats(0.1, 2.0)),
)
WIDTHS = perhaps(st.one_of(st.sampled_from(sorted(RULES)), st.floats(0.3, 8.0)))


@settings(max_examples=40)
@given(
    span=st.floats(1.0, 40.0),
    cushion=rows_of(thickness=st.floats(0.2, 4.0), effective_width=WIDTHS),
    narrower=perhaps(st.floats(0.2, 1.1)),
    roof=st.one_of(GIRDERS, OWN_SECTIONS, STRIPS),
    supports=SUPPORTS,
    rock=ROCKS,
    place=perhaps(st.floats(0.0, 1.0)),
    criteria=CRITERIA,
    clearance=perhaps(st.floats(0.01, 3.0)),
)
def test_whatever_is_changed_everything_fits_or_the_refusal_names_the_field(
    span, cushion, narrower, roof, supports, rock, place, criteria, clearance
):
    project = {
        "rock": rock if place is None else {**rock, "place": place * span},
        "cushion": cushion if narrower is None else {**cushion, "width": narrower * span},
        "roof": {**roof, "span": span},
        "supports": supports,
        "criteria": criteria,
        "numerics": {} if clearance is None else {"clearance": clearance},
    }
    try:
        shed = prepare(project)
    except InputRefused as refusal:
        tables = {name.rpartition(".")[0] for name in all_fields()}
        for problem in refusal.problems:
            field = problem.what.partition(":")[0]
            assert field in all_fields() or field in tables, problem
        return
    case = shed_case(shed)
    found = shed.layout
    limits = {entry["name"]: entry["limit"] for entry in case.facts["design"]["criteria"]}
    assert all(math.isfinite(limit) and limit > 0.0 for limit in limits.values())
    if criteria.get("deflection") == "span/300":
        assert limits["deflection"] == pytest.approx(span / 300)
    if supports["kind"] == "piles":
        weight = standard_gravity * span * line_mass(found.cushion, found.roof, found.girders)
        assert found.rod.toe_resistance > 0.5 * weight + found.rod.weight
    if found.rod is None or found.rod.segments <= 2000:  # a system of more takes seconds to make
        fits(case)
        stable_beams(case)


def stable_beams(case):
    """Check that the steps of the beam as a component takes them are stable."""
    fmus = dict.fromkeys(case.models, "")
    spec = case.make(fmus, case.sizes, "impulse")
    beam = component("RBSMBeam").instance(elements=case.sizes["beam"]["elements"])
    for name, value in spec.components["beam"].parameters.items():
        beam[name] = value
    for name in ("box.left", "box.width"):
        beam[name] = spec.shared[name.replace(".", "_")].value
    beam.initialise()  # without gravity: a rest under weights is found slowly where it yields
    assert spec.components["beam"].parameters["internal_step"] <= beam["stable_step"]


def fits(case):
    """Check the numbers of a system as they go to its components."""
    fmus = dict.fromkeys(case.models, "")
    system = case.make(fmus, case.sizes, "impulse")
    value = {
        f"{name}.{key}": entry
        for name, spec in system.components.items()
        for key, entry in spec.parameters.items()
    } | {name: entry.value for entry in system.shared.values() for name in entry.targets}
    span, left, width = value["beam.span"], value["sand.box.left"], value["sand.box.width"]
    elements, radius = case.sizes["beam"]["elements"], value["rock.radius"]
    assert left >= -1e-9
    assert left + width <= span * (1 + 1e-9)
    assert left + width / 2 == pytest.approx(span / 2)
    assert value["beam.axis.y"] + value["sand.beam.radius"] == pytest.approx(0.0, abs=1e-12)
    assert 2 * value["sand.beam.radius"] * elements == pytest.approx(span)
    assert case.sizes["sand"]["elements"] == elements
    assert left + radius < value["rock.position0.x"] < left + width - radius
    thickness = case.facts["design"]["cushion"]["thickness"]
    assert value["rock.position0.y"] - radius > thickness
    assert value["rock.velocity0.y"] < 0.0
    disc = math.pi * value["sand.disc.radius"] ** 2 * (1 + SPREAD**2 / 3)
    filled = case.sizes["sand"]["discs"] * disc / value["sand.solid_fraction"]
    assert filled == pytest.approx(width * thickness, rel=0.02)
    largest = 2 * value["sand.disc.radius"] * (1 + SPREAD)
    assert largest <= radius
    assert largest < width
    assert 8 * value["sand.disc.radius"] <= thickness * (1 + 1e-6)
    assert value["beam.internal_step"] <= system.exchange_step < system.stop_time
    assert value["sand.gravity"] == value["rock.gravity"] == value["beam.gravity"]


# ---------------------------------------------------------------- criteria


def limits(**tables):
    shed = prepare(changed(**tables))
    return {entry["name"]: entry["limit"] for entry in shed_case(shed).facts["design"]["criteria"]}


@pytest.mark.parametrize(
    ("written", "limit"),
    [("30 mm", 0.03), (0.03, 0.03), ("span/300", 0.03), (" span / 450.5 ", 9 / 450.5)],
)
def test_a_deflection_is_limited_to_a_length_or_a_part_of_the_span(written, limit):
    assert limits(criteria={"deflection": written})["deflection"] == pytest.approx(limit)


def test_a_part_of_the_span_moves_with_the_span():
    with_part = {"criteria": {"deflection": "span/300"}}
    assert limits(**with_part, roof={"span": "6 m"})["deflection"] == pytest.approx(0.02)


@pytest.mark.parametrize("written", ["span", "span/0", "span/300 m", "300", "-3 mm", "3 kg", True])
def test_a_deflection_that_is_neither_is_refused(written):
    (told,) = refusals(changed(criteria={"deflection": written if written != "300" else [300]}))
    assert "criteria.deflection" in told


# ---------------------------------------------------------------- from Python


def test_a_field_may_be_set_with_a_unit_and_moves_all_of_it():
    system = rockshed.shed(PROJECT, in_process=True, roof={"span": "6 m"}, rock={"mass": "1 t"})
    assert system.spec.components["beam"].parameters["span"] == 6.0
    assert system.spec.components["rock"].parameters["position0.x"] == 3.0
    assert system.job.facts["differences"] == {"roof.span": "6 m", "rock.mass": "1 t"}
    assert system.job.facts["design"]["roof"]["span"] == 6.0
    again = system.with_values({"roof.span": 7.0})
    assert again.spec.components["beam"].parameters["span"] == 7.0
    assert again.spec.shared["rock_mass"].value == 1000.0


def test_what_follows_from_the_project_cannot_be_set_apart_from_it():
    with pytest.raises(InputRefused) as refused:
        rockshed.shed(PROJECT, in_process=True, values={"beam.span": 6.0, "rock.radius": 1.0})
    told = str(refused.value)
    assert "beam.span: follows from the project's roof.span; set that" in told
    assert "rock.radius: follows from the project's rock.mass, rock.size" in told


def test_a_value_of_a_component_may_have_a_unit():
    values = {"sand.friction_angle": "32 deg", "sand.damping": 0.3}
    system = rockshed.shed(PROJECT, in_process=True, values=values)
    sand = system.spec.components["sand"].parameters
    assert sand["friction_angle"] == pytest.approx(math.radians(32))
    with pytest.raises(InputRefused, match="must be an angle, in rad"):
        rockshed.shed(PROJECT, in_process=True, values={"sand.friction_angle": "32 kg"})


def test_the_form_says_what_each_field_means():
    from rockshed.input_files.fields import fields

    for name, entry in fields(ShedProject):
        assert entry.description, name

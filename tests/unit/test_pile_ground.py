"""Ground in layers, sections, hammers and cushions by name: what follows from the file of a pile."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rockshed
from rockshed.core.errors import InputRefused
from rockshed.formulas.pile_driving import Stroke, gates, hiley
from rockshed.sites.pile.ground import GroundProfile
from rockshed.sites.pile.hammers import cushion_materials, hammer_models
from rockshed.sites.pile.preparation import prepare
from rockshed.sites.pile.site import Ground, NamedSoil

EXAMPLE = Path(rockshed.__file__).parent / "examples" / "pile_ground.toml"
TEXT = EXAMPLE.read_text(encoding="utf-8")
WATER, G = 1000.0, 9.80665


@pytest.fixture
def site(tmp_path):
    """Write the example with changes and prepare it."""

    def prepared(*replaced):
        text = TEXT
        for old, new in replaced:
            assert old in text
            text = text.replace(old, new)
        file = tmp_path / "site.toml"
        file.write_text(text, encoding="utf-8")
        return prepare(file)

    return prepared


def test_the_stress_is_the_weight_above_less_the_water(site):
    profile = GroundProfile(site().site.ground, site().site.soil)
    assert profile.stress(2.0) == pytest.approx(1700.0 * G * 2.0)
    below = (1700.0 * 6.0 + 1900.0 * 4.0 - WATER * 8.0) * G
    assert profile.stress(10.0) == pytest.approx(below)


def test_friction_by_stress_has_the_value_of_a_calculation_by_hand(site):
    """From 6 m to 13 m beta 0.3 times the stress, 1.6 m of perimeter; the stress is linear there."""
    parts = [part for part in site().site.friction if part.soil == "medium sand"]
    mean_stress = (1700.0 * 6.0 + 1900.0 * 3.5 - WATER * 7.5) * G
    assert sum(part.resistance for part in parts) == pytest.approx(0.3 * mean_stress * 7.0 * 1.6)
    (clay,) = (part for part in site().site.friction if part.soil == "soft clay" and part.top > 5.9)
    assert clay.lower / 1.6 == pytest.approx(0.6 * (15e3 + 1.5e3 * 6.0))


@settings(max_examples=25)
@given(
    first=st.floats(1e3, 5e4),
    growth=st.floats(1.0, 1e4),
    limit=st.floats(2e3, 6e4),
    penetration=st.floats(1.0, 10.0),
    segments=st.integers(3, 80),
)
def test_segments_share_the_friction_of_any_growth_and_limit(
    first, growth, limit, penetration, segments
):
    soil = {"friction": first, "friction_growth": growth, "friction_limit": limit, "toe": 1e7}
    made = prepare(
        {
            "segments": segments,
            "hammer": {"mass": 500.0, "drop": 0.5},
            "rod": [{"length": 10.0, "width": 0.3, "modulus": 3e10, "density": 2400.0}],
            "ground": {"penetration": penetration, "layers": [{"soil": "one", "to": 12.0}]},
            "soil": {"one": soil},
        }
    )
    depth = np.linspace(0.0, penetration, 200_001)
    middle = 0.5 * (depth[1:] + depth[:-1])
    unit = np.minimum(first + growth * middle, limit)
    expected = 1.2 * np.sum(unit) * penetration / 200_000
    assert sum(made.soil()["shaft.resistance"]) == pytest.approx(expected, rel=1e-6)
    assert made.shaft_resistance == pytest.approx(expected, rel=1e-6)


def test_a_deeper_toe_never_has_less_friction(site):
    pile = site()
    shaft = [pile.at(depth).shaft_resistance for depth in np.linspace(1.0, 20.0, 30)]
    assert np.all(np.diff(shaft) > 0.0)


def test_soil_under_a_toe_at_a_bound_is_that_below(site):
    pile = site()
    assert pile.at(6.0).site.toe.resistance == pytest.approx(3e6 * 0.16)
    assert pile.at(5.999).site.toe.resistance == pytest.approx(250e3 * 0.16)
    assert pile.at(19.0).site.toe.resistance < 8e6 * 0.16


def test_a_pipe_has_its_ring_and_its_outer_perimeter():
    pile = prepare(
        {
            "hammer": {"mass": 4000.0, "drop": 1.0},
            "rod": [
                {"length": 9.0, "diameter": 0.5, "wall": 0.01, "modulus": 2e11, "density": 7850.0}
            ],
            "toe": {"resistance": 1e6},
        }
    )
    (section,) = pile.site.rod
    assert section.area == pytest.approx(math.pi * 0.49 * 0.01)
    assert section.perimeter == pytest.approx(math.pi * 0.5)
    assert section.outline == pytest.approx(math.pi * 0.0625)


def test_cushion_and_hammer_come_from_the_tables(site):
    design = site().site
    material = cushion_materials()["fir plywood"]
    assert design.pile_cushion.stiffness == pytest.approx(material.modulus * 0.16 / 0.15)
    assert design.pile_cushion.restitution == material.restitution
    assert design.hammer.mass == 5000.0
    assert design.hammer.energy == pytest.approx(59e3)
    assert site(("efficiency = 0.8", 'efficiency = 0.8\ndrop = "60 cm"')).site.hammer.drop == 0.6


def test_every_row_of_the_tables_has_a_source_and_can_strike():
    for name, model in hammer_models().items():
        assert len(model.source) > 20, name
        made = prepare(
            {
                "hammer": {"model": name},
                "cushion": {"material": "micarta", "thickness": 0.1, "area": 0.2},
                "rod": [{"length": 9.0, "width": 0.4, "modulus": 3e10, "density": 2400.0}],
                "toe": {"resistance": 1e6},
            }
        )
        assert made.rated_energy > 1e4
    assert all(len(material.source) > 20 for material in cushion_materials().values())


@given(
    permanent=st.floats(0.0, 0.1),
    energy=st.floats(1e3, 1e6),
    compliance=st.floats(1e-12, 1e-7),
    restitution=st.floats(0.0, 1.0),
)
def test_hileys_resistance_spends_the_energy_that_is_left(
    permanent, energy, compliance, restitution
):
    stroke = Stroke(energy, 0.8, 3000.0, 5000.0, restitution, compliance, 2.5e-3)
    resistance = hiley(stroke, permanent)
    left = 0.8 * energy * (3000.0 + restitution**2 * 5000.0) / 8000.0
    spent = resistance * (permanent + 0.5 * (resistance * compliance + 2.5e-3))
    assert spent == pytest.approx(left, rel=1e-9)


def test_gates_in_the_units_of_the_fhwa():
    """44 kJ and 5 blows for 25 mm: 7 sqrt(44000) log10(50) - 550 = 1944.7 kN, by hand."""
    stroke = Stroke(44e3, 0.5, 1.0, 1.0, 1.0, 1e-9, 1e-3)
    assert gates(stroke, 5e-3) == pytest.approx(1944.7e3, rel=1e-4)
    assert gates(stroke, 0.3) == 0.0


BAD = [
    (('friction = "15 kPa"', "friction = 0"), "friction = 0", "must be greater than 0"),
    (
        (
            'friction = "15 kPa"             # at the top of the layer\nfriction_growth = "1.5 kPa/m"\n',
            "",
        ),
        "driving = 0.6",
        "driving belongs to a friction that soft clay does not have: it never resists",
    ),
    (('{ soil = "soft clay", to = "6 m" },', ""), '[soil."soft clay"]', "is in no layer"),
    (('density = "1.7 t/m3"\n', ""), '[soil."soft clay"]', "soft clay has no density"),
    (('to = "13 m"', 'to = "5 m"'), 'to = "5 m"', "the one above at 6 m"),
    (('"18 m"]', '"28 m"]'), '"28 m"', "takes a longer rod than 20 m"),
    (('to = "25 m"', 'to = "17 m"'), '"18 m"]', "the ground is known down to 17 m only"),
    (('width = "40 cm"', "area = 0.16"), "[[rod]]", "has no perimeter"),
    (
        ('width = "40 cm"', 'diameter = "40 cm"\nwall = "1 cm"'),
        "[ground]",
        "a closed one 0.1257 m2",
    ),
    (('"Junttan HHK 5A"', '"Junttan HHK 5"'), 'model = "Junttan HHK 5"', "there is no hammer"),
    (('"fir plywood"', '"fir"'), 'material = "fir"', "there is no cushion material"),
    (('thickness = "15 cm"\n', ""), "[pile_cushion]", "no thickness from which it follows"),
    (('[helmet]\nmass = "900 kg"', ""), "[pile_cushion]", "has no helmet above it"),
    (
        ("efficiency = 0.8", "efficiency = 0.8\ngas = { force = 1e5 }"),
        "gas",
        "only a diesel hammer",
    ),
    (
        ("efficiency = 0.8", 'efficiency = 0.8\nkind = "diesel"'),
        'kind = "diesel"',
        "no force of its gas",
    ),
    (("beta = 0.45", 'beta = 0.45\nfriction = "3 kPa"'), "beta = 0.45", "given twice"),
]


@pytest.mark.parametrize(("replaced", "place", "words"), BAD)
def test_refused_with_the_line(site, replaced, place, words):
    text = TEXT.replace(*replaced)
    line = text.count("\n", 0, text.index(place)) + 1
    with pytest.raises(InputRefused) as refusal:
        site(replaced)
    problems = [str(problem) for problem in refusal.value.problems]
    assert any(f"line {line}," in text and words in text for text in problems), problems


def test_everything_wrong_is_told_at_once(site):
    wrong = (
        ('"Junttan HHK 5A"', '"none"'),
        ('"fir plywood"', '"fir"'),
        ('to = "13 m"', 'to = "5 m"'),
    )
    with pytest.raises(InputRefused) as refusal:
        site(*wrong)
    assert len(refusal.value.problems) == 3


def test_a_shaft_layer_without_resistance_is_refused():
    rod = {"length": 9.0, "width": 0.4, "modulus": 3e10, "density": 2400.0}
    with pytest.raises(InputRefused, match="never resists"):
        prepare(
            {
                "hammer": {"mass": 4000.0, "drop": 1.0},
                "rod": [rod],
                "shaft": [{"from": 1.0, "to": 2.0, "resistance": 0.0}],
                "toe": {"resistance": 1e6},
            }
        )


def test_ground_that_is_dry_has_no_water_pressure():
    ground = Ground(penetration=5.0, layers=[{"soil": "s", "to": 9.0}])
    profile = GroundProfile(ground, {"s": NamedSoil(density=2000.0, beta=0.25)})
    assert profile.stress(4.0) == pytest.approx(2000.0 * G * 4.0)

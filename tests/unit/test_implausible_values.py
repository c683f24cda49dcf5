"""Values beyond what is usual: computed, with a warning that names the unit that may be meant."""

import tomllib

import pytest

import rockshed
from rockshed.components.catalogue import NAMES, component
from rockshed.core.errors import InputRefused
from rockshed.runs.projects import TEMPLATES
from rockshed.sites.pile import preparation as pile
from rockshed.sites.rockfall import preparation as slope


def content(name, **tables):
    data = tomllib.loads(TEMPLATES[name].read_text(encoding="utf-8"))
    for table, fields in tables.items():
        data[table] = {**data[table], **fields}
    return data


@pytest.mark.parametrize(
    ("values", "meant"),
    [
        ({"sand.modulus": 30.4}, "if 30.4 kgf/cm2 is meant"),
        ({"sand.unit_weight": 18.0}, "if 18 kN/m3 is meant"),
        ({"rock.mass": 4.9e6}, "rock.mass is 4.9e+06 kg, and 0.001 to 1e+06 kg are usual"),
        ({"rock.velocity0.y": -8000.0}, "if -8000 mm/s is meant"),
    ],
)
def test_a_parameter_of_a_case_is_doubted(values, meant):
    system = rockshed.case("lab-impact", in_process=True, values=values)
    assert any(meant in text for text in system.job.facts["warnings"]), system.job.facts


def test_a_parameter_of_a_case_takes_a_unit_of_its_kind():
    values = {"sand.modulus": "30.4 kgf/cm2", "rock.mass": "4 kg"}
    system = rockshed.case("lab-impact", in_process=True, values=values)
    sand = system.spec.components["sand"].parameters
    assert sand["modulus"] == pytest.approx(30.4 * 98066.5)
    assert system.spec.shared["rock_mass"].value == 4.0
    assert "warnings" not in system.job.facts
    with pytest.raises(InputRefused, match="must be a pressure, in Pa"):
        rockshed.case("lab-impact", in_process=True, values={"sand.modulus": "30.4 kg"})


@pytest.mark.parametrize("name", NAMES)
def test_a_component_is_as_it_is_usual(name):
    for variable in component(name).layout.variables:
        if variable.plausible is not None:
            assert variable.plausible.low < variable.plausible.high
            assert variable.plausible.holds(variable.start_at(0, {})), variable.name


def test_a_pile_is_read_with_units_and_doubted_without():
    written = content("pile", toe={"resistance": "800 kN", "quake": "3 mm"})
    prepared = pile.prepare(written)
    assert prepared.site.toe.resistance == 8e5
    assert prepared.warnings == ()
    told = pile.prepare(content("pile", hammer={"mass": 5.0}, toe={"quake": 4.0})).warnings
    assert "hammer.mass is 5 kg" in told[0]
    assert "if 5 t is meant" in told[0]
    assert "if 4 mm is meant" in told[1]
    weak = content("pile", toe={"resistance": 192.0}) | {"shaft": []}
    with pytest.raises(InputRefused, match=r"sink without a blow; .*if 192 kN is meant"):
        pile.prepare(weak)


def test_a_slope_is_read_with_units_and_doubted_without():
    fence = {"name": "fence", "x": 20.0, "height": "3 m", "capacity": "1000 kJ"}
    site = {**content("slope"), "barrier": [fence]}
    prepared = slope.prepare(site)
    assert prepared.site.barrier[0].capacity == 1e6
    assert prepared.warnings == ()
    start = {**site["start"], "velocity": [1e6, 0.0]}
    site = {**site, "barrier": [{**fence, "capacity": 1000.0}], "start": start}
    told = slope.prepare(site).warnings
    assert any("barrier.1.capacity is 1000 J" in text and "1000 kJ" in text for text in told)
    assert any("start.velocity.1 is 1e+06 m/s" in text for text in told)

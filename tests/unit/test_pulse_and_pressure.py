"""Results as a designer names them: rise, shape of the pulse, pressure on the roof and its spread."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rockshed.components.common.roles import Role
from rockshed.core.results.metric import Metrics
from rockshed.formulas import FORCE, estimates
from rockshed.formulas.rock_impact import RockImpact
from rockshed.metrics import names
from rockshed.metrics.headlines import headlines
from rockshed.metrics.practice import formula_table, formula_values, impact_of, with_formulas
from rockshed.metrics.pressure import RoofPressure, roof_pressure
from rockshed.metrics.pulse import rise_time, shape_factor
from rockshed.references import Known, Reference, References
from tests.unit.test_headlines import made_up

TIME = np.linspace(0.0, 0.01, 2001)
HALF_SINE = np.sin(np.pi * TIME / 0.01)
TRIANGLE = 1.0 - np.abs(TIME / 0.005 - 1.0)


@pytest.mark.parametrize(("force", "share"), [(HALF_SINE, 2 / np.pi), (TRIANGLE, 0.5)])
def test_the_shape_factor_tells_a_half_sine_from_a_triangle(force, share):
    assert shape_factor(TIME, force) == pytest.approx(share, rel=0.015)  # cut off at 1 %
    assert shape_factor(TIME, np.ones_like(TIME)) == pytest.approx(1.0)
    assert shape_factor(np.zeros_like(TIME), force) is None
    assert shape_factor(TIME, 0.0 * TIME) is None


def test_the_rise_is_counted_from_a_tenth_to_nine_tenths_between_the_rows():
    exact = 0.01 / np.pi * (np.arcsin(0.9) - np.arcsin(0.1))
    assert rise_time(TIME, HALF_SINE) == pytest.approx(exact, rel=1e-3)
    assert rise_time(TIME, 3e3 * TRIANGLE) == pytest.approx(0.8 * 0.005, rel=1e-6)
    assert rise_time(TIME, -HALF_SINE) is None


def even_load(width, elements=40, length=0.1):
    """An even load of 100 kPa in the middle, over 10 kPa at rest."""
    places = (np.arange(elements) + 0.5) * length
    middle = 0.5 * elements * length
    loaded = np.abs(places - middle) < 0.5 * width
    values = 10e3 + np.outer(np.where(loaded, 100e3, 0.0), (0.0, 1.0, 0.5))
    return RoofPressure(places, values, length, 2)


@pytest.mark.parametrize("width", [0.4, 1.0, 2.0])
def test_an_even_load_has_its_parts_within_their_share_of_half_its_width(width):
    load = even_load(width)
    assert load.within(0.5) == pytest.approx(0.25 * width, rel=1e-2)
    assert load.within(0.9) == pytest.approx(0.45 * width, rel=1e-2)


def test_a_load_after_the_rock_has_turned_does_not_count_as_spread():
    values = even_load(1.0).values.copy()
    values[:, 2] = 1e6
    assert RoofPressure(even_load(1.0).places, values, 0.1, 1).row_of_most_load() == 1


def with_roof():
    """The made-up run on a beam of five elements of 0.2 m, the middle one under most of the load."""
    run = made_up()
    time = run.series["time"]
    push = np.clip(np.sin(np.pi * time / 0.01), 0.0, None)
    forces = {f"sand.beam.force.y[{i + 1}]": -s * 1e3 * push for i, s in enumerate((0, 1, 2, 1, 0))}
    places = {f"beam.position.x[{i + 1}]": 0.1 + 0.2 * i + 0.0 * time for i in range(5)}
    components = json.loads(json.dumps(run.provenance["components"]))
    given = {"mass": 4.0, "radius": 0.05}
    components["rock"]["parameters"] = {n: {"value": v} for n, v in given.items()}
    components["sand"]["parameters"]["thickness"] = {"value": 0.1}
    facts = {**run.provenance, "components": components}
    depth = run.series["sand.penetration"]
    above = {"sand.rock.above_surface": -depth, "sand.clearance": 0.3 - depth}
    series = {
        **run.series,
        **forces,
        **places,
        **above,
    }
    return replace(run, series=series, provenance=facts)


def test_pressure_is_the_force_on_an_element_over_its_area():
    found = roof_pressure(with_roof(), "sand")
    assert found.length == pytest.approx(0.2)
    assert found.values.max() == pytest.approx(2e3 / (0.2 * 0.1), rel=0.02)
    assert roof_pressure(made_up(), "sand") is None


def test_a_run_on_a_roof_has_its_pressure_and_spread_among_its_metrics():
    found = Metrics(headlines(with_roof()))
    assert found["peak_pressure_on_the_roof"].value == pytest.approx(100e3, rel=0.02)
    assert found["peak_pressure_on_the_roof_at_the_place"].value == pytest.approx(0.5)
    assert found["90_of_the_load_on_the_roof_within"].value == pytest.approx(0.26, abs=0.02)
    assert found["penetration_thickness_of_the_cushion"].value == pytest.approx(0.2, abs=0.01)


def test_formulas_take_mass_speed_and_thickness_from_the_results():
    run = with_roof()
    impact = impact_of(run)
    assert impact == RockImpact(
        4.0, 0.05, pytest.approx(np.sqrt(50.0), rel=1e-3), pytest.approx(0.3)
    )
    assert [e.value for e in formula_values(run)] == pytest.approx(
        [e.value for e in estimates(impact)]
    )
    assert formula_values(made_up()) == []
    assert len(formula_table(made_up())) == 0


def test_a_mass_that_is_no_positive_number_gives_no_formulas():
    run = with_roof()
    for wrong in ("heavy", -4.0, True):
        components = json.loads(json.dumps(run.provenance["components"]))
        components["rock"]["parameters"]["mass"] = {"value": wrong}
        facts = {**run.provenance, "components": components}
        assert formula_values(replace(run, provenance=facts)) == []


def test_formulas_are_references_of_the_peak_force():
    run = with_roof()
    metrics = Metrics(with_formulas(headlines(run), formula_values(run)))
    beside = metrics["peak_force_on_the_rock"].references
    assert next(iter(beside)) == "Japanese handbook"
    assert metrics["peak_transmitted_force"].references == {}
    rows = [row for row in formula_table(run) if row["quantity"] == FORCE]
    assert {row["computed"] for row in rows} == {
        f"{100 * found.deviation:+.0f} %" for found in beside.values()
    }


def test_references_of_any_source_are_read_again():
    known = Known(Reference(1.0), others={"somebody": Reference(2.0, "by eye")})
    told = References({names.PEAK_ROCK: known})
    assert References.from_data(json.loads(json.dumps(told.as_data()))).known == told.known


def test_the_energy_at_the_end_is_told_in_shares_of_the_impact_energy():
    run = made_up()
    kinetic = run.series["rock.energy.kinetic"]
    found = Metrics(headlines(run))
    share = found["kinetic_energy_of_the_rock_at_the_end_impact_energy"].value
    assert share == pytest.approx(kinetic[-1] / kinetic[0])


def test_roles_of_the_roof_are_declared():
    assert {Role.ON_STRUCTURE, Role.ALONG, Role.EFFECTIVE_WIDTH, Role.BODY_MASS} <= set(Role)

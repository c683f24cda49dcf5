"""A beam as a designer asks for it: peak moment, peak reaction, and the picture of the moment."""

from dataclasses import replace

import numpy as np
import pytest

import rockshed
from rockshed.metrics import comparison
from rockshed.metrics.doubts import warnings
from rockshed.metrics.headlines import headlines
from rockshed.pictures.declared import declared_pictures

STEEL = 7850.0 * 11.85e-4
"""Mass of the laboratory beam by length (kg/m)."""
SPAN = 1.2
GRAVITY = 9.80665


def at_rest(**values):
    """Return the run of a beam that lies still under its weight and a deck of 100 kg/m."""
    parameters = {"gravity": GRAVITY, "deck.mass": 100.0, **values}
    system = rockshed.System.new("beam", exchange_step=1e-4, stop_time=1e-3)
    return rockshed.simulate(system.add("beam", "RBSMBeam", parameters))


@pytest.fixture(scope="module")
def simple():
    return at_rest()


def test_peak_moment_and_reaction_of_a_beam_at_rest_are_those_of_the_books(simple):
    load = (STEEL + 100.0) * GRAVITY
    moment = simple.metrics["peak_bending_moment"]
    reaction = simple.metrics["peak_support_reaction"]
    assert (moment.unit, reaction.unit) == ("N.m", "N")
    assert moment.value == pytest.approx(load * SPAN**2 / 8, rel=1e-6)
    assert reaction.value == pytest.approx(load * SPAN / 2, rel=1e-6)


def test_the_peak_moment_of_a_fixed_beam_is_that_at_the_wall_with_its_sign():
    fixed = at_rest(supports="fixed")
    load = (STEEL + 100.0) * GRAVITY
    assert fixed.metrics["peak_bending_moment"].value == pytest.approx(
        -load * SPAN**2 / 12, rel=2e-2
    )


def test_moment_and_reaction_stand_in_the_table_in_field_units(simple):
    rows = {row["quantity"]: row for row in simple.table()}
    load = (STEEL + 100.0) * GRAVITY
    moment = rows["peak bending moment (+ sagging, - hogging)"]
    assert moment["unit"] == "kN m"
    assert moment["computed"] == f"{load * SPAN**2 / 8e3:.3f}"
    assert rows["peak reaction of a support, upwards"]["computed"] == f"{load * SPAN / 2e3:.2f}"


def test_a_beam_without_gravity_says_that_its_weight_is_left_out(simple):
    assert not any("gravity is 0" in note for note in simple.notes)
    assert any("beam: its gravity is 0" in note for note in at_rest(gravity=0.0).notes)


def test_the_picture_of_the_moment_goes_from_support_to_support_and_over_time(simple, tmp_path):
    assert simple.figures(tmp_path)["moment"].stat().st_size > 10_000
    (picture,) = [entry for entry in declared_pictures(simple) if entry.name == "moment"]
    envelope, midspan = picture.panels
    assert [envelope.is_envelope, midspan.is_envelope] == [True, False]
    from matplotlib.figure import Figure

    from rockshed.pictures.envelope import draw_envelope

    axes = Figure().subplots()
    draw_envelope(simple, "beam", envelope.told, axes, "")
    high = axes.lines[0]
    assert high.get_xdata()[[0, -1]] == pytest.approx([0.0, SPAN])
    assert high.get_ydata()[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12)
    load = (STEEL + 100.0) * GRAVITY
    assert high.get_ydata().max() == pytest.approx(load * SPAN**2 / 8e3, rel=1e-6)
    assert axes.get_ylabel() == "bending moment (kN m)"


def test_a_beam_on_three_supports_gives_the_reaction_of_the_middle_one_and_its_picture(tmp_path):
    """10/16 of the weight, and w l2/8 over it; through the FMU of this size."""
    parameters = {"gravity": GRAVITY, "deck.mass": 100.0, "support.element[3]": 13}
    system = rockshed.System.new("spans", exchange_step=1e-4, stop_time=1e-3)
    sizes = {"elements": 25, "support_count": 3}
    run = rockshed.simulate(system.add("beam", "RBSMBeam", parameters, sizes=sizes))
    load = (STEEL + 100.0) * GRAVITY
    reaction = run.metrics["peak_support_reaction"].value
    assert reaction == pytest.approx(load * SPAN * 10 / 16, rel=1e-3)
    assert run.metrics["peak_bending_moment"].value == pytest.approx(-load * SPAN**2 / 32, rel=1e-2)
    assert run.figures(tmp_path)["moment"].stat().st_size > 10_000


# ------------------------------------------------------------------ shear, places, utilisation


def value(metrics, name):
    return next(float(metric.value) for metric in metrics if metric.name == name)


def test_peak_moment_and_shear_have_their_places(simple):
    load = (STEEL + 100.0) * GRAVITY
    metrics = simple.metrics
    assert metrics["peak_bending_moment_at_the_place"].value == pytest.approx(0.5 * SPAN, rel=0.05)
    assert abs(metrics["peak_shear_force"].value) == pytest.approx(load * SPAN / 2, rel=1e-6)
    assert metrics["peak_shear_force_at_the_place"].value in (
        pytest.approx(0.0, abs=1e-9),
        pytest.approx(SPAN),
    )


def test_the_picture_of_the_shear_goes_from_support_to_support(simple, tmp_path):
    assert simple.figures(tmp_path)["shear"].stat().st_size > 10_000
    (picture,) = [entry for entry in declared_pictures(simple) if entry.name == "shear"]
    from rockshed.metrics.along import along

    places, values = along(simple, "beam", picture.panels[0].told)
    load = (STEEL + 100.0) * GRAVITY
    assert places == pytest.approx(np.linspace(0.0, SPAN, 25))
    assert values[:, 0] == pytest.approx(load * (0.5 * SPAN - places), abs=1e-6)


def designed(run, **limits):
    """The run with a design of one beam and these limits."""
    criteria = [{"name": name.replace("_", " "), "limit": limit} for name, limit in limits.items()]
    facts = {"roof": {"section_modulus": 37.4e-6}, "criteria": criteria}
    return replace(run, provenance={**run.provenance, "design": facts})


def test_a_run_is_compared_with_the_criteria_of_its_design(simple):
    load = (STEEL + 100.0) * GRAVITY
    moment = load * SPAN**2 / 8
    stress = moment * 0.05 / 187e-8
    found = headlines(designed(simple, stress=2.0 * stress, plastic_moment=moment, pile_set=1.0))
    assert value(found, "peak bending stress") == pytest.approx(stress, rel=1e-6)
    assert value(found, "utilisation by stress") == pytest.approx(0.5, rel=1e-6)
    assert value(found, "utilisation by plastic moment") == pytest.approx(1.0, rel=1e-6)
    assert not any("pile set" in metric.name for metric in found)
    assert not any("utilisation" in metric.name for metric in headlines(simple))


def test_a_limit_that_is_passed_is_doubted(simple):
    load = (STEEL + 100.0) * GRAVITY
    stress = load * SPAN**2 / 8 * 0.05 / 187e-8
    run = designed(simple, stress=stress / 2.33, deflection=1e-9)
    texts = warnings(run)
    assert any("stress past yield" in text and "2.33 times" in text for text in texts)
    assert any("section.bending=yielding" in text for text in texts)
    assert any("deflection past its limit" in text for text in texts)
    rows = {row.label: row for row in comparison.rows(run, {})}
    assert rows["utilisation: stress"].computed == "2.33"
    assert not any("past" in text for text in warnings(designed(simple, stress=1.01 * stress)))


def test_every_utilisation_above_one_is_doubted_and_none_below(simple):
    limits = {"stress": 1.0, "plastic_moment": 1.0, "sagging_moment": 1.0, "deflection": 1e-9}
    run = designed(simple, **limits, hogging_moment=1e12, reaction=1.0)
    shares = {m.name: m.value for m in headlines(run) if m.name.startswith("utilisation by ")}
    assert len(shares) == 6
    for name, share in shares.items():
        told = [text for text in warnings(run) if text.startswith(f"{name[15:]} past ")]
        assert len(told) == (share > 1.0), name


def test_a_run_that_has_failed_says_nothing_about_the_design(simple):
    run = designed(simple, stress=1.0, plastic_moment=1.0, deflection=1e-9)
    run = replace(run, provenance={**run.provenance, "status": "failed"})
    assert not any(" past " in text for text in warnings(run))
    assert not any("utilisation" in row.label for row in comparison.rows(run, {}))
    assert any("nothing is said about the design" in text for text in comparison.notes(run, {}))


def test_moment_and_reaction_are_told_of_one_girder_with_dead_load_and_signs(simple):
    run = designed(simple)
    design = run.provenance["design"]
    for kind, words in (("girders", "of one girder: "), ("concrete", "of a metre: ")):
        roof = {**design["roof"], "kind": kind, "girders": 2.0}
        own = {**run.provenance, "design": {**design, "roof": roof}}
        told = comparison.notes(replace(run, provenance=own), {})
        moment = (STEEL + 100.0) * GRAVITY * SPAN**2 / 8 / 2.0 / 1e3
        assert any(f"{words}{moment:.4g} kN m" in text for text in told)
    assert any("sagging" in text for text in told)
    assert any("dead load" in text and "mm" in text for text in told)


def test_a_beam_that_yields_shows_what_stays_and_no_doubt_about_its_stress():
    moment = (STEEL + 100.0) * GRAVITY * SPAN**2 / 8
    corners = {
        "section.bending": "yielding",
        "section.corner1.moment": 0.8 * moment,
        "section.hardening_ratio": 0.2,
    }
    run = at_rest(**corners)
    assert run.metrics["residual_midspan_deflection"].value > 0.0
    assert "plastic_work_in_the_beam" in run.metrics
    by_strain = "peak_beam_energy_from_the_midspan_strain"  # eq. (7), of an elastic beam
    assert (by_strain in run.metrics) == (run.metrics["plastic_work_in_the_beam"].value == 0.0)
    assert run.metrics["largest_curvature_curvature_of_the_last_corner"].value > 1.0
    texts = warnings(designed(run, stress=1.0))
    assert not any("stress past yield" in text for text in texts)
    assert any("stress past its limit" in text and "M/W" in text for text in texts)

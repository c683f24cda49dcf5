"""A beam as a designer asks for it: peak moment, peak reaction, and the picture of the moment."""

import pytest

import rockshed
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
    assert rows["peak bending moment"]["unit"] == "kN m"
    assert rows["peak bending moment"]["computed"] == f"{load * SPAN**2 / 8e3:.3f}"
    assert rows["peak support reaction"]["computed"] == f"{load * SPAN / 2e3:.2f}"


def test_a_beam_without_gravity_says_that_its_weight_is_left_out(simple):
    assert not any("gravity is 0" in note for note in simple.notes)
    assert any("beam: its gravity is 0" in note for note in at_rest(gravity=0.0).notes)


def test_the_picture_of_the_moment_goes_from_support_to_support_and_over_time(simple, tmp_path):
    assert simple.figures(tmp_path)["moment"].stat().st_size > 10_000
    (picture,) = [entry for entry in declared_pictures(simple) if entry.name == "moment"]
    envelope, midspan, reactions = picture.panels
    assert [envelope.is_envelope, midspan.is_envelope, reactions.is_envelope] == [
        True,
        False,
        False,
    ]
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

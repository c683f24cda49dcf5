"""Formulas of practice, against a printed table, a derivation and each other."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.formulas import (
    FORCE,
    PENETRATION,
    THICKNESS,
    FormulaValue,
    RockImpact,
    estimates,
    table_of,
)
from rockshed.formulas.handbook import handbook_force, thickness_factor
from rockshed.formulas.hertz import hertz_force
from rockshed.formulas.rock_impact import radius_of
from rockshed.formulas.swiss import astra_force, labiouse_force

G = 9.80665
ROCK_MASS, DROP = 1000.0, 10.0
IMPACT = RockImpact.fallen(ROCK_MASS, 0.456, DROP, thickness=0.9)
POSITIVE = st.floats(0.01, 1e4)


@pytest.mark.parametrize(("height", "printed"), [(20.0, 1945e3), (30.0, 2485e3), (40.0, 2954e3)])
def test_handbook_force_is_the_printed_one_of_30_kN_on_90_cm_of_sand(height, printed):
    assert handbook_force(30e3 / G, height, 1000e3) == pytest.approx(printed, rel=0.0015)


def test_handbook_formula_is_hertz_for_a_sphere():
    """Rock of 2650 kg/m3, nu = 0.25. 609.5 kN is printed for 1 tf, 10 m, 1000 kN/m2 with g rounded."""
    assert handbook_force(ROCK_MASS, DROP) == pytest.approx(609.5e3, rel=1e-3)
    for mass, height in ((1000.0, 10.0), (400.0, 25.0)):
        radius = (0.75 * mass / 2650.0 / math.pi) ** (1 / 3)
        assert handbook_force(mass, height) == pytest.approx(
            hertz_force(mass, radius, math.sqrt(2 * 9.80665 * height)), rel=2e-3
        )


def test_hertz_force_is_the_largest_of_a_sphere_that_is_stopped_by_its_half_space():
    """The motion m d'' = -4/3 E/(1 - nu2) sqrt(R) d^(3/2), integrated; E and nu from the Lame constants lambda, G."""
    mass, radius, speed, lame, shear = 1000.0, 0.456, 14.0, 1e6, 1.5e6
    modulus, poisson = shear * (3 * lame + 2 * shear) / (lame + shear), 0.5 * lame / (lame + shear)

    def force(depth):
        return 4 / 3 * modulus / (1 - poisson**2) * math.sqrt(radius) * max(depth, 0.0) ** 1.5

    path = solve_ivp(
        lambda t, y: (y[1], -force(y[0]) / mass), (0.0, 0.2), (0.0, speed), max_step=1e-4
    )
    assert hertz_force(mass, radius, speed, lame, poisson) == pytest.approx(
        max(map(force, path.y[0])), rel=1e-4
    )


def test_thickness_factor_is_1_for_a_rock_that_is_smaller_than_the_cushion_is_thick():
    assert thickness_factor(0.8, 0.9) == 1.0
    assert thickness_factor(1.8, 0.9) == pytest.approx(math.sqrt(2.0))


def test_swiss_formulas_give_the_values_of_one_tonne_from_ten_metres():
    stiff = RockImpact.fallen(ROCK_MASS, 0.456, DROP, modulus=10e6)
    assert labiouse_force(IMPACT) == pytest.approx(581e3, rel=1e-3)
    assert labiouse_force(stiff) == pytest.approx(941e3, rel=1e-3)
    assert astra_force(IMPACT, 0.9) == pytest.approx(460e3, rel=2e-3)


@given(mass=POSITIVE, radius=st.floats(0.05, 3.0), height=st.floats(0.1, 200.0))
def test_labiouse_is_hertz_with_the_modulus_of_a_plate_for_every_impact(mass, radius, height):
    """Both are proportional to E^(2/5) R^(1/5) (m g H)^(3/5): their ratio is one number."""
    impact = RockImpact.fallen(mass, radius, height)
    ratio = labiouse_force(impact) / hertz_force(mass, radius, impact.speed)
    assert ratio == pytest.approx(labiouse_force(IMPACT) / hertz_force(1000.0, 0.456, IMPACT.speed))


@given(height=st.floats(0.1, 200.0), thickness=st.floats(0.2, 5.0))
def test_penetration_of_astra_uses_up_the_energy_under_half_the_force(height, thickness):
    impact = RockImpact.fallen(ROCK_MASS, 0.456, height, thickness=thickness)
    found = {(e.name, e.quantity): e.value for e in estimates(impact)}
    force, depth = found["ASTRA 2008", FORCE], found["ASTRA 2008", PENETRATION]
    assert 0.5 * force * depth == pytest.approx(ROCK_MASS * G * height)
    assert found["ASTRA 2008", THICKNESS] == max(0.5, 2.0 * depth)


def test_formulas_that_need_the_thickness_are_left_out_where_it_is_not_known():
    names = {e.name for e in estimates(RockImpact.fallen(ROCK_MASS, 0.456, DROP))}
    assert names == {"Japanese handbook", "Labiouse 1996", "Hertz"}


def test_estimates_say_what_was_verified_and_whether_the_blow_is_in_range():
    heavy = RockImpact.fallen(20e3, radius_of(20e3), 100.0, thickness=0.9)
    assert {e.name: e.verified for e in estimates(IMPACT)} == {
        "Japanese handbook": True,
        "Japanese handbook, thickness factor": False,
        "ASTRA 2008": False,
        "Labiouse 1996": False,
        "Hertz": True,
    }
    assert not any(e.within_range for e in estimates(heavy))
    assert all("could not be read" in e.remark for e in estimates(IMPACT) if not e.verified)


def test_estimates_are_plain_data_that_can_be_read_again():
    data = json.loads(json.dumps([e.as_data() for e in estimates(IMPACT)]))
    assert [FormulaValue.from_data({**entry, "later": 1}) for entry in data] == estimates(IMPACT)


@pytest.mark.parametrize("changed", [{"mass": 0.0}, {"speed": -1.0}, {"friction_angle": 1.6}])
def test_a_blow_that_cannot_be_is_refused(changed):
    with pytest.raises(ValueError, match=next(iter(changed))):
        estimates(RockImpact(**{**vars(IMPACT), **changed}))


def test_a_table_shows_computed_values_as_deviations():
    table = table_of(estimates(IMPACT), {"computed": {FORCE: 700e3}})
    first = next(iter(table))
    assert (first["value"], first["unit"], first["computed"]) == ("609", "kN", "+15 %")
    assert all(not row["computed"] for row in table if row["quantity"] != FORCE)
    assert len(table.notes) == 5


def test_a_small_force_keeps_its_digits():
    """The ball of the laboratory: thousands of newtons, and no whole number of kilonewtons."""
    first = next(iter(table_of(estimates(RockImpact(3.92, 0.0495, 8.0, thickness=0.1)))))
    assert first["value"].count(".") == 1
    assert len(first["value"]) == 4


def test_formulas_are_reached_by_the_face():
    assert rockshed.formulas.estimates(IMPACT) == estimates(IMPACT)
    assert "formulas" in dir(rockshed)


def test_the_command_reads_units_and_gives_json():
    words = ["--mass", "3 m", "--height", "20m"]
    refused = CliRunner().invoke(app, ["formula", *words])
    assert refused.exit_code == 2
    assert "must be a mass" in refused.output
    words[1] = f"{30 / G} t"
    shown = CliRunner().invoke(app, ["formula", *words, "--thickness", "90 cm", "--json"])
    content = json.loads(shown.stdout)
    assert content["impact"]["thickness"] == pytest.approx(0.9)
    assert content["estimates"][0]["value"] == pytest.approx(1945e3, rel=1e-3)


def test_the_command_tells_all_problems_at_once():
    words = ["--mass", "5 xx", "--diameter", "1", "--density", "-2", "--friction-angle", "95 deg"]
    refused = CliRunner().invoke(app, ["formula", *words])
    assert refused.exit_code == 2
    for name in ("--mass:", "--density:", "--friction-angle:", "exclude", "--height or --speed"):
        assert name in refused.output

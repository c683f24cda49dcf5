"""Quantities with units, as they stand in input files and behind --set."""

import math
import re
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.components.common.plausible import Plausible
from rockshed.components.common.units import UNITS, cm2, deg, kgf
from rockshed.core.system.quantities import in_si
from rockshed.input_files.quantities import doubt


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("2.5 t", "kg", 2500.0),
        ("1.2 m", "m", 1.2),
        ("90cm", "m", 0.9),
        ("39 kgf/cm2", "Pa", 39 * kgf / cm2),
        ("400 kN", "N", 4e5),
        ("15 deg", "rad", 15 * deg),
        ("15°", "rad", 15 * deg),
        ("90 km/h", "m/s", 25.0),
        ("38,700 cm4".replace(",", ""), "m4", 3.87e-4),
        ("20 kN.m", "N.m", 2e4),
        ("20 kN·m", "N.m", 2e4),
        ("235 N/mm²", "Pa", 2.35e8),
        ("1e-3", "m", 1e-3),
        ("0.05 s/ft", "s/m", 0.05 / 0.3048),
    ],
)
def test_a_quantity_is_read_in_the_units_in_which_it_is_written(text, unit, value):
    assert in_si(text, unit) == pytest.approx(value, rel=1e-14)


def test_a_weight_stands_for_the_mass_that_has_it():
    assert in_si("2.5 tf", "kg") == 2500.0
    assert in_si("18 kN/m3", "kg/m3") == pytest.approx(18e3 / kgf)


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("2.5 t", "m", "must be a length, in m (given: '2.5 t', which is a mass)"),
        ("3 kn", "N", "must be a force, in N (given: '3 kn', which is a velocity)"),
        ("3 kgff/cm2", "Pa", "there is no unit 'kgff/cm2'; did you mean kgf/cm2"),
        ("3 Kg", "kg", "there is no unit 'Kg'; did you mean"),
        ("1,8 t", "kg", "write 1.8 (given: '1,8 t')"),
        ("1.234,5 kg", "kg", "write 1234.5 (given"),
        ("1,800 kg", "kg", "write 1.800 or 1800 (given"),
        ("heavy", "kg", "must be a number, with a unit or in kg (given: 'heavy')"),
        ("1e400 m", "m", "must be a finite number"),
        ("3 degC", "m", "is no unit to count in"),
        ("2 m99", "m", "is no unit"),
        ("1 " + "m" * 100, "m", "must be a number"),
        ("9**9**9**9 m", "m", "is no unit"),
    ],
)
def test_what_is_no_quantity_of_the_kind_is_refused_with_the_reason(text, unit, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        in_si(text, unit)


@given(st.floats(1e-12, 1e12), st.sampled_from(sorted(UNITS)))
def test_every_si_unit_of_a_port_can_be_written_and_changes_nothing(value, unit):
    written = f"{value!r} {unit}" if unit != "1" else repr(value)
    assert math.isclose(in_si(written, unit), value, rel_tol=1e-14)


@given(st.text(max_size=60))
def test_no_text_brings_the_reader_down(text):
    with suppress(ValueError):
        assert math.isfinite(in_si(text, "m"))


def test_a_value_beyond_what_is_usual_names_the_unit_in_which_it_may_be_meant():
    stiff = Plausible(1e5, 1e8, ("kgf/cm2", "MPa"))
    assert doubt(30.4, "Pa", stiff) == (
        "is 30.4 Pa, and 100000 to 1e+08 Pa are usual; if 30.4 kgf/cm2 is meant, write that unit: "
        "2.981e+06 Pa"
    )
    assert "18 kN/m3" in doubt(18.0, "kg/m3", Plausible(500, 3500, ("kN/m3",)))
    assert doubt(3e6, "Pa", stiff) is None
    assert doubt(0.0, "Pa", stiff) is None

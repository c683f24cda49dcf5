"""Table 5 of Sonoda et al. (1993): penetration and peak transmitted force that the paper computed for the laboratory impact."""

import dataclasses

import pytest

from rockshed.bench.monolithic import from_system
from rockshed.cases.sonoda1993 import DEFAULT_TEST, lab_system, table_5
from rockshed.cases.sonoda1993 import tests as table_2
from rockshed.components.common.units import cm, kgf

LITERAL = {
    "rotation": "free",
    "stiffness_factor": 1.0,
    "base.shape": "round",
    "base": "beam_discs",
}
ROWS = {round(row.modulus / kgf * cm**2): row for row in table_5() if row.damping == 0.2}
"""Rows of h = 0.2 by E_bar (kgf/cm2)."""


def errors(row, **options):
    """Relative errors of penetration and peak transmitted force against a row of the table."""
    system = lab_system(
        {"rock": "", "sand": "", "beam": ""},
        dataclasses.replace(table_2()[DEFAULT_TEST], modulus=row.modulus),
    )
    system.components["sand"].parameters["damping"] = row.damping
    system.components["sand"].parameters.update(options)
    program = from_system(system, stop_time=0.03)
    program.run()
    return (
        program.column("penetration").max() / row.penetration - 1.0,
        program.column("transmitted_force").max() / row.peak_force - 1.0,
    )


@pytest.mark.parametrize(
    "row", table_5(), ids=lambda row: f"{row.modulus / kgf * cm**2:.0f}-{row.damping}"
)
def test_calibrated_model(row):
    """Locked rotation and stiffness factor 0.342, fitted to table 5 and the static test.

    Mean over ten seeds of a disturbed lattice: penetration -8.9 to +2.7 percent, peak force -4.9 to
    +4.6 percent.
    """
    penetration, force = errors(row, lattice_shift=1e-3, seed=1)
    assert abs(penetration) < 0.1
    assert abs(force) < 0.1


@pytest.mark.parametrize(
    ("modulus", "penetration_range", "force_range"),
    [
        (20, (-0.30, -0.12), (0.10, 0.30)),
        (40, (-0.14, 0.10), (-0.08, 0.24)),
        (60, (0.03, 0.25), (-0.12, 0.12)),
    ],
)
def test_literal_model_misses_the_trend(modulus, penetration_range, force_range):
    """Free rotation, no factor: discs roll aside, and the result hardly depends on E_bar; it is chaotic, so the ranges are wide.

    Measured: penetration -26, +2, +7 percent, peak force +24, +10, 0 percent; a lattice disturbed by 1e-3 diameters (three
    seeds) -20 to -18, -10 to -5, +15 to +17 and +15 to +19, -4 to +19, -8 to +6 percent.
    """
    penetration, force = errors(ROWS[modulus], **LITERAL)
    assert penetration_range[0] < penetration < penetration_range[1]
    assert force_range[0] < force < force_range[1]

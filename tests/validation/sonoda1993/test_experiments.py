"""Measured peaks of table 2 beside the computed ones: what the README's table says, so that it cannot go stale.

The calibrated sand was fitted to the paper's computation, not to these measurements, and misses them by as much as the paper does.
"""

import numpy as np
import pytest

from rockshed.bench.monolithic import from_system
from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as table_2
from rockshed.components.common.units import cm, kgf


def impact(number, **options):
    """The monolithic program of a test after 30 ms; its bits are those of the co-simulation."""
    system = lab_system({"rock": "", "sand": "", "beam": ""}, table_2()[number])
    system.components["sand"].parameters.update(options)
    program = from_system(system, stop_time=0.03)
    program.run()
    return program


def force_error(number, **options):
    """Relative error of the peak transmitted force against the load cell."""
    return (
        float(impact(number, **options).column("transmitted_force").max())
        / table_2()[number].peak_force
        - 1.0
    )


@pytest.mark.parametrize(("number", "error", "energy"), [(4, -0.22, 9.4), (10, -0.10, 21.2)])
def test_tests_4_and_10_beside_the_experiment(number, error, energy):
    """The paper's two figures: measured 519 and 673 kgf, about 13 and 40 kgf cm."""
    assert force_error(number) == pytest.approx(error, abs=0.02)
    assert impact(number).column("beam_energy").max() / (kgf * cm) == pytest.approx(
        energy, rel=0.05
    )


def test_mean_error_over_the_twelve_tests_of_box_1():
    """Somewhat less than that of the paper's own trend (25 percent); the constant mean of the measurements errs by 8.6 percent."""
    errors = [force_error(number) for number in range(1, 13)]
    assert np.mean(np.abs(errors)) == pytest.approx(0.21, abs=0.03)
    assert max(errors) < 0.0


def test_the_force_grows_with_the_modulus_like_the_measured_one_but_faster():
    """Exponent of P against the static stiffness k: measured 0.21; locked rotation overrates the influence of the sand."""
    numbers = range(1, 13)
    stiffness = np.log([table_2()[n].static_stiffness for n in numbers])
    measured = np.polyfit(stiffness, np.log([table_2()[n].peak_force for n in numbers]), 1)[0]
    computed = np.polyfit(
        stiffness, np.log([impact(n).column("transmitted_force").max() for n in numbers]), 1
    )[0]
    assert measured == pytest.approx(0.21, abs=0.01)
    assert measured < computed < 0.4

"""Energy residuals of runs against their true errors."""

import pytest

from rockshed.analyses.exchange_steps.figures import Level
from rockshed.bench.residuals import FIGURE, ResidualAndError, of_logarithms, pairs_of

SHARE = "largest_energy_residual_of_the_system_impact_energy"


def level(step, share, value):
    values = {SHARE: ("share", share, "1"), FIGURE: ("peak", value, "N")}
    return Level(step, {}, 1, share, None, values, {}, {}, 0.0)


def test_runs_are_compared_with_the_finest_one_and_the_same_value_has_no_logarithm():
    levels = [
        level(4.0, -0.2, 110.0),
        level(3.0, 0.1, 100.0),
        level(2.0, 0.05, 98.0),
        level(1.0, 0.01, 100.0),
    ]
    found = pairs_of("lab-impact", "jacobi", levels)
    assert [(pair.step, pair.residual) for pair in found] == [(4.0, 0.2), (2.0, 0.05)]
    assert [pair.error for pair in found] == pytest.approx([0.1, 0.02])


def test_errors_that_are_a_power_of_the_residual_are_wholly_correlated():
    found = [
        ResidualAndError("a", "jacobi", 1.0, share, 3.0 * share**2) for share in (0.1, 0.02, 0.003)
    ]
    assert of_logarithms(found) == pytest.approx(1.0)
    found.append(ResidualAndError("a", "jacobi", 1.0, 0.5, 1e-9))
    assert of_logarithms(found) < 0.5

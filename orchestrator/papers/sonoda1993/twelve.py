"""The twelve tests in the box that the paper compares (fig. 9): error and trend of forces."""

from collections.abc import Mapping, Sequence

from ...cases import sonoda1993
from ...cases.sonoda1993 import Test
from ..statistics import mean_absolute_error, power_law

BOX_TESTS = "tests 1 to 12"
_BOX = 1


def twelve() -> list[Test]:
    """Return the tests in the order of their numbers."""
    return [test for test in sonoda1993.tests().values() if test.box == _BOX]


def error(computed: Mapping[int, float], tests: Sequence[Test]) -> float:
    """Return the mean absolute error (%) of peak forces against the measured ones.

    Parameters
    ----------
    computed : mapping of int to float
        Forces (N) by the number of the test.
    tests : sequence of Test
        Tests over which the mean is taken.
    """
    return 100.0 * mean_absolute_error(
        [computed[test.number] for test in tests], [test.peak_force for test in tests]
    )


def exponent(forces: Mapping[int, float]) -> float:
    """Return the exponent of the force against the measured static stiffness, over twelve tests.

    Parameters
    ----------
    forces : mapping of int to float
        Forces (N) by the number of the test.
    """
    return power_law(
        [test.static_stiffness for test in twelve()], [forces[test.number] for test in twelve()]
    )[1]

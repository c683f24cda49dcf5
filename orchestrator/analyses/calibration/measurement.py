"""Measured static loading tests: spring constants, and load-penetration curves."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import cm, kgf, kN, mm, tf

from ...cases.sonoda1993 import tests
from ...metrics.load_curve import DEPTH

FORCES: Mapping[str, float] = {"N": 1.0, "kN": kN, "kgf": kgf, "tf": tf}
"""Units of force and their sizes (N)."""
LENGTHS: Mapping[str, float] = {"m": 1.0, "cm": cm, "mm": mm}
"""Units of length and their sizes (m)."""


@dataclass(frozen=True)
class Measurement:
    """Loads at rising penetrations; a spring constant is the one load at 4 cm.

    Attributes
    ----------
    name : str
        For tables and pictures.
    depth : array of float, shape (n,)
        Penetrations (m).
    load : array of float, shape (n,)
        Loads (N).
    printed : float or None
        Modulus E_bar (Pa) that a paper prints for this test.
    """

    name: str
    depth: NDArray[np.float64]
    load: NDArray[np.float64]
    printed: float | None = None

    @property
    def is_curve(self) -> bool:
        """Whether there is more than one point."""
        return self.depth.size > 1

    @property
    def stiffness(self) -> float:
        """Secant spring constant (N/m) at the deepest point."""
        return float(self.load[-1] / self.depth[-1])


def of_stiffness(stiffness: float, name: str = "", printed: float | None = None) -> Measurement:
    """Return the measurement of a secant spring constant at 4 cm.

    Parameters
    ----------
    stiffness : float
        Spring constant (N/m).
    name : str
        For tables and pictures; by default the spring constant.
    printed : float, optional
        Modulus E_bar (Pa) that a paper prints for this test.

    Returns
    -------
    Measurement
        With one point.
    """
    words = name or f"k = {stiffness / kN:g} kN/m"
    return Measurement(words, np.array([DEPTH]), np.array([stiffness * DEPTH]), printed)


def table_4() -> list[Measurement]:
    """Return the six tests of table 4 of Sonoda et al. 1993, with the E_bar printed there."""
    return [
        of_stiffness(test.static_stiffness, f"test {test.number}", test.modulus)
        for test in tests().values()
        if test.modulus_in_table_4
    ]

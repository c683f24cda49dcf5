"""Measured static loading tests: spring constants, and load-penetration curves."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import cm, kgf, kN, mm, tf

from ...cases.sonoda1993 import tests
from ...core.errors import InputRefused, Problem
from ...core.system.quantities import finite_number
from ...metrics.load_curve import DEPTH

FORCES: Mapping[str, float] = {"N": 1.0, "kN": kN, "kgf": kgf, "tf": tf}
"""Units of force and their sizes (N)."""
LENGTHS: Mapping[str, float] = {"m": 1.0, "cm": cm, "mm": mm}
"""Units of length and their sizes (m)."""
STIFFNESSES = {
    f"{force}/{length}": factor / size
    for force, factor in FORCES.items()
    for length, size in LENGTHS.items()
}
"""Units of spring constants and their sizes (N/m)."""
_NUMBER_AND_UNIT = re.compile(r"\s*(\S*?\d\.?)\s*([A-Za-z]+/[A-Za-z]+)?\s*")


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


def as_data(measurement: Any) -> Any:
    """Return measurements as plain data, anything else as it is.

    Parameters
    ----------
    measurement : Any
        Measurements, or what a calibration takes else.
    """
    listed = [measurement] if isinstance(measurement, Measurement) else measurement
    if not isinstance(listed, Sequence) or isinstance(listed, str):
        return listed
    return [{**vars(one), "depth": one.depth.tolist(), "load": one.load.tolist()} for one in listed]


def from_data(data: Any) -> Any:
    """Return what a calibration takes of what :func:`as_data` gives."""
    if not isinstance(data, list):
        return data
    return [
        Measurement(one["name"], np.array(one["depth"]), np.array(one["load"]), one["printed"])
        for one in data
    ]


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


def is_spring_constant(text: str) -> bool:
    """Return whether a text begins with a number, as a spring constant does and a file hardly.

    Parameters
    ----------
    text : str
        A spring constant with its unit, or the path of a file.
    """
    parts = _NUMBER_AND_UNIT.fullmatch(text)
    return parts is not None and finite_number(parts.group(1)) is not None


def of_text(text: str, where: str = "measurement") -> Measurement:
    """Return the measurement of a secant spring constant at 4 cm that is written with its unit.

    Parameters
    ----------
    text : str
        Number and unit: ``39.1 kgf/cm``.
    where : str
        Place of a problem.

    Returns
    -------
    Measurement
        With one point.

    Raises
    ------
    InputRefused
        No number, no or another unit, not above zero.
    """
    return of_stiffness(stiffness_from(text, where), f"k = {text}")


def stiffness_from(text: str, where: str = "measurement") -> float:
    """Read a spring constant.

    Parameters
    ----------
    text : str
        Number and unit: ``39.1 kgf/cm``.
    where : str
        Place of a problem.

    Returns
    -------
    float
        Spring constant (N/m).

    Raises
    ------
    InputRefused
        No number, no or another unit, not above zero.
    """
    parts = _NUMBER_AND_UNIT.fullmatch(text)
    value = finite_number(parts.group(1)) if parts else None
    remedy = f"write a number and one of {', '.join(STIFFNESSES)}: '39.1 kgf/cm'"
    if parts is None or value is None:
        fault = f"{text!r} is no spring constant"
    elif parts.group(2) not in STIFFNESSES:
        unit = f"the unit {parts.group(2)}" if parts.group(2) else "no unit"
        fault = f"{text!r} has {unit}"
    elif value <= 0.0:
        fault = f"{text!r} is not above zero"
        remedy = "give the measured spring constant"
    else:
        return value * STIFFNESSES[parts.group(2)]
    raise InputRefused([Problem(where, fault, remedy)])

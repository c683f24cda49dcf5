"""Units: conversion factors to SI for the edges of the program, and the units that ports may carry.

Inside, every quantity is a plain float in SI. ``120 * kgf / cm`` reads as it is written in the
papers.
"""

import math
from dataclasses import dataclass

mm = 1e-3
cm = 1e-2
cm2 = 1e-4
cm3 = 1e-6
cm4 = 1e-8
ms = 1e-3
us = 1e-6
standard_gravity = 9.80665
"""Standard acceleration of gravity (m/s2)."""
kgf = standard_gravity
"""Newton per kilogram-force. Sonoda et al. (1993) round it to 9.8."""
tf = 1e3 * kgf
tonne = 1e3
kN = 1e3
kJ = 1e3
MPa = 1e6
deg = math.pi / 180.0


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as FMI describes it: exponents of the SI base units, and the quantity that carries it.

    ``factor`` converts a value in this unit to the base units.
    """

    quantity: str
    base: dict[str, int]
    factor: float = 1.0


UNITS: dict[str, Unit] = {
    "1": Unit("Dimensionless", {}),
    "s": Unit("Time", {"s": 1}),
    "1/s": Unit("Rate", {"s": -1}),
    "m": Unit("Length", {"m": 1}),
    "m2": Unit("Area", {"m": 2}),
    "m3": Unit("Volume", {"m": 3}),
    "m4": Unit("SecondMomentOfArea", {"m": 4}),
    "m/s": Unit("Velocity", {"m": 1, "s": -1}),
    "m/s2": Unit("Acceleration", {"m": 1, "s": -2}),
    "1/m": Unit("Curvature", {"m": -1}),
    "s/m": Unit("Slowness", {"s": 1, "m": -1}),
    "rad": Unit("Angle", {"rad": 1}),
    "rad/s": Unit("AngularVelocity", {"rad": 1, "s": -1}),
    "kg": Unit("Mass", {"kg": 1}),
    "kg/m": Unit("MassPerLength", {"kg": 1, "m": -1}),
    "kg.m2": Unit("MomentOfInertia", {"kg": 1, "m": 2}),
    "kg/m3": Unit("Density", {"kg": 1, "m": -3}),
    "N": Unit("Force", {"kg": 1, "m": 1, "s": -2}),
    "N/m": Unit("Stiffness", {"kg": 1, "s": -2}),
    "N/m3": Unit("ForcePerVolume", {"kg": 1, "m": -2, "s": -2}),
    "N.s": Unit("Impulse", {"kg": 1, "m": 1, "s": -1}),
    "N.s/m": Unit("Impedance", {"kg": 1, "s": -1}),
    "N.m": Unit("Torque", {"kg": 1, "m": 2, "s": -2}),
    "J": Unit("Energy", {"kg": 1, "m": 2, "s": -2}),
    "Pa": Unit("Pressure", {"kg": 1, "m": -1, "s": -2}),
}
"""The units that a port may name. A port with another unit is refused when it is declared."""

SCREEN_UNITS: dict[str, float] = {
    "1": 1.0,
    "%": 0.01,
    "s": 1.0,
    "ms": ms,
    "Hz": 1.0,
    "m": 1.0,
    "cm": cm,
    "mm": mm,
    "m/s": 1.0,
    "rad": 1.0,
    "deg": deg,
    "kg": 1.0,
    "N": 1.0,
    "kN": kN,
    "kgf": kgf,
    "N s": 1.0,
    "N m": 1.0,
    "kN m": kN,
    "N/m": 1.0,
    "kN/m": kN,
    "kgf/cm": kgf / cm,
    "Pa": 1.0,
    "kPa": 1e3,
    "MPa": MPa,
    "J": 1.0,
    "kJ": kJ,
    "kgf cm": kgf * cm,
}
"""Units in which tables and pictures show values, with their size in SI."""


def range_in_words(minimum: float | None, maximum: float | None, unit: str = "1") -> str:
    """Return an allowed range in words.

    Parameters
    ----------
    minimum, maximum : float, optional
        Ends of the range, included; None where there is no bound.
    unit : str
        Unit of both; ``1`` for none.

    Returns
    -------
    str
        ``0 m or more``, ``1 m or less``, ``0 to 1 m``; empty where there is no bound.
    """
    suffix = "" if unit == "1" else f" {unit}"
    if minimum is None:
        return "" if maximum is None else f"{maximum:g}{suffix} or less"
    if maximum is None:
        return f"{minimum:g}{suffix} or more"
    return f"{minimum:g} to {maximum:g}{suffix}"

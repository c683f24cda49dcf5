"""Hertz: a rigid sphere on an elastic half-space."""

import math
from collections.abc import Iterator

from .estimate import FORCE, PENETRATION, FormulaValue
from .rock_impact import LAME, RockImpact

POISSON = 0.25
"""Poisson's ratio nu with which the handbook's formula is the one of Hertz."""
_SOURCE = "H. Hertz, J. reine angew. Math. 92 (1882) 156-171; E = λ (1 + ν)(1 - 2ν) / ν"
_VALIDITY = "linear elasticity, small penetration against the radius, no floor under the layer"


def hertz_stiffness(radius: float, lame: float = LAME, poisson: float = POISSON) -> float:
    """Return K in P = K d^(3/2): K = 4/3 E / (1 - nu^2) sqrt(R).

    Parameters
    ----------
    radius : float
        Of the rigid sphere (m).
    lame : float
        Lame constant lambda of the half-space (Pa), E = lambda (1 + nu)(1 - 2 nu) / nu.
    poisson : float
        Poisson's ratio nu.

    Returns
    -------
    float
        In N / m^(3/2).
    """
    modulus = lame * (1.0 + poisson) * (1.0 - 2.0 * poisson) / poisson
    return 4.0 / 3.0 * modulus / (1.0 - poisson**2) * math.sqrt(radius)


def hertz_force(
    mass: float, radius: float, speed: float, lame: float = LAME, poisson: float = POISSON
) -> float:
    """Return the largest force on a rigid sphere that strikes an elastic half-space.

    P = K^(2/5) (5/4 m v^2)^(3/5), from P = K d^(3/2) and 2/5 K d^(5/2) = m v^2 / 2.

    Parameters
    ----------
    mass, radius, speed : float
        Of the sphere (kg, m, m/s).
    lame : float
        Lame constant lambda (Pa).
    poisson : float
        Poisson's ratio nu.

    Returns
    -------
    float
        Force (N).
    """
    stiffness = hertz_stiffness(radius, lame, poisson)
    return float(stiffness**0.4 * (1.25 * mass * speed**2) ** 0.6)


def hertz(impact: RockImpact) -> Iterator[FormulaValue]:
    """Yield force and penetration.

    Parameters
    ----------
    impact : RockImpact
        The impact.
    """
    force = hertz_force(impact.mass, impact.radius, impact.speed, impact.lame)
    depth = (force / hertz_stiffness(impact.radius, impact.lame)) ** (2.0 / 3.0)
    small = depth < 0.1 * impact.radius
    remark = f"λ = {impact.lame / 1e3:g} kN/m², ν = {POISSON}; the closed form is tested"
    yield FormulaValue("Hertz", FORCE, force, "N", _SOURCE, True, small, _VALIDITY, remark)
    yield FormulaValue("Hertz", PENETRATION, depth, "m", _SOURCE, True, small, _VALIDITY, remark)

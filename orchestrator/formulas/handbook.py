"""Japanese rockfall handbook (Japan Road Association): force on a rock that falls on sand."""

import math
from collections.abc import Iterator

from rockshed.components.common.units import kgf, kN

from .estimate import FORCE, FormulaValue
from .rock_impact import LAME, RockImpact

_NAME = "Japanese handbook"
_SOURCE = "Japan Road Association, Handbook of rockfall countermeasures (落石対策便覧)"
_FACTOR_SOURCE = f"{_SOURCE}, edition of 2000"
_VALIDITY = "sand cushions of about 0.9 m, and no thinner than the rock's diameter"
_FACTOR_VALIDITY = "sand cushions of about 0.9 m; rocks of any diameter against the thickness"


def handbook_force(mass: float, height: float, lame: float = LAME) -> float:
    """Return the impact force on a rock by the Japanese rockfall handbook.

    P = 2.108 (m g)^(2/3) lambda^(2/5) H^(3/5), with weight and force in kN and lambda in kN/m2.
    It is Hertz's solution for a sphere of ordinary rock on a half-space with Poisson's ratio 0.25.

    Parameters
    ----------
    mass : float
        Of the rock (kg).
    height : float
        Of its fall (m).
    lame : float
        Lame constant lambda of the sand (Pa).

    Returns
    -------
    float
        Force (N).
    """
    return 2.108 * (mass * kgf / kN) ** (2 / 3) * (lame / kN) ** 0.4 * height**0.6 * kN


def thickness_factor(diameter: float, thickness: float) -> float:
    """Return the factor alpha on the force where the rock is large against the cushion.

    Parameters
    ----------
    diameter, thickness : float
        Of the rock and of the cushion (m).

    Returns
    -------
    float
        (D / T)^(1/2), and 1 where the cushion is thicker than the rock.
    """
    return max(1.0, math.sqrt(diameter / thickness))


def handbook(impact: RockImpact) -> Iterator[FormulaValue]:
    """Yield the force without and, where the thickness is known, with the thickness factor.

    Parameters
    ----------
    impact : RockImpact
        The impact.
    """
    force = handbook_force(impact.mass, impact.drop_height, impact.lame)
    used = f"λ = {impact.lame / kN:g} kN/m²"
    diameter, thickness = 2.0 * impact.radius, impact.thickness
    covers = None if thickness is None else diameter <= thickness
    tabled = f"{used}; reproduces a printed table of forces within 0.2 %"
    yield FormulaValue(_NAME, FORCE, force, "N", _SOURCE, True, covers, _VALIDITY, tabled)
    if thickness is None:
        return
    factor = thickness_factor(diameter, thickness)
    remark = f"{used}, α = (D/T)^½ = {factor:.3f}, 1 for D < T; the handbook could not be read"
    yield FormulaValue(
        f"{_NAME}, thickness factor",
        FORCE,
        factor * force,
        "N",
        _FACTOR_SOURCE,
        verified=False,
        within_range=None,
        validity=_FACTOR_VALIDITY,
        remark=remark,
    )

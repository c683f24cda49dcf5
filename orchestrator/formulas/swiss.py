"""Swiss formulas: Labiouse et al. (1996), and the guideline ASTRA 12 006 (2008) for galleries."""

import math
from collections.abc import Iterator

from rockshed.components.common.units import deg, kgf, kN, tonne

from .estimate import FORCE, PENETRATION, THICKNESS, FormulaValue
from .rock_impact import RockImpact

_ASTRA = "ASTRA 2008"
_ASTRA_SOURCE = (
    "ASTRA 12 006, Einwirkungen infolge Steinschlags auf Schutzgalerien, edition 2008 V2.03"
)
_ASTRA_VALIDITY = "cushions of 0.5 m or more, and twice the penetration"
_LEAST_COVER = 0.5
_LABIOUSE_SOURCE = (
    "V. Labiouse, F. Descoeudres, S. Montani, Structural Engineering International 6 (1996) 171-176"
)
_LABIOUSE_VALIDITY = "tests with 0.1 to 1 t from 0.25 to 10 m on 0.35 to 1 m of soil on a slab"
_NOT_READ = "written down from memory, the text of the source could not be read"


def astra_force(impact: RockImpact, thickness: float) -> float:
    """Return the force on the rock by ASTRA 12 006.

    F = 2.8 e^(-1/2) r^0.7 M_E^0.4 tan(phi) (m v^2 / 2)^0.6 with kN, m, t and m/s.

    Parameters
    ----------
    impact : RockImpact
        The impact.
    thickness : float
        Of the cushion, e (m).

    Returns
    -------
    float
        Force (N).
    """
    soil = (impact.modulus / kN) ** 0.4 * math.tan(impact.friction_angle)
    energy = 0.5 * impact.mass / tonne * impact.speed**2
    return 2.8 * thickness**-0.5 * impact.radius**0.7 * soil * energy**0.6 * kN


def astra(impact: RockImpact) -> Iterator[FormulaValue]:
    """Yield force, penetration and least thickness; nothing where the thickness is not known.

    Penetration d = m v^2 / F: the energy of a force that rises in proportion to it. The cushion
    has to be twice as thick, and 0.5 m.

    Parameters
    ----------
    impact : RockImpact
        The impact.
    """
    if impact.thickness is None:
        return
    force = astra_force(impact, impact.thickness)
    depth = 2.0 * impact.energy / force if force else 0.0
    least = max(2.0 * depth, _LEAST_COVER)
    covers = impact.thickness >= least
    soil = f"M_E = {impact.modulus / kN:g} kN/m², φ = {impact.friction_angle / deg:g}°"
    for quantity, value, unit in (
        (FORCE, force, "N"),
        (PENETRATION, depth, "m"),
        (THICKNESS, least, "m"),
    ):
        yield FormulaValue(
            _ASTRA,
            quantity,
            value,
            unit,
            _ASTRA_SOURCE,
            verified=False,
            within_range=covers,
            validity=_ASTRA_VALIDITY,
            remark=f"{soil}; {_NOT_READ}",
        )


def labiouse_force(impact: RockImpact) -> float:
    """Return the force on the rock by Labiouse et al. (1996).

    P = 1.765 M_E^(2/5) R^(1/5) (W H)^(3/5) with kN and m, W the weight of the rock.

    Parameters
    ----------
    impact : RockImpact
        The impact.

    Returns
    -------
    float
        Force (N).
    """
    work = impact.mass * kgf / kN * impact.drop_height
    return float(1.765 * (impact.modulus / kN) ** 0.4 * impact.radius**0.2 * work**0.6 * kN)


def labiouse(impact: RockImpact) -> Iterator[FormulaValue]:
    """Yield the force.

    Parameters
    ----------
    impact : RockImpact
        The impact.
    """
    tested = 100.0 <= impact.mass <= 1000.0 and 0.25 <= impact.drop_height <= 10.5
    thick = impact.thickness is None or 0.35 <= impact.thickness <= 1.0
    remark = f"M_E = {impact.modulus / kN:g} kN/m²; {_NOT_READ}"
    yield FormulaValue(
        "Labiouse 1996",
        FORCE,
        labiouse_force(impact),
        "N",
        _LABIOUSE_SOURCE,
        verified=False,
        within_range=tested and thick,
        validity=_LABIOUSE_VALIDITY,
        remark=remark,
    )

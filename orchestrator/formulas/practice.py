"""All formulas of practice for one impact."""

import math

from .estimate import FormulaValue
from .handbook import handbook
from .hertz import hertz
from .rock_impact import RockImpact
from .swiss import astra, labiouse

_FORMULAS = (handbook, astra, labiouse, hertz)


def estimates(impact: RockImpact) -> list[FormulaValue]:
    """Return what the formulas of practice give for a impact.

    Parameters
    ----------
    impact : RockImpact
        The impact.

    Returns
    -------
    list of FormulaValue
        Forces, penetrations and thicknesses, formula by formula.

    Raises
    ------
    ValueError
        A value of the impact is not a positive finite number, where only the speed may be 0; or the
        angle of friction is not below a right angle.
    """
    for name, value in vars(impact).items():
        least = value is not None and (value >= 0.0 if name == "speed" else value > 0.0)
        if value is not None and not (least and math.isfinite(value)):
            raise ValueError(f"{name} must be a positive finite number (given: {value:g})")
    if impact.friction_angle >= 0.5 * math.pi:
        raise ValueError(f"friction_angle must be below pi/2 (given: {impact.friction_angle:g})")
    return [estimate for formula in _FORMULAS for estimate in formula(impact)]

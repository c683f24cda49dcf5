"""All formulas of practice for one blow."""

import math

from .blow import Blow
from .estimate import Estimate
from .handbook import handbook
from .hertz import hertz
from .swiss import astra, labiouse

_FORMULAS = (handbook, astra, labiouse, hertz)


def estimates(blow: Blow) -> list[Estimate]:
    """Return what the formulas of practice give for a blow.

    Parameters
    ----------
    blow : Blow
        The blow.

    Returns
    -------
    list of Estimate
        Forces, penetrations and thicknesses, formula by formula.

    Raises
    ------
    ValueError
        A value of the blow is not a positive finite number, where only the speed may be 0; or the
        angle of friction is not below a right angle.
    """
    for name, value in vars(blow).items():
        least = value is not None and (value >= 0.0 if name == "speed" else value > 0.0)
        if value is not None and not (least and math.isfinite(value)):
            raise ValueError(f"{name} must be a positive finite number (given: {value:g})")
    if blow.friction_angle >= 0.5 * math.pi:
        raise ValueError(f"friction_angle must be below pi/2 (given: {blow.friction_angle:g})")
    return [estimate for formula in _FORMULAS for estimate in formula(blow)]

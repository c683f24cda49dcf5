"""A shed in words, from its values: for titles and captions."""

import math

from ..words import length_in_words, mass_in_words
from .geometry import CushionPart, RockPart, RoofPart, ShedLayout


def in_words(shed: ShedLayout) -> str:
    """Return a shed in a line.

    Parameters
    ----------
    shed : ShedLayout
        The shed.

    Returns
    -------
    str
        ``2.5 t from 25 m on 1.2 m of compacted sand on girders H-400x400x13x21, 1.5 m apart, span
        9 m``.
    """
    cushion = cushion_in_words(shed.cushion)
    return f"{rock_in_words(shed.rock)} on {cushion} on {roof_in_words(shed.roof)}"


def rock_in_words(rock: RockPart) -> str:
    """Return mass and fall of a rock, or its velocity where it comes in obliquely."""
    if rock.velocity_x == 0.0:
        return f"{mass_in_words(rock.mass)} from {rock.drop_height:.3g} m"
    angle = math.degrees(math.atan2(rock.velocity_x, rock.velocity_y))
    return f"{mass_in_words(rock.mass)} at {rock.speed:.3g} m/s, {angle:.3g}° from the vertical,"


def cushion_in_words(cushion: CushionPart) -> str:
    """Return thickness and material of a cushion."""
    return f"{length_in_words(cushion.thickness)} of {cushion.material}"


def roof_in_words(roof: RoofPart) -> str:
    """Return section and span of a roof."""
    if roof.kind == "concrete":
        return f"a {roof.section}, span {roof.span:.3g} m"
    return f"girders {roof.section}, {roof.spacing:.3g} m apart, span {roof.span:.3g} m"

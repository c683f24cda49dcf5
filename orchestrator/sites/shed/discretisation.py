"""Discs that fill a layer of sand, and the elements of a beam below them."""

import math

from rockshed.components.sand_cushion.models import SPREAD


def discs_in(width: float, height: float, radius: float, solid_fraction: float) -> int:
    """Return the number of discs of many sizes that fill a layer.

    The mean of r^2 is r^2 (1 + spread^2 / 3).

    Parameters
    ----------
    width, height : float
        Of the layer (m).
    radius : float
        Mean radius of the discs (m).
    solid_fraction : float
        Part of the layer that they fill.

    Returns
    -------
    int
    """
    return round(solid_fraction * width * height / (math.pi * radius**2 * (1.0 + SPREAD**2 / 3.0)))


def element_length(span: float, elements: int) -> float:
    """Return the length of a beam element, which is the diameter of its disc (m)."""
    return span / elements


def axis_below_top(span: float, elements: int) -> float:
    """Return y of the axis of a beam whose top is y = 0 (m)."""
    return -0.5 * element_length(span, elements)

"""Contact of an elongated block: an ellipse on a plane."""

import math

from ..common.kernels import kernel


@kernel
def ellipse_contact(radius, elongation, angle):
    """Return how far the contact point of an ellipse lies from its centre, and on which side.

    The point of the ellipse that lies farthest in a direction follows from its support function.

    Parameters
    ----------
    radius : float
        sqrt(a b) of the semi-axes a and b (m).
    elongation : float
        a / b, 1 or more.
    angle : float
        Of the long axis, counter-clockwise from the plane's direction to the right (rad).

    Returns
    -------
    tuple of float
        Distance (m), and angle (rad) at the centre from the plane's normal to the contact point,
        positive if the point lies to the right.
    """
    s, c = math.sin(angle), math.cos(angle)
    square = elongation * s * s + c * c / elongation
    height = radius * math.sqrt(square)
    offset = -radius * (elongation - 1.0 / elongation) * s * c / math.sqrt(square)
    return math.sqrt(height * height + offset * offset), math.atan2(offset, height)

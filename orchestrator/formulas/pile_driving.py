"""Dynamic formulas of pile driving: Hiley, and Gates as the FHWA has changed it."""

import math
from dataclasses import dataclass

HILEY_SOURCE = (
    "A. Hiley 1925, as in textbooks (C. Venkatramaiah, Geotechnical Engineering, eq. 16.23)"
)
"""Source of :func:`hiley`."""
GATES_SOURCE = "FHWA HI 97-014 (1998): R_u = 7 sqrt(E_r) log10(10 N_b) - 550 in kN, J and 25 mm"
"""Source of :func:`gates`."""
_INCH = 25e-3
"""Way (m) for which Gates' formula counts blows."""


@dataclass(frozen=True)
class Stroke:
    """A blow as dynamic formulas see it.

    Attributes
    ----------
    rated_energy : float
        E_r (J).
    efficiency : float
        Part of it that the ram has.
    ram, pile : float
        Masses (kg) of the ram, and of the rod with helmet and anvil.
    restitution : float
        e, between ram and pile.
    compliance : float
        Shortening of rod and cushions under a unit force at the toe (m/N).
    quake : float
        Temporary compression of the ground (m).
    """

    rated_energy: float
    efficiency: float
    ram: float
    pile: float
    restitution: float
    compliance: float
    quake: float


def hiley(stroke: Stroke, permanent: float) -> float:
    """Return the ultimate resistance by Hiley's formula.

    R (s + C/2) = eta E_r (W + e^2 P) / (W + P), with the temporary compression C = R c + Q: of rod
    and cushions in proportion to R, of the ground the quake Q. The equation is of second degree.

    Parameters
    ----------
    stroke : Stroke
        The blow.
    permanent : float
        Set s (m); 0 at refusal.

    Returns
    -------
    float
        R (N).
    """
    both = stroke.ram + stroke.pile
    kept = (stroke.ram + stroke.restitution**2 * stroke.pile) / both
    energy = stroke.efficiency * stroke.rated_energy * kept
    way = permanent + 0.5 * stroke.quake
    root = math.sqrt(way * way + 2.0 * stroke.compliance * energy)
    return 2.0 * energy / (way + root)


def gates(stroke: Stroke, permanent: float) -> float:
    """Return the ultimate resistance by Gates' formula as the FHWA has changed it.

    R_u = 7 sqrt(E_r) log10(10 N_b) - 550, with R_u in kN, E_r in J, N_b blows per 25 mm.

    Parameters
    ----------
    stroke : Stroke
        The blow, of which the rated energy counts alone.
    permanent : float
        Set (m), more than 0.

    Returns
    -------
    float
        R_u (N); 0 where the formula gives less.
    """
    counted = _INCH / permanent
    force = 7.0 * math.sqrt(stroke.rated_energy) * math.log10(10.0 * counted) - 550.0
    return max(0.0, 1e3 * force)

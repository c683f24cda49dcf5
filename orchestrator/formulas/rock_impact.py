"""A rock that strikes a cushion, as formulas of practice know it."""

import math
from dataclasses import dataclass

from rockshed.components.common.units import deg, standard_gravity

LAME = 1e6
"""Lame constant lambda of sand (Pa) that the Japanese handbook recommends: 1000 kN/m2."""
MODULUS = 3e6
"""Modulus M_E of the cushion from a plate loading test (Pa), assumed: loosely placed material."""
FRICTION_ANGLE = 35.0 * deg
"""Angle of friction of the cushion (rad), assumed."""
ROCK_DENSITY = 2600.0
"""Density of rock (kg/m3) where nothing says how large a rock of known mass is, assumed."""


@dataclass(frozen=True)
class RockImpact:
    """A rock that strikes a cushion, perpendicular to its surface.

    Attributes
    ----------
    mass, radius, speed : float
        Of the rock (kg, m, m/s): a sphere, at the moment of contact.
    thickness : float, optional
        Of the cushion (m); formulas that need it are left out without it.
    lame : float
        Lame constant lambda of the cushion (Pa).
    modulus : float
        Modulus M_E of the cushion from a plate loading test (Pa).
    friction_angle : float
        Of the cushion (rad).
    """

    mass: float
    radius: float
    speed: float
    thickness: float | None = None
    lame: float = LAME
    modulus: float = MODULUS
    friction_angle: float = FRICTION_ANGLE

    @classmethod
    def fallen(
        cls, mass: float, radius: float, height: float, **others: float | None
    ) -> "RockImpact":
        """Return the impact of a rock that has fallen freely.

        Parameters
        ----------
        mass, radius : float
            Of the rock (kg, m).
        height : float
            Of its fall (m).
        **others : float
            Attributes of the cushion.
        """
        return cls(mass, radius, math.sqrt(2.0 * standard_gravity * height), **others)  # type: ignore[arg-type]

    @property
    def drop_height(self) -> float:
        """Height of free fall with the same speed (m)."""
        return self.speed**2 / (2.0 * standard_gravity)

    @property
    def energy(self) -> float:
        """Kinetic energy of the rock at contact (J)."""
        return 0.5 * self.mass * self.speed**2


def radius_of(mass: float, density: float = ROCK_DENSITY) -> float:
    """Return the radius of a sphere.

    Parameters
    ----------
    mass, density : float
        In kg and kg/m3.

    Returns
    -------
    float
        In m.
    """
    return float((3.0 * mass / (4.0 * math.pi * density)) ** (1.0 / 3.0))

"""The paper's 96 tests: four plates, four weights, six drops.

Plate masses and the sand's density are assumed, as they are not printed.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from rockshed.components.common.units import cm, cm2
from rockshed.components.impulsive_ground.settlement import DERIVED, drop_impulse, soil_mass

AREAS = (100.0, 200.0, 300.0, 400.0)
"""Areas of the plates (cm2)."""
WEIGHTS = (4.65, 9.75, 14.70, 20.40)
"""Masses of the steel cylinders (kg)."""
DROPS = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
"""Heights of fall (cm)."""
DEPTH = 45 * cm
"""Depth (m) to which the sand moves."""
SPREAD = math.radians(45.0)
"""Angle (rad) of the frustum of sand that moves."""
BOX = (35 * cm, 145 * cm, 45 * cm)
"""Width, length and depth (m) of the box."""
DENSITY = 1600.0
"""Density of the sand (kg/m3), assumed."""
PLATE = 157.0
"""Mass of a plate by its area (kg/m2): steel of 2 cm, assumed."""
MIDDLE = (14.70, 30.0)
"""Mass (kg) and drop (cm) of the test that stands for the others where one is shown."""


@dataclass(frozen=True)
class PlateTest:
    """Weight that falls on a plate.

    Attributes
    ----------
    area : float
        Area of the plate (cm2).
    weight : float
        Mass of the cylinder (kg).
    drop : float
        Height of fall (cm).
    """

    area: float
    weight: float
    drop: float

    @property
    def impulse(self) -> float:
        """I (N s), of a weight that stays on the plate."""
        return drop_impulse(self.weight, self.drop * cm)


def plate_tests() -> Iterator[PlateTest]:
    """Yield all 96 tests of the paper."""
    return (PlateTest(area, weight, drop) for area in AREAS for weight in WEIGHTS for drop in DROPS)


def radius(area: float) -> float:
    """Return the radius (m) of a plate from its area (cm2)."""
    return math.sqrt(area * cm2 / math.pi)


def mass(area: float, weight: float, form: int = DERIVED) -> float:
    """Return M (kg), the bracket of (1): falling body, plate and virtual mass of the sand.

    Parameters
    ----------
    area : float
        Area of the plate (cm2).
    weight : float
        Mass of the body that fell on it and stays there (kg).
    form : int
        Number before r2: derived or printed.
    """
    return weight + PLATE * area * cm2 + sand_mass(area, form)


def sand_mass(area: float, form: int = DERIVED) -> float:
    """Return the virtual mass (kg) of the sand under a plate.

    Parameters
    ----------
    area : float
        Area of the plate (cm2).
    form : int
        Number before r2: derived or printed.
    """
    return float(soil_mass(radius(area), DEPTH, SPREAD, DENSITY, form))

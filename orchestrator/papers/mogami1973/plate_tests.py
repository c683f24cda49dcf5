"""The paper's 96 tests: four plates, four weights, six drops. Plate masses and the sand's density are assumed, not printed."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from rockshed.components.common.units import cm, cm2
from rockshed.components.impulsive_ground.settlement import DERIVED, drop_impulse, soil_mass

AREAS = (100.0, 200.0, 300.0, 400.0)
"""Of the plates (cm2)."""
WEIGHTS = (4.65, 9.75, 14.70, 20.40)
"""Of the steel cylinders (kg)."""
DROPS = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
"""Heights of fall (cm)."""
DEPTH, SPREAD = 45 * cm, math.radians(45.0)
BOX = (35 * cm, 145 * cm, 45 * cm)
DENSITY = 1600.0
"""Of the sand (kg/m3), assumed."""
PLATE = 157.0
"""Mass of a plate by its area (kg/m2): steel of 2 cm, assumed."""
MIDDLE = (14.70, 30.0)
"""Weight (kg) and drop (cm) of the test that stands for the others where one is shown."""


@dataclass(frozen=True)
class Trial:
    """A weight (kg) that falls from a height (cm) on a plate (cm2)."""

    area: float
    weight: float
    drop: float

    @property
    def impulse(self) -> float:
        """I (N s), of a weight that stays on the plate."""
        return drop_impulse(self.weight, self.drop * cm)


def trials() -> Iterator[Trial]:
    """All 96."""
    return (Trial(area, weight, drop) for area in AREAS for weight in WEIGHTS for drop in DROPS)


def radius(area: float) -> float:
    """Radius (m) of a plate of so many cm2."""
    return math.sqrt(area * cm2 / math.pi)


def mass(area: float, form: int = DERIVED) -> float:
    """M (kg), the bracket of (1), of a plate of so many cm2."""
    return PLATE * area * cm2 + float(soil_mass(radius(area), DEPTH, SPREAD, DENSITY, form))

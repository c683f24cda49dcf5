"""Grades of structural steel: yield stress by thickness of the flange."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

DEFAULT_STEEL = "SS400"


@dataclass(frozen=True)
class Steel:
    """A grade of steel.

    Attributes
    ----------
    source : str
        The standard.
    thickness, yield_stress : tuple of float
        Up to which thickness (m) each of the yield stresses (Pa) holds.
    elastic_modulus, density : float
        Young's modulus (Pa), density (kg/m3).
    """

    source: str
    thickness: tuple[float, ...]
    yield_stress: tuple[float, ...]
    elastic_modulus: float
    density: float

    def yield_at(self, thickness: float) -> float | None:
        """Return the yield stress (Pa) of a part of this thickness (m); None if it is too thick."""
        classes = zip(self.thickness, self.yield_stress)
        return next((stress for most, stress in classes if thickness <= most * (1.0 + 1e-9)), None)


@cache
def steels() -> Mapping[str, Steel]:
    """Return the grades of the table ``steels.toml`` by name."""
    data = tomllib.loads((Path(__file__).parent / "steels.toml").read_text(encoding="utf-8"))
    return {
        name: Steel(
            entry["source"],
            tuple(entry["thickness"]),
            tuple(entry["yield_stress"]),
            entry["elastic_modulus"],
            entry["density"],
        )
        for name, entry in data.items()
    }

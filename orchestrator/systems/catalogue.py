"""All impact systems by name."""

from collections.abc import Sequence
from importlib import import_module

from ..core.errors import InputRefused, Problem
from .system import ImpactSystem

_FOLDERS = (
    "hammer_on_rod",
    "two_rates",
    "bouncing_ball",
    "stiff_contact",
    "ball_on_beam",
    "sand_on_beam",
    "algebraic_loop",
    "terminals",
)

NAMES = tuple(folder.replace("_", "-") for folder in _FOLDERS)
"""Names of all systems."""


def impact_system(name: str) -> ImpactSystem:
    """Return the system of a name; only its folder is imported."""
    module = import_module(f".{name.replace('-', '_')}", __package__)
    system: ImpactSystem = module.SYSTEM
    return system


def impact_systems(names: Sequence[str] = ()) -> list[ImpactSystem]:
    """Return the systems of some names, or all.

    Raises
    ------
    InputRefused
        Names that no system has.
    """
    problems = [
        Problem(name, "is no impact system", f"choose of {', '.join(NAMES)}")
        for name in names
        if name not in NAMES
    ]
    if problems:
        raise InputRefused(problems)
    return [impact_system(name) for name in NAMES if not names or name in names]

"""All components by the name of their FMU."""

from importlib import import_module

from .common.component import Component

_FOLDERS = {
    "FallingRock": "falling_rock",
    "SandCushion": "sand_cushion",
    "RBSMBeam": "rbsm_beam",
    "SlopeRockfall": "slope_rockfall",
    "ImpulsiveGround": "impulsive_ground",
    "Hammer": "hammer",
    "PileRod": "pile_rod",
}

NAMES = tuple(_FOLDERS)
"""Names of all components."""


def component(name: str) -> Component:
    """The component of this name. Only its folder is imported.

    Raises:
        KeyError: no component has this name.
    """
    if name not in _FOLDERS:
        raise KeyError(f"there is no component {name!r}; there are {', '.join(NAMES)}")
    chosen = import_module(f".{_FOLDERS[name]}", __package__).COMPONENT
    assert isinstance(chosen, Component)
    return chosen

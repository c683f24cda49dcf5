"""All components by the name of their FMU, and components in folders of others."""

import hashlib
import sys
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

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
    """Return the component of a name. Only its folder is imported.

    Parameters
    ----------
    name : str
        One of :data:`NAMES`.

    Returns
    -------
    Component
        The component.

    Raises
    ------
    KeyError
        No component has this name.
    """
    if name not in _FOLDERS:
        raise KeyError(f"there is no component {name!r}; there are {', '.join(NAMES)}")
    return _component_of(import_module(f".{_FOLDERS[name]}", __package__))


def component_in(folder: Path) -> Component:
    """Return the component in a folder that need not be on Python's path.

    Its modules import one another relatively and the shared ones absolutely:
    ``from rockshed.components.common.ports import Layout, inp, out``.

    Parameters
    ----------
    folder : Path
        A package whose ``__init__.py`` defines ``COMPONENT``.

    Returns
    -------
    Component
        The component.

    Raises
    ------
    ImportError
        The folder is no such package.
    """
    folder = Path(folder).resolve()
    tag = hashlib.sha256(str(folder).encode()).hexdigest()[:8]
    return load(folder, f"{__package__}.{folder.name}_{tag}")


def load(folder: Path, name: str) -> Component:
    """Import the component in a folder as a module of this name, or return it if it has been.

    Parameters
    ----------
    folder : Path
        A package whose ``__init__.py`` defines ``COMPONENT``.
    name : str
        Name in :data:`sys.modules`.

    Returns
    -------
    Component
        The component.

    Raises
    ------
    ImportError
        The folder is no such package.
    """
    if name not in sys.modules:
        file = folder / "__init__.py"
        spec = spec_from_file_location(name, file, submodule_search_locations=[str(folder)])
        if spec is None or spec.loader is None or not file.is_file():
            raise ImportError(f"{folder} is no Python package: it has no __init__.py")
        sys.modules[name] = module = module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[name]
            raise
    return _component_of(sys.modules[name])


def _component_of(module: ModuleType) -> Component:
    found = getattr(module, "COMPONENT", None)
    if not isinstance(found, Component):
        raise ImportError(f"{module.__file__} defines no COMPONENT")
    return found

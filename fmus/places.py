"""Where built FMUs lie, and whether a native one is what would be built now.

Nothing is imported for it that builds or compiles.
"""

import os
import re
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

from platformdirs import user_data_path

from rockshed.components.common.component import Component
from rockshed.components.common.kept import folder_problem

from .native.fmu import own_binary, stamp
from .parts import DESCRIPTION, BuildError, Fmi, Runtime

__all__ = [
    "FOLDER_VARIABLE",
    "Fmi",
    "Runtime",
    "file_name",
    "fmu_file",
    "fmu_folder",
    "folder_name",
    "native_is_fresh",
]

FOLDER_VARIABLE = "ROCKSHED_FMU_DIR"
"""Environment variable that names the folder of built FMUs; by default it is ``fmus`` in the
user's data folder. In it are ``python``, ``native`` and ``native-fmi3``."""


_UNREADABLE = (OSError, LookupError, ValueError, RuntimeError, zipfile.BadZipFile, zlib.error)
"""Errors that the reader of an archive ends in that is damaged."""


def fmu_folder(runtime: Runtime = Runtime.PYTHON, fmi: Fmi = Fmi.TWO) -> Path:
    """Return the folder of built FMUs of a runtime and version of FMI.

    Parameters
    ----------
    runtime : Runtime
        With Python or native.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    Path
        The folder, there or not.
    """
    chosen = os.environ.get(FOLDER_VARIABLE)
    folder = Path(chosen) if chosen else user_data_path("rockshed", appauthor=False) / "fmus"
    return folder / folder_name(runtime, fmi)


def folder_name(runtime: Runtime, fmi: Fmi = Fmi.TWO) -> str:
    """Return the folder's name: ``python``, ``native`` or ``native-fmi3``.

    Parameters
    ----------
    runtime : Runtime
        With Python or native.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    str
    """
    return runtime if fmi is Fmi.TWO else f"{runtime}-fmi{fmi}"


def file_name(component: Component, sizes: Mapping[str, int]) -> str:
    """Return the name of an FMU's file.

    It is ``Name.fmu`` with default sizes; otherwise all sizes are named:
    ``SandCushion-discs360-elements24.fmu``.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.

    Returns
    -------
    str
        The name.
    """
    suffix = (
        ""
        if dict(sizes) == component.with_sizes()
        else "".join(f"-{name}{value}" for name, value in sizes.items())
    )
    return f"{component.name}{suffix}.fmu"


def fmu_file(
    component: Component,
    sizes: Mapping[str, int],
    runtime: Runtime,
    destination: Path | None = None,
    fmi: Fmi = Fmi.TWO,
) -> Path:
    """Return the file that the FMU of a component has, built or not.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    runtime : Runtime
        With Python or native.
    destination : Path, optional
        Folder; by default that of :func:`fmu_folder`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    Path
        The file.
    """
    return (fmu_folder(runtime, fmi) if destination is None else Path(destination)) / file_name(
        component, sizes
    )


def native_is_fresh(
    component: Component,
    sizes: Mapping[str, int],
    destination: Path | None = None,
    fmi: Fmi = Fmi.TWO,
) -> bool:
    """Tell whether the native FMU of a component is there and is what would be built now.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    destination : Path, optional
        Folder; by default that of :func:`fmu_folder`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    bool
        False too if it has no binary for this machine, is damaged, or lies by default where others
        can write.
    """
    if destination is None and folder_problem(fmu_folder(Runtime.NATIVE, fmi)):
        return False
    try:
        with zipfile.ZipFile(fmu_file(component, sizes, Runtime.NATIVE, destination, fmi)) as found:
            is_here = own_binary(component, fmi) in found.namelist()
            made_from = _guid(found.read(DESCRIPTION))
            is_whole = found.testzip() is None
    except (*_UNREADABLE, BuildError):
        return False
    return is_here and is_whole and made_from == stamp(component, sizes, fmi)


def _guid(description: bytes) -> str:
    found = re.search(rb'(?:guid|instantiationToken)="([^"]*)"', description)
    return found.group(1).decode() if found else ""

"""Parts that both runtimes have in common: files of an FMU, hashes of them, the archive, errors."""

import hashlib
import io
import zipfile
from enum import IntEnum, StrEnum
from pathlib import Path

from rockshed import components
from rockshed.components.common.component import Component

COMPONENTS = Path(components.__file__).parent
SHARED = COMPONENTS / "common"
DESCRIPTION = "modelDescription.xml"
STATES = ".state"
"""End of the names of serialized states, which are zeros for the most part."""
EXPERIMENTS = "experiments.py"
"""Module of a component's folder with its experiments, which nothing inside an FMU runs."""
_NOT_FROZEN = {".md", ".png", ".svg", ".pyc"}

Files = dict[str, bytes]
"""Content of files by their path, which has forward slashes."""


class Runtime(StrEnum):
    """Carriers of an FMU's kernels."""

    PYTHON = "python"
    NATIVE = "native"


class Fmi(IntEnum):
    """Versions of FMI that an FMU can be for."""

    TWO = 2
    THREE = 3


class BuildError(Exception):
    """An FMU cannot be built or stored; the message says why and what to do."""


def component_sources(component: Component) -> Files:
    """Return the sources of a component and those that all components share.

    Kernels and declarations follow from them.

    Parameters
    ----------
    component : Component
        The component.

    Returns
    -------
    dict of str to bytes
        Content by path.

    Raises
    ------
    BuildError
        The component's folder has the name of the shared one.
    """
    if component.folder.name == SHARED.name:
        raise BuildError(
            f"{component.name}: its folder has the name {SHARED.name}, which is taken by the "
            "modules that all components share: give it another one"
        )
    paths = {
        f"components/{path.relative_to(COMPONENTS).as_posix()}": path
        for path in (COMPONENTS / "__init__.py", *COMPONENTS.glob("common/**/*.py"))
    }
    paths |= {
        f"components/{path.relative_to(component.folder.parent).as_posix()}": path
        for path in component.folder.rglob("*")
        if path.is_file() and path.suffix not in _NOT_FROZEN and path.name != EXPERIMENTS
    }
    return {name: path.read_bytes() for name, path in paths.items()}


def picture(component: Component, name: str, file: str = "icon.png") -> Files:
    """Return a picture of the component's folder, its icon, under a name, if it has one.

    Parameters
    ----------
    component : Component
        The component.
    name : str
        Path that the picture gets.
    file : str
        Its name in the component's folder.

    Returns
    -------
    dict of str to bytes
        Content by path; empty without the picture.
    """
    path = component.folder / file
    return {name: path.read_bytes()} if path.is_file() else {}


def digest(files: Files) -> str:
    """Return a hash of files with their names, as 64 hexadecimal digits.

    Parameters
    ----------
    files : dict of str to bytes
        Content by path.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    found = hashlib.sha256()
    for path, content in sorted(files.items()):
        found.update(f"{path}\0{len(content)}\0".encode() + content)
    return found.hexdigest()


def refuse_changed(component: Component, before: object, after: object) -> None:
    """Raise a BuildError if what an FMU follows from is not what it was when the build began.

    Parameters
    ----------
    component : Component
        That is built.
    before, after : object
        Digests at the beginning and at the end.

    Raises
    ------
    BuildError
        They differ.
    """
    if before != after:
        raise BuildError(
            f"{component.name}: its sources have changed while it was built, and its parts may not "
            "fit together; nothing was kept. Remedy: build it again"
        )


def archive(files: Files) -> bytes:
    """Return a zip archive that follows from the files alone: fixed order, dates and permissions.

    Only :data:`STATES` are compressed, because the result depends on the version of zlib.

    Parameters
    ----------
    files : dict of str to bytes
        Content by path.

    Returns
    -------
    bytes
        Content of the archive.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as target:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path)
            entry.create_system = 3  # Unix, also when built on Windows
            entry.external_attr = 0o100644 << 16
            if path.endswith(STATES):
                entry.compress_type = zipfile.ZIP_DEFLATED
            target.writestr(entry, files[path])
    return buffer.getvalue()

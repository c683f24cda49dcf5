"""Systems as files: the TOML that ``rockshed run`` takes, alone or in a folder with its FMUs."""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.fmu.slave import Source
from ..core.system.system import Connection, SystemSpec

SYSTEM = "system.toml"


def system_text(system: SystemSpec) -> str:
    """Return a system as TOML; keys that have their defaults are left out.

    Parameters
    ----------
    system : SystemSpec
        The system.

    Returns
    -------
    str
        Content of a system file.
    """
    data = system.model_dump(mode="json", exclude_defaults=True)
    data["connections"] = [_connection(c) for c in system.connections]
    tables = {key: value for key, value in data.items() if isinstance(value, dict)}
    return tomli_w.dumps(
        {**{key: value for key, value in data.items() if key not in tables}, **tables},
        multiline_strings=False,
    )


def _connection(connection: Connection) -> str | dict[str, Any]:
    if connection.is_linear:
        return connection.model_dump(exclude_defaults=True)
    return f"{connection.source} -> {connection.target}"


def export_system(
    system: SystemSpec, folder: Path, sources: Mapping[str, Source] | None = None
) -> Path:
    """Write ``system.toml`` and the FMUs of a system into a folder.

    Parameters
    ----------
    system : SystemSpec
        The system.
    folder : Path
        A new or empty folder.
    sources : mapping of str to Source, optional
        Components that are made without an FMU file; they become FMUs with Python inside.

    Returns
    -------
    Path
        The system file.

    Raises
    ------
    InputRefused
        The folder holds something, or cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        reason = "is not empty" if folder.is_dir() else "is a file"
        raise InputRefused([Problem(str(folder), reason, "name a new or empty folder")])
    with refusing_unwritable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        specs = {
            name: spec.model_copy(update={"fmu": _store(name, spec.fmu, folder, sources or {})})
            for name, spec in system.components.items()
        }
        text = system_text(system.model_copy(update={"components": specs}))
        (folder / SYSTEM).write_text(text, encoding="utf-8")
    return folder / SYSTEM


def _store(name: str, fmu: str, folder: Path, sources: Mapping[str, Source]) -> str:
    """Write the FMU of a component into a folder; return the name of its file."""
    from rockshed.fmus.in_process import InProcess  # imports pythonfmu, which copying does not need

    source = sources.get(name)
    if isinstance(source, InProcess):
        from rockshed.fmus.build import build_component

        try:
            return build_component(source.component, source.sizes, folder).name
        finally:
            (folder / ".lock").unlink(missing_ok=True)  # nobody else builds into this new folder
    file = Path(fmu)
    copy = folder / file.name
    if copy.exists() and copy.read_bytes() != file.read_bytes():  # of the other runtime
        copy = folder / f"{name}-{file.name}"
    shutil.copyfile(file, copy)
    return copy.name

"""Systems as files: the TOML that ``rockshed run`` takes, alone or in a folder with its FMUs."""

import shutil
from pathlib import Path
from typing import Any

import tomli_w

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.system.system import Connection, System

SYSTEM = "system.toml"


def system_text(system: System) -> str:
    """The system as TOML. What has its default is left out."""
    data = system.model_dump(mode="json", exclude_defaults=True)
    data["connections"] = [_connection(c) for c in system.connections]
    tables = {key: value for key, value in data.items() if isinstance(value, dict)}
    return tomli_w.dumps(
        {**{key: value for key, value in data.items() if key not in tables}, **tables},
        multiline_strings=False,
    )


def _connection(connection: Connection) -> str:
    return f"{connection.source} -> {connection.target}"


def export_system(system: System, folder: Path) -> Path:
    """Write ``system.toml`` and its FMUs into a new or empty folder; return the file.

    Raises:
        InputRefused: the folder holds something, or cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputRefused(
            [
                Problem(
                    str(folder),
                    "is not empty" if folder.is_dir() else "is a file",
                    "name a new or empty folder",
                )
            ]
        )
    specs: dict[str, Any] = {}
    with refusing_unwritable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for name, spec in system.components.items():
            file = Path(spec.fmu)
            copy = folder / file.name
            if copy.exists() and copy.read_bytes() != file.read_bytes():  # of the other runtime
                copy = folder / f"{name}-{file.name}"
            shutil.copyfile(file, copy)
            specs[name] = spec.model_copy(update={"fmu": copy.name})
        (folder / SYSTEM).write_text(
            system_text(system.model_copy(update={"components": specs})), encoding="utf-8"
        )
    return folder / SYSTEM

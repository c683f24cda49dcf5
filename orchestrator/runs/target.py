"""Targets of commands that are neither a case nor a system file, and what they are instead."""

import os
from pathlib import Path

from ..core.errors import Problem
from ..ssp.package import is_ssp
from .request import Request

SYSTEM = "system.toml"
"""Name of the file of a system in a folder that was made for it."""
_SYSTEMS = "a run takes a case of `rockshed list`, a system file (TOML) or an SSP"


def is_fmu(target: str) -> bool:
    """Tell whether a target is meant as an FMU, by the end of its name."""
    return Path(target).suffix.lower() == ".fmu" and not Path(target).is_dir()


def wrong_target(target: str) -> Problem | None:
    """Return the reason why a target can be no system.

    Parameters
    ----------
    target : str
        What was named in the place of a case or a system file.

    Returns
    -------
    Problem or None
        None where it may be one.
    """
    path = Path(target)
    if is_fmu(target):
        remedy = (
            "look into it with `rockshed info`, and name it in a system file; "
            "`rockshed export` writes one"
        )
        return Problem(target, f"is an FMU, and {_SYSTEMS}", remedy)
    if is_ssp(target):
        return None
    if os.path.isdir(path):
        return Problem(target, f"is a folder; {_SYSTEMS}", _remedy_in(path))
    if os.path.isfile(path) and not Request(target).is_file:
        what = f"is a file whose name does not end in .toml; {_SYSTEMS}"
        return Problem(target, what, f"write ./{target} if it is a system file")
    return None


def _remedy_in(folder: Path) -> str:
    """Say what can be done with a folder, by its content."""
    if (folder / "run.json").is_file():
        return f"it holds the results of a run: `rockshed plot {folder}` draws them"
    files = sorted(folder.glob("*.toml"), key=lambda file: file.name != SYSTEM)
    return f"name the file {files[0]}" if files else "there is no TOML file in it"

"""From plain data, or a TOML file, to a system of the right form."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import InputRefused, Problem
from ..form_faults import UNKNOWN_KEY, sentences
from ..form_keys import known_keys
from ..input_text import read_text, toml_content
from .names import nearest
from .system import SystemSpec


def system_from(data: Mapping[str, Any], where: str = "system") -> SystemSpec:
    """Make a system of plain data.

    Parameters
    ----------
    data : mapping
        Keys and values as in a TOML file.
    where : str
        Stands before the key of a problem.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        Unknown or missing keys, values of the wrong type or out of range; each with the path of
        its key.
    """
    try:
        return SystemSpec.model_validate(data)
    except ValidationError as error:
        found = sentences(error.errors())
        raise InputRefused(
            [_form_problem(where, key, texts) for key, texts in found.items()]
        ) from error


_LEFT_OUT = ("connections", "bonds", "scenario")
"""Keys of a system whose entries the others can do without."""


def _without_faulty(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a system without what is of a wrong form in these keys."""
    try:
        SystemSpec.model_validate(data)
    except ValidationError as error:
        faulty = {tuple(fault["loc"][:2]) for fault in error.errors()}
        return {key: _sound(key, value, faulty) for key, value in data.items()}
    return dict(data)


def _sound(key: str, value: Any, faulty: Collection[tuple[Any, ...]]) -> Any:
    if key not in _LEFT_OUT or not isinstance(value, list | dict):
        return value
    if isinstance(value, list):
        return [entry for place, entry in enumerate(value) if (key, place) not in faulty]
    return {name: entry for name, entry in value.items() if (key, name) not in faulty}


def _form_problem(where: str, key: tuple[Any, ...], texts: list[str]) -> Problem:
    hints = (
        [nearest(str(key[-1]), known_keys(SystemSpec, key[:-1]))] if UNKNOWN_KEY in texts else []
    )
    return Problem(f"{where}: {'.'.join(map(str, key))}", "; ".join([" or ".join(texts), *hints]))


def load_system(path: Path, leave_out_faulty: bool = False) -> SystemSpec:
    """Read a system from a TOML file.

    Parameters
    ----------
    path : Path
        Relative paths of FMUs count from its folder.
    leave_out_faulty : bool
        Connections, bonds and parts of a scenario of a wrong form are passed over, to see what
        else is wrong.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        No such file, not TOML, or :func:`system_from` refuses the content.
    """
    data = toml_content(path, read_text(path))
    if leave_out_faulty:
        data = _without_faulty(data)
    system = system_from(data, str(path))
    folder = path.resolve().parent
    components = {
        name: spec.model_copy(update={"fmu": str(folder / spec.fmu)})
        for name, spec in system.components.items()
    }
    return system.model_copy(update={"components": components})

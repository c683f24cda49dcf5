"""From plain data, or a TOML file, to a system of the right form."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import InputRefused, Problem
from ..fmu.fmu_slave import FmuFile
from ..fmu.slave import Source
from ..form_faults import UNKNOWN_KEY, sentences
from ..form_keys import known_keys
from ..input_text import read_text, toml_content
from .in_si import KeyPath, SourceOf, fmu_of, numbers_in
from .names import nearest
from .system import SystemSpec


def system_from(
    data: Mapping[str, Any], where: str = "system", source_of: SourceOf | None = None
) -> SystemSpec:
    """Make a system of plain data.

    Parameters
    ----------
    data : mapping
        Keys and values as in a TOML file.
    where : str
        Stands before the key of a problem.
    source_of : callable, optional
        Makes the source of a component, in the units of whose variables quantities are taken,
        ``20 mm``. Without it, only times and values of components may have units.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        Unknown or missing keys, values of the wrong type or out of range, and quantities of
        another kind; each with the path of its key.
    """
    wrong: dict[KeyPath, str] = {}
    if source_of is not None:
        data, wrong = numbers_in(data, source_of)
    problems = [_form_problem(where, key, [text]) for key, text in wrong.items()]
    try:
        system = SystemSpec.model_validate(data)
    except ValidationError as error:
        found = sentences(error.errors())
        problems += [_form_problem(where, key, texts) for key, texts in found.items()]
    if problems:
        raise InputRefused(problems)
    return system


def _form_problem(where: str, key: tuple[Any, ...], texts: list[str]) -> Problem:
    hints = (
        [nearest(str(key[-1]), known_keys(SystemSpec, key[:-1]))] if UNKNOWN_KEY in texts else []
    )
    return Problem(f"{where}: {'.'.join(map(str, key))}", "; ".join([" or ".join(texts), *hints]))


def load_system(path: Path) -> SystemSpec:
    """Read a system from a TOML file.

    Parameters
    ----------
    path : Path
        Relative paths of FMUs count from its folder.

    Returns
    -------
    SystemSpec
        Its quantities in the units of the FMUs' variables.

    Raises
    ------
    InputRefused
        No such file, not TOML, or :func:`system_from` refuses the content.
    """
    return system_in(toml_content(path, read_text(path)), path)


def system_in(content: Mapping[str, Any], path: Path) -> SystemSpec:
    """Make the system of the content of a file, see :func:`load_system`.

    Parameters
    ----------
    content : mapping
        Of the file.
    path : Path
        Of the file.
    """
    folder = path.resolve().parent

    def source_of(component: str, entry: Any) -> Source:
        return FmuFile(folder / fmu_of(entry), to_run=False)

    return in_folder(system_from(content, str(path), source_of), folder)


def in_folder(system: SystemSpec, folder: Path) -> SystemSpec:
    """Return a system with the whole paths of its FMUs, which count from a folder."""
    components = {
        name: spec.model_copy(update={"fmu": str(folder / spec.fmu)})
        for name, spec in system.components.items()
    }
    return system.model_copy(update={"components": components})

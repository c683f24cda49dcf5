"""Sheds from project files: as a system, and a first file to begin with."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.system.fields import Value
from ..core.system.names import nearest
from .request import AUTO, Request, plain
from .system import System

_ROOT = Path(__file__).parents[1]
TEMPLATES = {
    "shed": _ROOT / "sites" / "shed" / "template.toml",
    "slope": _ROOT / "examples" / "slope.toml",
    "pile": _ROOT / "examples" / "pile.toml",
}
"""Files to begin with, by name."""


def shed(
    project: str | Path | Mapping[str, Any],
    *,
    values: Mapping[str, Value] | None = None,
    options: Mapping[str, Any] | None = None,
    runtime: str = AUTO,
    in_process: bool = False,
    **changes: Any,
) -> System:
    """Make the system of a rock shed from its project; everything is derived from its fields.

    Parameters
    ----------
    project : path or mapping
        Project file (TOML), as ``rockshed init`` writes one, or its content.
    values : mapping of str to Value, optional
        Other values of components, by ``component.parameter``; those that follow from the project
        are refused.
    options : mapping, optional
        Keys of the system: ``stop_time``, ``output_interval``, ``load_cell``, ...
    runtime : str
        Of the FMUs: ``auto``, ``native`` or ``python``.
    in_process : bool
        Components without FMUs, in this process.
    **changes
        Fields that replace those of the project, table by table: ``cushion={"thickness": 1.5}``.

    Returns
    -------
    System
        Ready for :func:`rockshed.simulate`.

    Raises
    ------
    InputRefused
        Everything that is wrong with the project, with line and column.

    Examples
    --------
    >>> import rockshed
    >>> project = {
    ...     "rock": {"mass": "2.5 t", "drop_height": "25 m"},
    ...     "cushion": {"thickness": "1.2 m"},
    ...     "roof": {"section": "H-400x400x13x21", "span": "9 m", "spacing": "1.5 m"},
    ... }
    >>> system = rockshed.shed(project, in_process=True, cushion={"thickness": "90 cm"})
    >>> system.spec.description
    '2.5 t from 25 m on 90 cm of compacted sand on girders H-400x400x13x21, 1.5 m apart, span 9 m'
    """
    given = plain({**dict(_flat(changes, "")), **(values or {})})
    content = project if isinstance(project, Mapping) else None
    target = "project" if content is not None else str(project)
    chosen = dict(options or {})
    load_cell = chosen.pop("load_cell", None)
    request = Request(
        target if content is not None or target.endswith(".toml") else f"./{target}",
        given,
        options=plain(chosen),
        in_process=in_process,
        load_cell=load_cell,
        runtime=runtime,
        project=content,
    )
    return System.prepared(request)


def _flat(changes: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    """Yield fields by name, ``cushion.thickness``."""
    for name, value in changes.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def write_template(folder: Path, template: str = "shed") -> Path:
    """Write a commented file to begin with; a file that is there stays.

    Parameters
    ----------
    folder : Path
        Made where it is missing.
    template : str
        ``shed``, ``slope`` or ``pile``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputRefused
        There is no such template, there is such a file, or it cannot be written.
    """
    file = folder / f"{template}.toml"
    problems = []
    if template not in TEMPLATES:
        remedy = nearest(template, TEMPLATES)
        problems.append(Problem(f"template {template}", "there is none", remedy))
    elif file.exists():
        problems.append(Problem(str(file), "is there already, and stays", "name a new folder"))
    if folder.exists() and not folder.is_dir():
        problems.append(Problem(str(folder), "is a file", "name a folder"))
    if problems:
        raise InputRefused(problems)
    text = TEMPLATES[template].read_text(encoding="utf-8")
    with refusing_unwritable(file):
        folder.mkdir(parents=True, exist_ok=True)
        with file.open("x", encoding="utf-8") as new:
            new.write(text)
    return file

"""The report of an analysis: of a campaign of rockfall, or of blows on a pile."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from ..analyses.frame import Drawing, Result
from ..core.results.own_files import read_data
from ..core.results.run_folder import RUN
from ..tables import Table
from .form import Chapter, Document, Drawer, Illustration
from .inputs import value_text

_NO_INPUT = ("status", "warnings", "rockshed_files", "versions", "platform", "started", "ended")


def report_of_result(result: Result, folder: Path, repeat: str = "") -> Document:
    """Return the report of an analysis.

    Parameters
    ----------
    result : Result
        Of any analysis.
    folder : Path
        Of its files.
    repeat : str
        Command that repeats it; empty if it is not known.

    Returns
    -------
    Document
        Warnings, tables and pictures of the analysis.
    """
    facts = read_data(folder / RUN)
    warnings = [Chapter("Warnings", result.warnings, alarm=True)] if result.warnings else []
    chapters = [
        *warnings,
        Chapter("Results", result.notes, result.tables()),
        Chapter("Figures", illustrations=_illustrations(result)),
        Chapter("Inputs", listing=_inputs(facts), folded=True),
        Chapter("Origin", tables=[_origin(facts)]),
    ]
    if repeat:
        chapters.append(Chapter("How to repeat it", listing=repeat))
    title = " of ".join(dict.fromkeys((result.kind, result.name)))
    return Document(title, [result.summary], "", chapters)


def _illustrations(result: Result) -> list[Illustration]:
    drawings: Mapping[str, Drawing] = result.pictures_module().drawings(result)
    return [
        Illustration(name.replace("_", " ").capitalize(), draw=_drawer(drawing))
        for name, drawing in drawings.items()
    ]


def _drawer(drawing: Drawing) -> Drawer:
    return lambda file: drawing().savefig(file)


def _inputs(facts: Mapping[str, Any]) -> str:
    """Return what an analysis was made of, as a file of inputs has it."""
    told = {key: value for key, value in facts.items() if key not in _NO_INPUT}
    return tomli_w.dumps(_without_nothing(told))


def _without_nothing(entry: Any) -> Any:
    """Return tables and lists without entries that are not given, which TOML does not have."""
    if isinstance(entry, Mapping):
        return {k: _without_nothing(value) for k, value in entry.items() if value is not None}
    if isinstance(entry, list):
        return [_without_nothing(value) for value in entry if value is not None]
    return entry


def _origin(facts: Mapping[str, Any]) -> Table:
    made = Table(("what", "value"))
    for name, version in dict(facts.get("versions", {})).items():
        made.add(str(name), str(version))
    for key in ("seed", "platform", "started", "ended", "wall_time"):
        if facts.get(key) is not None:
            made.add(key.replace("_", " "), value_text(facts[key]))
    return made

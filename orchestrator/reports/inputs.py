"""Inputs of a run as tables: what its project file says, what was changed, and all parameters."""

from collections.abc import Iterator, Mapping
from typing import Any

from rockshed.components.catalogue import NAMES, component

from ..core.results.reading import StoredRun
from ..tables import Table, digits

_LONGEST = 60
"""Letters of a value in a table, at most."""
_LARGE = 1e7
"""Numbers from here on are written with an exponent."""


def value_text(value: object) -> str:
    """Return a value as a table shows it.

    Parameters
    ----------
    value : object
        Number, text or list.

    Returns
    -------
    str
        Numbers with six digits; endless ones in words, long texts cut.
    """
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        if abs(value) >= 1e30:
            return "without limit"
        return f"{value:.6g}" if abs(value) >= _LARGE else digits(value, 6)
    text = str(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _unit(unit: object) -> str:
    return "" if unit in (None, "", "1") else str(unit).replace(".", " ")


def differences(run: StoredRun) -> Table | None:
    """Return what is other than in the case of a run; None if nothing is.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    told = run.provenance.get("differences", {})
    made = Table(("changed", "value"), right=("value",), title="Other than in the case")
    for name, value in told.items():
        made.add(str(name), value_text(value))
    return made if len(made) else None


def shared_values(run: StoredRun) -> Table | None:
    """Return the values that several components have; None if there are none.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    told = run.provenance.get("system", {}).get("shared", {})
    made = Table(("shared value", "value (SI)", "of"), right=("value (SI)",))
    for name, entry in told.items():
        made.add(str(name), value_text(entry["value"]), ", ".join(entry["targets"]))
    return made if len(made) else None


def parameters(run: StoredRun) -> Iterator[Table]:
    """Yield a table of all parameters in use for each component.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    for name, facts in run.provenance["components"].items():
        told = facts.get("parameters", {})
        meanings = _meanings(str(facts.get("model", "")))
        titles = ("parameter", "value", "unit", "meaning")
        made = Table(titles, right=("value",), title=f"{name}: {facts.get('model', '')}")
        for parameter, entry in _joined(told).items():
            meaning = meanings.get(parameter.partition("[")[0], "")
            made.add(parameter, value_text(entry["value"]), _unit(entry.get("unit")), meaning)
        if len(made):
            yield made


def _joined(told: Mapping[str, Any]) -> dict[str, Any]:
    """Return parameters with neighbouring elements of an array that are equal as one entry."""
    joined: dict[str, Any] = {}
    ends: dict[str, tuple[str, str]] = {}
    before = ""
    for name, entry in told.items():
        array, bracket, rest = name.partition("[")
        equal = bracket and before.partition("[")[0] == array and joined[before] == entry
        if not equal:
            joined[name] = entry
            before = name
        ends[before] = (before.partition("[")[2].rstrip("]"), rest.rstrip("]"))
    return {
        f"{name.partition('[')[0]}[{first}..{last}]" if first != last else name: joined[name]
        for name, (first, last) in ends.items()
    }


def _meanings(model: str) -> dict[str, str]:
    """Return the descriptions of the parameters of a component of the catalogue."""
    if model not in NAMES:
        return {}
    return {variable.name: variable.description for variable in component(model).layout.variables}


def project_tables(run: StoredRun) -> Iterator[Table]:
    """Yield what follows from the project file of a run: the design, and all derived numbers.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    design = run.provenance.get("design", {})
    for part, entries in design.items() if isinstance(design, Mapping) else ():
        if isinstance(entries, Mapping):
            yield _plain(f"{part}, SI units", entries)
    criteria = design.get("criteria", ()) if isinstance(design, Mapping) else ()
    if criteria:
        made = Table(("criterion", "limit", "unit"), right=("limit",), title="criteria")
        for entry in criteria:
            made.add(str(entry["name"]), value_text(entry["limit"]), _unit(entry.get("unit")))
        yield made
    derived = run.provenance.get("project", {}).get("derived", {})
    if derived:
        yield _plain("derived, SI units", derived)


def _plain(title: str, entries: Mapping[str, Any]) -> Table:
    made = Table(("quantity", "value"), right=("value",), title=title)
    for name, value in entries.items():
        if value is not None:
            made.add(str(name).replace("_", " "), value_text(value))
    return made

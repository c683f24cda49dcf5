"""Inputs of a run as tables: what its project file says, what was changed, and all parameters."""

from collections.abc import Iterator, Mapping
from typing import Any

import tomli_w

from rockshed.components.catalogue import NAMES, component

from ..core.results.facts import table_of, tables_of
from ..core.results.reading import StoredRun
from ..core.system.names import split_name
from ..tables import Table, digits
from .quantities import criterion, quantity

_LONGEST = 300
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
    told = table_of(run.provenance, "differences")
    made = Table(("changed", "value", "unit"), right=("value",), title="Other than in the case")
    for name, value in told.items():
        made.add(str(name), value_text(value), _unit_of(run, str(name)))
    return made if len(made) else None


def _unit_of(run: StoredRun, name: str) -> str:
    """Return the unit of a parameter, or of a shared value by one of its targets."""
    targets = table_of(run.provenance, "system", "shared", name).get("targets", (name,))
    components = table_of(run.provenance, "components")
    component, parameter = split_name(str(next(iter(targets), "")), components)
    known = table_of(run.provenance, "components", component, "parameters", parameter)
    return _unit(known.get("unit"))


def shared_values(run: StoredRun) -> Table | None:
    """Return the values that several components have; None if there are none.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    told = table_of(run.provenance, "system", "shared")
    made = Table(("shared value", "value", "unit", "of"), right=("value",))
    for name in told:
        entry = table_of(told, name)
        targets = ", ".join(map(str, entry.get("targets", ())))
        made.add(str(name), value_text(entry.get("value", "")), _unit_of(run, str(name)), targets)
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


def project_text(run: StoredRun) -> str:
    """Return the project of a run as a project file has it; empty if there is none.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    content = table_of(run.provenance, "project").get("content", "")
    return tomli_w.dumps(dict(content)) if isinstance(content, Mapping) else str(content)


def project_tables(run: StoredRun) -> Iterator[Table]:
    """Yield the design of a run: rock, cushion, roof and criteria.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    design = table_of(run.provenance, "design")
    roof = str(table_of(design, "roof").get("kind", ""))
    for part, entries in design.items():
        if isinstance(entries, Mapping):
            yield _plain(part, entries, roof)
    made = Table(("criterion", "limit", "unit"), right=("limit",), title="criteria")
    for entry in tables_of(design, "criteria"):
        known = criterion(str(entry.get("name", "")), str(entry.get("unit", "1")))
        made.add(known.words, known.text(entry.get("limit", "")), known.unit)
    if len(made):
        yield made


def derived(run: StoredRun) -> Table | None:
    """Return everything that was derived from the project of a run; None if there is none.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    entries = table_of(run.provenance, "project", "derived")
    roof = str(table_of(entries, "roof").get("kind", ""))
    return _plain("", entries, roof) if entries else None


def _flat(entries: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    """Yield the entries of tables in one another by their dotted names."""
    for name, value in entries.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _plain(title: str, entries: Mapping[str, Any], roof: str) -> Table:
    """Return the quantities of a table in words, each with its unit."""
    made = Table(("quantity", "value", "unit"), title=title)
    for name, value in _flat(entries, ""):
        known = quantity(name, roof)
        if known is not None and known.has(value):
            unit = "" if isinstance(value, str) else known.unit
            made.add(known.words, known.text(value), unit)
    return made

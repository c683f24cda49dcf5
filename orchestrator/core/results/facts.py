"""Entries of a run's provenance that other versions may write in another form, or not at all."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any


def table_of(facts: Mapping[str, Any], *keys: str) -> dict[str, Any]:
    """Return the table at a path of keys; an empty one where there is none.

    Parameters
    ----------
    facts : mapping
        Where the path begins.
    *keys : str
        One after the other.
    """
    found: Any = facts
    for key in keys:
        found = found.get(key) if isinstance(found, Mapping) else None
    return dict(found) if isinstance(found, Mapping) else {}


def tables_of(facts: Mapping[str, Any], key: str) -> list[dict[str, Any]]:
    """Return the tables of a list; an empty list where there is none.

    Parameters
    ----------
    facts : mapping
        Has the list.
    key : str
        Its name.
    """
    return [dict(entry) for entry in _list_of(facts, key) if isinstance(entry, Mapping)]


def texts_of(facts: Mapping[str, Any], key: str) -> list[str]:
    """Return the texts of a list; an empty list where there is none.

    Parameters
    ----------
    facts : mapping
        Has the list.
    key : str
        Its name.
    """
    return [entry for entry in _list_of(facts, key) if isinstance(entry, str)]


def _list_of(facts: Mapping[str, Any], key: str) -> Sequence[Any]:
    """Return a list, empty where there is none."""
    found = facts.get(key)
    return found if isinstance(found, Sequence) and not isinstance(found, str) else []


def number_of(facts: Mapping[str, Any], key: str) -> float | None:
    """Return a number; None where there is none.

    Parameters
    ----------
    facts : mapping
        Has the number.
    key : str
        Its name.
    """
    with suppress(TypeError, ValueError):
        return float(facts[key]) if key in facts else None
    return None

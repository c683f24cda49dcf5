"""Values that changed on the way of a run, which is a variant, as its provenance has them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..system.fields import Value


@dataclass(frozen=True)
class ValueChange:
    """Other values from a time on.

    Attributes
    ----------
    at : float
        Time (s), at an exchange.
    values : mapping of str to Value
        By ``component.variable``: tunable parameters, and inputs that nothing feeds.
    """

    at: float
    values: Mapping[str, Value]


def changes_of(provenance: Mapping[str, Any]) -> list[ValueChange]:
    """Return the changes of a run that is a variant of another one, in the order of their setting.

    Parameters
    ----------
    provenance : mapping of str to Any
        Of the run; has the changes of the run that it is a variant of too.
    """
    record = provenance.get("branch")
    if not isinstance(record, Mapping):
        return []
    inherited = [_read(entry) for entry in record.get("inherited", ())]
    is_from_start = record["at"] == (provenance.get("system") or {}).get("start_time")
    return inherited if is_from_start else [*inherited, _read(record)]


def _read(entry: Mapping[str, Any]) -> ValueChange:
    return ValueChange(float(entry["at"]), dict(entry["values"]))


def branch_record(
    folder: Path, provenance: Mapping[str, Any], change: ValueChange
) -> dict[str, Any]:
    """Return the entry of a variant in its provenance.

    Parameters
    ----------
    folder : Path
        Of the run that it branches off.
    provenance : mapping of str to Any
        Of that run.
    change : ValueChange
        Time and values.

    Returns
    -------
    dict
        A parent that is a variant itself has changes of its own, which its variant has too.
    """
    found = {"of": str(folder.resolve()), "at": change.at, "values": dict(change.values)}
    if before := changes_of(provenance):
        found["inherited"] = [{"at": c.at, "values": dict(c.values)} for c in before]
    return found

"""A request: what a person asks to be run, as plain data that the provenance of the run keeps."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from ..core.system.fields import Value
from ..ssp.package import is_ssp

AUTO = "auto"
"""In the place of a runtime: native FMUs where all are there and up to date, else Python."""


def plain(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return values with numbers of numpy as those of Python, which files can hold.

    Parameters
    ----------
    entries : mapping of str to Any
        Values, sizes or options by name.

    Returns
    -------
    dict of str to Any
        The same in the same order.
    """
    return {
        name: value.item() if isinstance(value, np.generic) else value
        for name, value in entries.items()
    }


_TABLES = ("iteration", "adaptive")


def with_keys(keys: Mapping[str, Any], options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a system with some replaced; of a table, the entries that are named.

    Parameters
    ----------
    keys : mapping of str to Any
        Of a system, or options that it was changed with before.
    options : mapping of str to Any
        Keys that are other. ``iteration`` and ``adaptive`` keep the entries that are not among
        them.
    """
    tables = {
        name: {**keys[name], **options[name]}
        for name in _TABLES
        if isinstance(keys.get(name), Mapping) and isinstance(options.get(name), Mapping)
    }
    return {**keys, **options, **tables}


@dataclass(frozen=True)
class Request:
    """A case or a system file, and what is to be other than it is there.

    Attributes
    ----------
    target : str
        Name of a case, or path of a project or system file (TOML) or of an SSP.
    values : mapping of str to Value
        By ``component.parameter`` or by the name of a shared value (SI units, or texts with a
        unit); of a project also by the name of a field, ``cushion.thickness``.
    sizes : mapping of str to int
        By ``component.size``; for cases.
    coupling : str, optional
        Scheme of exchange of a case; by default its first.
    options : mapping
        Keys of the system that are replaced, ``stop_time`` for instance.
    in_process : bool
        Components without FMUs, in this process; for cases.
    load_cell : float, optional
        Cut-off frequency (Hz) of a load cell through which the transmitted force is shown as well.
    model : str, optional
        Model of the sand of a case; ``values`` go before it.
    runtime : str
        Of the FMUs of a case: ``python``, ``native`` or ``auto``.
    project : mapping, optional
        Content of a project that stands in no file; ``target`` then is only a name.
    """

    target: str
    values: Mapping[str, Value] = field(default_factory=dict)
    sizes: Mapping[str, int] = field(default_factory=dict)
    coupling: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    in_process: bool = False
    load_cell: float | None = None
    model: str | None = None
    runtime: str = AUTO
    project: Mapping[str, Any] | None = None

    @property
    def is_file(self) -> bool:
        """Whether the target is meant as a file and not as the name of a case."""
        if self.project is not None:
            return False
        if is_ssp(self.target):
            return True
        return self.target.lower().endswith(".toml") or "/" in self.target or "\\" in self.target

    def as_data(self) -> dict[str, Any]:
        """Return the request as plain data, for the provenance of the run."""
        return asdict(self)

"""Reading the results of a run, finished or not.

The files are described in :mod:`rockshed.core.results.run_folder`.
"""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...files import write_json
from ..errors import InputRefused, Problem, UnknownName
from ..system.names import nearest, select
from .metric import Metric, Metrics
from .run_folder import (
    COLUMNS,
    PARQUET,
    ROWS_STREAM,
    RUN,
    STATES,
    STATES_STREAM,
    SUMMARY,
    Column,
    read_columns,
    running_folder,
    schema,
    streamed_frames,
    streamed_rows,
)
from .series import Series, SeriesTable
from .shape import check


@dataclass(frozen=True, eq=False, repr=False)
class StoredRun:
    """Results of a run, as its folder holds them.

    ``run["rock.position.x"]`` is a :class:`~rockshed.core.results.series.Series`,
    ``run["beam.moment[*]"]`` a :class:`~rockshed.core.results.series.SeriesTable` of all elements;
    iterating over a run gives the names of its variables.

    Attributes
    ----------
    folder : Path
        Where the results are.
    provenance : mapping
        Content of ``run.json``.
    metrics : Metrics
        Single values by identifier: ``run.metrics["peak_transmitted_force"]``.
    columns : sequence of Column
        Names, units and descriptions of the recorded variables, ``time`` first.
    series : mapping of str to array of float, shape (rows,)
        Values of each column.
    """

    folder: Path
    provenance: Mapping[str, Any]
    metrics: Metrics
    columns: Sequence[Column]
    series: Mapping[str, NDArray[np.float64]]

    @property
    def status(self) -> str:
        """``complete``, ``interrupted`` or ``failed``.

        ``running`` while the run goes on, and after its process was killed.
        """
        return str(self.provenance["status"])

    @property
    def has_failed(self) -> bool:
        """Whether the run broke down, so that its results mean nothing for a design."""
        return self.status == "failed"

    @property
    def error(self) -> str | None:
        """Reason for the end of a run that failed, else None."""
        return self.provenance.get("error")

    @property
    def warnings(self) -> list[str]:
        """Warnings of the FMUs, of the initialisation and of the energy accounts."""
        return list(self.provenance.get("warnings", []))

    @property
    def texts(self) -> dict[str, list[tuple[float, str]]]:
        """Recorded variables that are text: times (s) and what they said from then on, by name.

        Known when the run has ended.
        """
        found = self.provenance.get("texts", {})
        return {name: [(at, text) for at, text in changes] for name, changes in found.items()}

    @property
    def time(self) -> NDArray[np.float64]:
        """Simulated time of the rows (s)."""
        return self.series["time"]

    def __getitem__(self, name: str) -> Any:
        """Return a variable; of a name with ``*``, which stands for any text, all that fit."""
        column = next((column for column in self.columns if column.name == name), None)
        if column is not None:
            return Series(name, column.unit, column.description, self.time, self.series[name])
        names = select(name, [*self.series]) if "*" in name else []
        if not names:
            raise UnknownName(f"the run has no variable {name!r}; {nearest(name, self.series)}")
        return SeriesTable(self.time, {found: self[found] for found in names})

    def __iter__(self) -> Iterator[str]:
        return iter(self.series)

    def __contains__(self, name: object) -> bool:
        return name in self.series

    def to_arrow(self) -> Any:
        """Return the time series as an Arrow table.

        Returns
        -------
        pyarrow.Table
            ``time`` and a column for each variable; unit and description are in the metadata of
            the fields.
        """
        import pyarrow as pa

        values = [self.series[column.name] for column in self.columns]
        return pa.table(values, schema=schema(self.columns))

    def to_pandas(self) -> Any:
        """Return the time series as a pandas table. pandas has to be installed.

        Returns
        -------
        pandas.DataFrame
            A column for each variable, ``time`` (s) as the index, units by name in
            ``attrs["units"]``.
        """
        table = self.to_arrow().to_pandas().set_index("time")
        table.attrs["units"] = {column.name: column.unit for column in self.columns}
        return table

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if not name.startswith("_")]

    def __repr__(self) -> str:
        return f"<Run {self._in_short()}, in {self.folder}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self)[1:-1])}</p>{self.metrics._repr_html_()}"

    def _in_short(self) -> str:
        reached = f"{self.time[-1]:.6g} s in {self.time.size} rows" if self.time.size else "no row"
        name = self.provenance.get("name", "")
        return f"{name}: {self.status}, {reached} of {len(self.series) - 1} variables".lstrip(": ")

    def states(self, component: str) -> Iterator[tuple[float, bytes]]:
        """Read the recorded states of a component in the order of time.

        Parameters
        ----------
        component : str
            Its name in the system.

        Yields
        ------
        (float, bytes)
            Time (s) and serialized state.
        """
        if (self.folder / STATES_STREAM).is_file():
            yield from (
                (at, state)
                for owner, at, state in streamed_frames(self.folder)
                if owner == component
            )
        elif (self.folder / STATES).is_file():
            yield from _stored_states(self.folder / STATES, component)


def _stored_states(path: Path, component: str) -> Iterator[tuple[float, bytes]]:
    import h5py

    with undamaged(path), h5py.File(path) as file:
        if component in file:
            for number, at in enumerate(file[f"{component}/time"][:]):
                yield float(at), file[f"{component}/state/{number}"][:].tobytes()


def read_run(folder: Path) -> StoredRun:
    """Read the folder of a run, or what a run that was killed has left.

    Parameters
    ----------
    folder : Path
        Folder of the run.

    Returns
    -------
    StoredRun

    Raises
    ------
    InputRefused
        There is no run, or a file of it is damaged.
    """
    place = _place_of(folder)
    with undamaged(place / RUN):
        provenance = json.loads((place / RUN).read_text(encoding="utf-8"))
        if not isinstance(provenance, dict) or "status" not in provenance:
            raise ValueError("it does not describe a run")
    if not (place / COLUMNS).is_file() and "kind" in provenance:
        raise _refusal(
            folder,
            f"holds the results of {provenance['kind']}, which have no time series",
            "give the folder of a run; `rockshed plot` draws the results of an analysis too",
        )
    with undamaged(place / RUN):
        check(provenance)
    if provenance["status"] == "complete":
        _refuse_missing(place)
    with undamaged(place / COLUMNS):
        columns = read_columns(place / COLUMNS)
    with undamaged(place / SUMMARY):
        metrics = _read_metrics(place / SUMMARY)
    return StoredRun(place, provenance, metrics, columns, _read_series(place, columns))


def _refuse_missing(place: Path) -> None:
    """Refuse a complete run without one of its files; a run that was ended may have fewer."""
    rows = ROWS_STREAM if (place / ROWS_STREAM).is_file() else PARQUET
    missing = [name for name in (COLUMNS, SUMMARY, rows) if not (place / name).is_file()]
    if missing:
        what = "is missing, and the run is complete"
        remedy = "the results are damaged; run it again"
        raise InputRefused([Problem(str(place / name), what, remedy) for name in missing])


def _place_of(folder: Path) -> Path:
    running = running_folder(folder)
    for place in (folder, running):
        if os.path.isfile(place / RUN):
            return place
    if os.path.isdir(running):
        what = f"a run was killed before it computed anything; it has left {running}"
        raise _refusal(folder, what, "run it again")
    raise _refusal(folder, f"is no folder of a run: there is no {RUN}", "give the folder of a run")


def _refusal(folder: Path, what: str, remedy: str) -> InputRefused:
    return InputRefused([Problem(str(folder), what, remedy)])


def _read_metrics(path: Path) -> Metrics:
    """Read a summary, which a run that has not ended does not have."""
    if not path.is_file():
        return Metrics()
    return Metrics(map(Metric.from_entry, json.loads(path.read_text(encoding="utf-8"))))


_DAMAGED = (
    *(ValueError, TypeError, LookupError, AttributeError, OSError),
    *(RuntimeError, OverflowError, MemoryError),
)
"""Errors that readers of JSON, CSV, Parquet and HDF5 end in: the last one raises RuntimeError."""


@contextmanager
def undamaged(path: Path) -> Iterator[None]:
    """Read a file of results; what is wrong with its content becomes a refusal that names it.

    Parameters
    ----------
    path : Path
        Of the file.

    Raises
    ------
    InputRefused
        The block has raised an error.
    """
    try:
        yield
    except _DAMAGED as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise _refusal(
            path, f"cannot be read: {reason}", "the results are damaged; run it again"
        ) from error


def _read_series(folder: Path, columns: Sequence[Column]) -> dict[str, NDArray[np.float64]]:
    import pyarrow.parquet

    if (folder / PARQUET).is_file() and not (folder / ROWS_STREAM).is_file():
        path = folder / PARQUET
        # read_table would import more
        with undamaged(path), pyarrow.parquet.ParquetFile(path) as file:
            table = file.read(columns=[column.name for column in columns])
            series = {column.name: _numbers(table[column.name]) for column in columns}
    else:
        path = folder / ROWS_STREAM
        with undamaged(path):
            rows = streamed_rows(path, len(columns))
            series = dict(zip([column.name for column in columns], rows.T.copy(), strict=True))
    with undamaged(path):
        _refuse_broken_time(series.get("time", np.empty(0)))
    return series


def _refuse_broken_time(time: NDArray[np.float64]) -> None:
    """Raise a ValueError where time goes back or is none: nothing after it would mean anything."""
    goes_on = np.diff(time) >= 0.0
    if not goes_on.all():
        row = int(np.argmin(goes_on)) + 1
        raise ValueError(f"time goes from {time[row - 1]:.9g} to {time[row]:.9g} s in row {row}")


def _numbers(column: Any) -> NDArray[np.float64]:
    """Return a column as one array. Its ``to_numpy`` would import pandas, wherever that is."""
    if column.null_count:
        raise ValueError(f"{column.null_count} values are missing")
    return np.concatenate([np.empty(0), *map(np.from_dlpack, column.chunks)])


def add_facts(folder: Path, found: Mapping[str, Any]) -> None:
    """Write down what the results of a finished run have shown.

    Parameters
    ----------
    folder : Path
        Folder of the run.
    found : mapping of str to Any
        Entries of ``run.json``; ``warnings`` come in the place of those of its components alone.
    """
    path = folder / RUN
    facts = json.loads(path.read_text(encoding="utf-8"))
    write_json(path, {**facts, **found})


def add_metrics(folder: Path, metrics: Sequence[Metric]) -> None:
    """Add metrics to the summary of a finished run.

    Parameters
    ----------
    folder : Path
        Folder of the run.
    metrics : sequence of Metric
        One with a name that is there already replaces it.
    """
    path = folder / SUMMARY
    known = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
    entries = {entry["name"]: entry for entry in known}
    entries |= {metric.name: metric.as_entry() for metric in metrics}
    write_json(path, list(entries.values()))

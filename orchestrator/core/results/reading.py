"""Reading the results of a run, finished or not. The files: :mod:`rockshed.core.results.run_folder`."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputRefused, Problem
from .metric import Metric
from .run_folder import (
    COLUMNS,
    PARQUET,
    ROWS_STREAM,
    RUN,
    STATES,
    STATES_STREAM,
    SUMMARY,
    Column,
    batches,
    read_columns,
    running_folder,
    schema,
    streamed_frames,
    write_json,
)


@dataclass(frozen=True)
class Run:
    """A run that has been read.

    provenance: content of ``run.json``; its ``status`` is ``running`` while the run goes on, and after it was killed.
    """

    folder: Path
    provenance: Mapping[str, Any]
    summary: Sequence[Metric]
    columns: Sequence[Column]
    series: Mapping[str, NDArray[np.float64]]

    @property
    def status(self) -> str:
        """Complete, interrupted, failed or running."""
        return str(self.provenance["status"])

    def figure(self, name: str) -> Metric:
        """The figure of the summary with this name."""
        return next(figure for figure in self.summary if figure.name == name)

    def states(self, component: str) -> Iterator[tuple[float, bytes]]:
        """Time (s) and serialized state of a component, in the order in which they were recorded."""
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

    with _undamaged(path), h5py.File(path) as file:
        if component in file:
            for number, at in enumerate(file[f"{component}/time"][:]):
                yield float(at), file[f"{component}/state/{number}"][:].tobytes()


def read_run(folder: Path) -> Run:
    """Read the folder of a run, or what a run that was killed has left beside it.

    Raises:
        InputRefused: there is no run, or a file of it is damaged.
    """
    places = (folder, running_folder(folder.absolute()))
    found = next((place for place in places if (place / RUN).is_file()), None)
    if found is None:
        raise InputRefused(
            [
                Problem(
                    str(folder),
                    f"is no folder of a run: there is no {RUN}",
                    "give the folder of a run",
                )
            ]
        )
    with _undamaged(found / RUN):
        provenance = json.loads((found / RUN).read_text(encoding="utf-8"))
        if not isinstance(provenance, dict) or "status" not in provenance:
            raise ValueError("it does not describe a run")
    if not (found / COLUMNS).is_file() and "kind" in provenance:
        raise InputRefused(
            [
                Problem(
                    str(folder),
                    f"is a {provenance['kind']} campaign, which has no time series",
                    "give the folder of a run; the campaign's pictures are in its folder figures",
                )
            ]
        )
    with _undamaged(found / COLUMNS):
        columns = read_columns(found / COLUMNS)
    with _undamaged(found / SUMMARY):
        summary = (
            [
                Metric.from_entry(entry)
                for entry in json.loads((found / SUMMARY).read_text(encoding="utf-8"))
            ]
            if (found / SUMMARY).is_file()
            else []
        )
    return Run(found, provenance, summary, columns, _read_series(found, columns))


@contextmanager
def _undamaged(path: Path) -> Iterator[None]:
    """Read a file of a run; what is wrong with its content becomes a refusal that names it."""
    try:
        yield
    except (ValueError, TypeError, KeyError, AttributeError, OSError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise InputRefused(
            [
                Problem(
                    str(path), f"cannot be read: {reason}", "the results are damaged; run it again"
                )
            ]
        ) from error


def _read_series(folder: Path, columns: Sequence[Column]) -> dict[str, NDArray[np.float64]]:
    import pyarrow as pa
    import pyarrow.parquet

    if (folder / PARQUET).is_file() and not (folder / ROWS_STREAM).is_file():
        with (
            _undamaged(folder / PARQUET),
            pyarrow.parquet.ParquetFile(folder / PARQUET) as file,
        ):  # read_table imports more
            table = file.read(columns=[column.name for column in columns])
    else:
        table = pa.Table.from_batches(batches(folder / ROWS_STREAM), schema(columns))
    with _undamaged(folder / COLUMNS):
        return {column.name: table[column.name].to_numpy() for column in columns}


def add_figures(folder: Path, figures: Sequence[Metric]) -> None:
    """Add figures to the summary of a finished run; one with a name that is there already replaces it."""
    path = folder / SUMMARY
    present = {entry["name"]: entry for entry in json.loads(path.read_text(encoding="utf-8"))}
    write_json(
        path, list({**present, **{figure.name: figure.as_entry() for figure in figures}}.values())
    )

"""Results of a run: a folder that appears as a whole and that can be read after a crash.

While a run is going on, everything goes into ``NAME.running`` in the same place as the folder
``NAME``; when the run ends, that takes the place of ``NAME`` as a whole. Rows and states are
appended to Arrow streams, which can be read up to the last complete batch whatever happens, and are
turned into the final files at the end.

==================  ================================================================================
run.json            status (running, complete, interrupted, failed), error, warnings, provenance
summary.json        list of {id, name, value, unit}, with {references} where there are any
timeseries.parquet  columns ``time`` and ``component.variable``; unit and description in the
                    metadata of each field
timeseries.csv      the same, ``time`` first, one line of names
columns.csv         name, unit and description of each column
states.h5           per component: ``time`` (n,), and serialized states ``state/0`` to
                    ``state/n-1`` (bytes as uint8)
==================  ================================================================================
"""

import csv
import json
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from ...files import write_json
from ..errors import InputRefused, Problem, refusing_unwritable
from .metric import Metric

RUN = "run.json"
SUMMARY = "summary.json"
COLUMNS = "columns.csv"
PARQUET = "timeseries.parquet"
CSV = "timeseries.csv"
STATES = "states.h5"
ROWS_STREAM = "timeseries.arrows"
STATES_STREAM = "states.arrows"


@dataclass(frozen=True)
class Column:
    """A column of the time series.

    Attributes
    ----------
    name : str
        ``time`` or ``component.variable``.
    unit : str
        FMI unit, ``1`` where there is none.
    description : str
        Of the variable.
    """

    name: str
    unit: str
    description: str = ""


class RunFolder:
    """The folder of one run, locked against other runs while it is open. A context manager.

    Left before :meth:`begin`, it leaves nothing behind; left between :meth:`begin` and
    :meth:`finish`, what a killed run leaves.

    Parameters
    ----------
    folder : Path
        Its final place.

    Attributes
    ----------
    running : Path
        Folder in which the run writes.

    Raises
    ------
    InputRefused
        The folder cannot be written, holds something else than a run, or another run is writing
        it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self.running = running_folder(self.folder)
        self._old = self.folder.parent / f".{self.folder.name}.old"
        above = (self.folder.parent, *self.folder.parent.parents)
        self._made = [parent for parent in above if not parent.exists()]
        self._lock = FileLock(self.folder.parent / f".{self.folder.name}.lock")
        self.columns: list[Column] = []
        self._rows: _Stream | None = None
        self._states: _Stream | None = None

    def __enter__(self) -> "RunFolder":
        if self.folder.exists() and not _is_run_or_empty(self.folder):
            raise self._refusal(
                "is no folder of a run, and would be overwritten", "choose another folder"
            )
        try:
            self._open()
        except InputRefused:
            self._clean()
            raise
        return self

    def _open(self) -> None:
        with refusing_unwritable(self.folder, "choose another folder"):
            self.folder.parent.mkdir(parents=True, exist_ok=True)
            try:
                self._lock.acquire(timeout=0)
            except Timeout:
                raise self._taken() from None
            for left in filter(Path.exists, (self.running, self._old)):  # by a run that was killed
                shutil.rmtree(left)
            self.running.mkdir()

    def _taken(self) -> InputRefused:
        """Say why there is no lock."""
        if not Path(self._lock.lock_file).exists():  # nobody holds it: it cannot be made here
            return self._refusal("cannot be written", "choose another folder")
        return self._refusal(
            "another run is writing there", "wait for its end or choose another folder"
        )

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._rows is None:
            shutil.rmtree(self.running, ignore_errors=True)
        self._clean()

    def _refusal(self, what: str, remedy: str) -> InputRefused:
        return InputRefused([Problem(str(self.folder), what, remedy)])

    def _clean(self) -> None:
        """Release the lock; remove it and folders that were made for nothing."""
        if self._lock.is_locked:
            Path(self._lock.lock_file).unlink(missing_ok=True)
            self._lock.release()
        for made in self._made:
            try:
                made.rmdir()
            except OSError:
                return

    # ------------------------------------------------------------------ during the run

    def begin(self, columns: Sequence[Column], provenance: Mapping[str, Any]) -> None:
        """Write down what is about to run.

        Parameters
        ----------
        columns : sequence of Column
            Without the time.
        provenance : mapping
            Content of ``run.json``, without the status.
        """
        import pyarrow as pa

        self.columns = [Column("time", "s", "simulated time"), *columns]
        self.write_provenance({"status": "running", **provenance})
        self._write_columns()
        self._rows = _Stream(self.running / ROWS_STREAM, schema(self.columns))
        self._states = _Stream(
            self.running / STATES_STREAM,
            pa.schema([("component", pa.string()), ("time", pa.float64()), ("state", pa.binary())]),
        )

    def write_provenance(self, provenance: Mapping[str, Any]) -> None:
        """Replace ``run.json`` by other facts."""
        self.provenance = dict(provenance)
        write_json(self.running / RUN, self.provenance)

    def _write_columns(self) -> None:
        with (self.running / COLUMNS).open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, ["name", "unit", "description"])
            writer.writeheader()
            writer.writerows(map(asdict, self.columns))

    def rows(self, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Append the values of all columns.

        Parameters
        ----------
        times : array of float, shape (n,)
            In s.
        values : array of float, shape (n, columns)
            Without the time.
        """
        if self._rows is not None:
            self._rows.append([times, *np.ascontiguousarray(values.T)])

    def frame(self, component: str, at: float, state: bytes) -> None:
        """Append the serialized state of a component at a time (s)."""
        if self._states is not None:
            self._states.append([[component], [at], [state]])

    # ------------------------------------------------------------------ at the end

    def finish(self, status: str, metrics: Sequence[Metric], **facts: Any) -> None:
        """Write the final files and put them in the place of the folder.

        Parameters
        ----------
        status : str
            ``complete``, ``interrupted`` or ``failed``.
        metrics : sequence of Metric
            For the summary.
        **facts
            Added to the provenance.
        """
        for stream in filter(None, (self._rows, self._states)):
            stream.close()
        self.complete(status, metrics, **facts)

    def complete(self, status: str, metrics: Sequence[Metric], **facts: Any) -> None:
        """Turn streams into the final files, and put them in the place of the folder.

        Parameters
        ----------
        status, metrics, **facts
            As for :meth:`finish`. The streams may have been cut off.
        """
        write_json(self.running / SUMMARY, [metric.as_entry() for metric in metrics])
        _convert_rows(self.running, self.columns)
        _convert_states(self.running)
        self.write_provenance({**self.provenance, "status": status, **facts})
        self.swap()

    def swap(self) -> None:
        """Put the new folder in the place of the old one.

        Renaming is one step each for the file system.
        """
        if self.folder.exists():
            self.folder.rename(self._old)
        self.running.rename(self.folder)
        shutil.rmtree(self._old, ignore_errors=True)


class _Stream:
    """An Arrow stream in a file. Each batch goes to the operating system at once."""

    def __init__(self, path: Path, schema: Any) -> None:
        import pyarrow as pa

        self._schema = schema
        self._file = path.open("wb")
        compressed = pa.ipc.IpcWriteOptions(compression="zstd")
        self._writer = pa.ipc.new_stream(self._file, schema, options=compressed)
        self._file.flush()

    def append(self, columns: Sequence[Any]) -> None:
        """Write a batch: columns of equal length."""
        import pyarrow as pa

        arrays = [_arrow(c, field.type) for c, field in zip(columns, self._schema, strict=True)]
        self._writer.write_batch(pa.record_batch(arrays, schema=self._schema))
        self._file.flush()

    def close(self) -> None:
        """End the stream, so that it is complete."""
        self._writer.close()
        self._file.close()


def _arrow(values: Sequence[Any], kind: Any) -> Any:
    """Return numbers, texts or bytes as an Arrow array.

    It is made from buffers: ``pyarrow.array`` would import pandas wherever that is installed.
    """
    import pyarrow as pa

    if pa.types.is_floating(kind):
        numbers = np.ascontiguousarray(values, np.float64)
        return pa.Array.from_buffers(kind, len(numbers), [None, pa.py_buffer(numbers)])
    parts = [value.encode() if isinstance(value, str) else bytes(value) for value in values]
    ends = np.cumsum([0, *map(len, parts)], dtype=np.int32)
    content = [None, pa.py_buffer(ends), pa.py_buffer(b"".join(parts))]
    return pa.Array.from_buffers(kind, len(parts), content)


def keep_crashed(folder: Path, error: str, **facts: Any) -> bool:
    """Turn what a crashed run has left into the results of a run that failed.

    Parameters
    ----------
    folder : Path
        Final place of the run.
    error : str
        Reason of the crash.
    **facts
        Added to the provenance.

    Returns
    -------
    bool
        False if the run had not begun; then nothing is left.
    """
    results = RunFolder(folder)
    (results.folder.parent / f".{results.folder.name}.lock").unlink(missing_ok=True)
    for left in results.running.glob("journal.*"):
        left.unlink()
    if not (results.running / ROWS_STREAM).is_file():
        shutil.rmtree(results.running, ignore_errors=True)
        return False
    results.provenance = json.loads((results.running / RUN).read_text(encoding="utf-8"))
    results.columns = read_columns(results.running / COLUMNS)
    results.complete("failed", [], error=error, **facts)
    return True


def running_folder(folder: Path) -> Path:
    """Return the folder in which a run writes before it has ended."""
    return folder.parent / f"{folder.name}.running"


def _is_run_or_empty(folder: Path) -> bool:
    return folder.is_dir() and ((folder / RUN).is_file() or not any(folder.iterdir()))


def read_columns(path: Path) -> list[Column]:
    """Read the columns of a run from ``columns.csv``."""
    with path.open(encoding="utf-8", newline="") as file:
        return [Column(**entry) for entry in csv.DictReader(file)]


def schema(columns: Sequence[Column]) -> Any:
    """Return Arrow's schema of the time series."""
    import pyarrow as pa

    described = [(c.name, {"unit": c.unit, "description": c.description}) for c in columns]
    return pa.schema([pa.field(name, pa.float64(), metadata=d) for name, d in described])


def batches(path: Path) -> Iterator[Any]:
    """Read the batches of a stream, up to where it was cut off."""
    import pyarrow as pa

    if not path.is_file():
        return
    with path.open("rb") as file:
        try:
            yield from pa.ipc.open_stream(file)
        except (pa.ArrowInvalid, OSError):  # the process was killed while it wrote
            return


def streamed_frames(folder: Path) -> Iterator[tuple[str, float, bytes]]:
    """Read component, time (s) and state of each frame in the stream of a run."""
    for batch in batches(folder / STATES_STREAM):
        yield from zip(*(column.to_pylist() for column in batch.columns), strict=True)


def _convert_rows(folder: Path, columns: Sequence[Column]) -> None:
    import pyarrow as pa
    import pyarrow.csv
    import pyarrow.parquet

    table = pa.Table.from_batches(batches(folder / ROWS_STREAM), schema(columns))
    pyarrow.parquet.write_table(table, folder / PARQUET, compression="zstd")
    pyarrow.csv.write_csv(table, folder / CSV)
    (folder / ROWS_STREAM).unlink()


def _convert_states(folder: Path) -> None:
    frames = streamed_frames(folder)
    first = next(frames, None)
    if first is not None:
        _write_states(folder / STATES, chain([first], frames))
    (folder / STATES_STREAM).unlink()


def _write_states(path: Path, frames: Iterable[tuple[str, float, bytes]]) -> None:
    import h5py

    times: dict[str, list[float]] = {}
    with h5py.File(path, "w") as file:
        for component, at, state in frames:
            its_times = times.setdefault(component, [])
            file.create_dataset(
                f"{component}/state/{len(its_times)}",
                data=np.frombuffer(state, np.uint8),
                compression="gzip",
                compression_opts=1,
                shuffle=True,
            )
            its_times.append(at)
        for component, values in times.items():
            file.create_dataset(f"{component}/time", data=values).attrs["unit"] = "s"

"""Results of a run: a folder that appears as a whole and that can be read after a crash.

While a run is going on, everything goes into ``NAME.running`` in the same place as the folder
``NAME``; when the run ends, that takes the place of ``NAME`` as a whole. What is the user's in
``NAME`` stays there. A run that was killed leaves ``NAME.running``: the next one writes into
``NAME.running-2`` and removes it when it is complete. Rows and states are
appended to Arrow streams, which can be read up to the last complete batch whatever happens, and are
turned into the final files at the end.

==================  ================================================================================
run.json            status (running, complete, interrupted, failed), error, warnings, provenance,
                    list of the files of the run
summary.json        list of {id, name, value, unit}, with {references} where there are any
timeseries.parquet  columns ``time`` and ``component.variable``; unit and description in the
                    metadata of each field
timeseries.csv      the same, ``time`` first, one line of names
columns.csv         name, unit and description of each column
states.h5           per component: ``time`` (n,), and serialized states ``state/0`` to
                    ``state/n-1`` (bytes as uint8)
checkpoints         of a run that takes some: see :mod:`rockshed.core.results.checkpoints`
==================  ================================================================================
"""

import csv
import os
import re
import secrets
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from itertools import chain, count
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from ...files import naming, write_file, write_json
from ...temporary import sweep_once
from ..errors import InputRefused, Problem, refusing_unwritable
from .checkpoints import FOLDER as CHECKPOINTS
from .checkpoints import remove_checkpoints
from .metric import Metric
from .own_files import FILES, MARK, content_of, foreign, is_marked, mark, read_data

RUN = "run.json"
SUMMARY = "summary.json"
COLUMNS = "columns.csv"
PARQUET = "timeseries.parquet"
CSV = "timeseries.csv"
STATES = "states.h5"
ROWS_STREAM = "timeseries.arrows"
STATES_STREAM = "states.arrows"
RESERVE = ".reserve"
"""File that takes room on the disk, so that the end of a run can be written when there is none."""
_RESERVED = 1 << 17
"""Its length (bytes)."""
_REPLACES = "replaces"
"""Entry of ``run.json`` during a swap: name of the old folder."""
_ASIDE = ".rockshed-old"
_WORKING = (
    *(MARK, RESERVE, RUN, SUMMARY, COLUMNS, PARQUET, CSV, STATES, ROWS_STREAM, STATES_STREAM),
    *("journal.bin", "journal.json", "trials.parquet", "envelopes.parquet", "envelopes.csv"),
    *("traces.parquet", "traces.csv", "bearing.parquet", "bearing.csv"),
)
"""Files of runs that have not ended."""
_UNFINISHED = re.compile(r"\.[^.]+\.[0-9a-f]{8}\.\w+")
"""Name of a file that was being written."""


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
        self.folder = Path(os.path.realpath(folder))  # a link stays, and leads to the results
        self.running = running_folder(self.folder)
        above = (self.folder.parent, *self.folder.parent.parents)
        self._made = [parent for parent in above if not parent.exists()]
        self._lock = FileLock(self.folder.parent / f".{self.folder.name}.lock")
        self.columns: list[Column] = []
        self._rows: _Stream | None = None
        self._states: _Stream | None = None

    def __enter__(self) -> "RunFolder":
        refuse_other_content(self.folder)
        if os.path.ismount(self.folder):
            raise self._refusal("cannot be replaced as a whole", "choose a folder in it")
        try:
            self._open()
        except InputRefused:
            self._clean()
            raise
        return self

    def _open(self) -> None:
        sweep_once()
        with refusing_unwritable(self.folder, "choose another folder"):
            self.folder.parent.mkdir(parents=True, exist_ok=True)
            self._take_lock()
            recover(self.folder)
            self.running = free_running_folder(self.folder)
            self.running.mkdir()
            with _removed_if_it_fails(self.running):
                mark(self.running)

    def _take_lock(self) -> None:
        file = Path(self._lock.lock_file)
        if file.is_dir() or (file.is_file() and file.stat().st_size):
            raise self._refusal(
                f"would be locked with the file {file}, which holds something else",
                "rename that or choose another folder",
            )
        try:
            self._lock.acquire(timeout=0)
        except Timeout:
            raise self._taken() from None

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
        write_file(self.running / RESERVE, os.urandom(_RESERVED))
        self.write_provenance({"status": "running", **provenance})
        self._write_columns()
        # a row is one value of the stream: hundreds of columns would take their time in each batch
        row = pa.list_(pa.float64(), len(self.columns))
        self._rows = _Stream(self.running / ROWS_STREAM, pa.schema([("row", row)]))
        self._states = _Stream(
            self.running / STATES_STREAM,
            pa.schema([("component", pa.string()), ("time", pa.float64()), ("state", pa.binary())]),
            compression="zstd",
        )

    def write_provenance(self, provenance: Mapping[str, Any]) -> None:
        """Replace ``run.json`` by other facts."""
        self.provenance = dict(provenance)
        write_json(self.running / RUN, self.provenance)

    def _write_columns(self) -> None:
        place = self.running / COLUMNS
        with naming(place), place.open("w", newline="", encoding="utf-8") as file:
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
            self._rows.append([np.column_stack([times, values])])

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
        (self.running / RESERVE).unlink(missing_ok=True)
        self.write_provenance({**self.provenance, "status": status, **facts})
        self.swap(status == "complete")

    def give_up(self, error: str, **facts: Any) -> None:
        """Mark what was written as the results of a run that failed, where the disk is full.

        The streams stay as they are, in :attr:`running`: they can be read and drawn.

        Parameters
        ----------
        error : str
            Reason of the failure.
        **facts
            Added to the provenance.
        """
        (self.running / RESERVE).unlink(missing_ok=True)
        for stream_file, made in ((ROWS_STREAM, (PARQUET, CSV)), (STATES_STREAM, (STATES,))):
            if (self.running / stream_file).is_file():
                for file in made:
                    (self.running / file).unlink(missing_ok=True)
        for stream in filter(None, (self._rows, self._states)):
            stream.abandon()
        self.write_provenance({**self.provenance, "status": "failed", "error": error, **facts})

    def amend(self, **facts: Any) -> None:
        """Add facts to the provenance of a run that has been finished."""
        self.provenance = {**read_data(self.folder / RUN), **facts}
        write_json(self.folder / RUN, self.provenance)

    def discard(self) -> None:
        """Give up everything that this process has written, which then is removed."""
        for stream in filter(None, (self._rows, self._states)):
            stream.abandon()
        self._rows = None

    def swap(self, is_complete: bool = True) -> None:
        """Put the new folder in the place of the old one. What is the user's there stays.

        Renaming is one step each for the file system; :func:`recover` goes on after a kill.

        Parameters
        ----------
        is_complete : bool
            Whether what killed runs have left is removed.
        """
        lost = leftovers(self.folder, self.running)
        content = read_data(self.running / RUN)
        entries = {**content, FILES: sorted(content_of(self.running))}
        if self.folder.exists():
            aside = _beside(self.folder, f".{secrets.token_hex(4)}{_ASIDE}")
            write_json(self.running / RUN, {**entries, _REPLACES: aside.name})
            self.folder.rename(aside)
            self.running.rename(self.folder)
        else:
            write_json(self.running / RUN, entries)
            self.running.rename(self.folder)
        settle(self.folder)
        if is_complete:
            for folder in lost:
                _remove_leftover(folder)


@contextmanager
def _removed_if_it_fails(folder: Path) -> Iterator[None]:
    try:
        yield
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def settle(folder: Path) -> None:
    """End a swap: move what is the user's from the old folder to the new one, remove the rest.

    Parameters
    ----------
    folder : Path
        New results.
    """
    (folder / MARK).unlink(missing_ok=True)
    content = read_data(folder / RUN)
    aside = _aside(folder, content)
    if aside is None:
        return
    if aside.is_dir():
        for name in foreign(aside):
            _carry(aside / name, folder / name)
        shutil.rmtree(aside, ignore_errors=True)
    write_json(folder / RUN, {key: value for key, value in content.items() if key != _REPLACES})


def _aside(folder: Path, content: Mapping[str, Any]) -> Path | None:
    """Return the place to which a swap moved the old folder."""
    name = str(content.get(_REPLACES, ""))
    return _beside(folder, name) if re.fullmatch(rf"\.[0-9a-f]{{8}}{_ASIDE}", name) else None


def _carry(source: Path, target: Path) -> None:
    """Move what is the user's to where it was; under another name if a new file is there."""
    if source.is_dir() and target.is_dir() and not source.is_symlink():
        for entry in list(source.iterdir()):
            _carry(entry, target / entry.name)
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    names = (_beside(target, f"{target.stem}-{n}{target.suffix}") for n in count(2))
    source.rename(next(path for path in chain([target], names) if not os.path.lexists(path)))


def _remove_leftover(folder: Path) -> None:
    """Remove what a killed run has left, but nothing that somebody else has put there."""
    for entry in list(folder.iterdir()):
        if entry.name in ("figures", "campaign") and not entry.is_symlink():
            shutil.rmtree(entry, ignore_errors=True)
        elif entry.name == CHECKPOINTS and not entry.is_symlink():
            remove_checkpoints(folder)
        elif entry.name in _WORKING or _UNFINISHED.fullmatch(entry.name):
            entry.unlink(missing_ok=True)
    with suppress(OSError):
        folder.rmdir()


def leftovers(folder: Path, live: Path | None = None) -> list[Path]:
    """Return the folders in which runs wrote that were killed or could not end, oldest first.

    Parameters
    ----------
    folder : Path
        Final place of the runs.
    live : Path, optional
        Folder of a run that goes on, which is left out.

    Returns
    -------
    list of Path
        Only folders that this program has made.
    """
    return [path for path in _numbered(folder).values() if path != live and is_marked(path)]


def unfinished(place: Path) -> list[Path]:
    """Return what runs have left that were killed or go on, in the folder of their results.

    Parameters
    ----------
    place : Path
        In which results lie, ``results`` for instance.

    Returns
    -------
    list of Path
        Folders in which runs write, and old results that a swap has put aside. What the user has
        there is not among them, whatever it is called.
    """
    try:
        entries = sorted(entry for entry in place.iterdir() if entry.is_dir())
    except OSError:
        return []
    aside = re.compile(rf"\.[0-9a-f]{{8}}{_ASIDE}")
    return [entry for entry in entries if is_marked(entry) or aside.fullmatch(entry.name)]


def _beside(path: Path, name: str) -> Path:
    """Return the place of another name in the same folder; a root has no name that could change."""
    return path.parent / name


def _numbered(folder: Path) -> dict[int, Path]:
    """Return everything that is called like a folder in which a run writes, by number."""
    pattern = re.compile(re.escape(folder.name) + r"\.running(?:-(\d+))?", re.DOTALL)
    try:
        names = map(pattern.fullmatch, os.listdir(folder.parent))
    except OSError:
        return {}
    found = {int(name[1] or 1): _beside(folder, name[0]) for name in names if name}
    return dict(sorted(found.items()))


def free_running_folder(folder: Path) -> Path:
    """Return the folder in which the next run may write: there is nothing yet."""
    number = max(_numbered(folder), default=0) + 1
    return _beside(folder, f"{folder.name}.running" + (f"-{number}" if number > 1 else ""))


def recover(folder: Path) -> None:
    """Go on with a swap that was killed. The folder has to be locked.

    Parameters
    ----------
    folder : Path
        Final place of a run.
    """
    for left in leftovers(folder):
        aside = _aside(folder, read_data(left / RUN))
        if aside is not None and aside.is_dir() and not folder.exists():
            left.rename(folder)
    if folder.is_dir() and _REPLACES in read_data(folder / RUN):
        settle(folder)


class _Stream:
    """An Arrow stream in a file. Each batch goes to the operating system at once.

    Parameters
    ----------
    path : Path
        The file.
    schema : pyarrow.Schema
        Columns of a batch.
    compression : str or None
        Codec. Rows have none: a batch of a few rows would get no smaller.
    """

    def __init__(self, path: Path, schema: Any, compression: str | None = None) -> None:
        import pyarrow as pa

        self._schema = schema
        self._path = path
        with naming(path):
            self._file = path.open("wb")
            options = pa.ipc.IpcWriteOptions(compression=compression)
            self._writer = pa.ipc.new_stream(self._file, schema, options=options)
            self._file.flush()
        self._whole = self._file.tell()

    def append(self, columns: Sequence[Any]) -> None:
        """Write a batch: columns of equal length."""
        import pyarrow as pa

        arrays = [_arrow(c, field.type) for c, field in zip(columns, self._schema, strict=True)]
        with naming(self._path):
            self._writer.write_batch(pa.record_batch(arrays, schema=self._schema))
            self._file.flush()
        self._whole = self._file.tell()

    def close(self) -> None:
        """End the stream, so that it is complete."""
        with naming(self._path):
            self._writer.close()
            self._file.close()

    def abandon(self) -> None:
        """Let go of the file, and cut off a batch that was not written as a whole."""
        with suppress(OSError):
            self._file.close()
        with suppress(OSError):
            os.truncate(self._path, self._whole)


def _arrow(values: Any, kind: Any) -> Any:
    """Return rows, numbers, texts or bytes as an Arrow array.

    It is made from buffers: ``pyarrow.array`` would import pandas wherever that is installed.
    """
    import pyarrow as pa

    if pa.types.is_fixed_size_list(kind):
        numbers = _arrow(np.ravel(values), kind.value_type)
        return pa.FixedSizeListArray.from_arrays(numbers, kind.list_size)
    if pa.types.is_floating(kind):
        numbers = np.ascontiguousarray(values, np.float64)
        return pa.Array.from_buffers(kind, len(numbers), [None, pa.py_buffer(numbers)])
    parts = [value.encode() if isinstance(value, str) else bytes(value) for value in values]
    ends = np.cumsum([0, *map(len, parts)], dtype=np.int32)
    content = [None, pa.py_buffer(ends), pa.py_buffer(b"".join(parts))]
    return pa.Array.from_buffers(kind, len(parts), content)


def keep_crashed(
    folder: Path, running: Path, error: str, status: str = "failed", **facts: Any
) -> bool:
    """Turn what a crashed run has left into the results of a run that failed.

    Parameters
    ----------
    folder : Path
        Final place of the run.
    running : Path
        Folder in which it wrote.
    error : str
        Reason of the crash.
    status : str
        ``failed``, or ``interrupted``.
    **facts
        Added to the provenance.

    Returns
    -------
    bool
        False if the run had not begun; then nothing is left.
    """
    results = RunFolder(folder)
    results.running = running
    if not (running / ROWS_STREAM).is_file():
        shutil.rmtree(running, ignore_errors=True)
        return False
    results.provenance = read_data(running / RUN)
    results.columns = read_columns(running / COLUMNS)
    try:
        results.complete(status, [], error=error, **facts)
    except OSError:  # the disk is full
        results.give_up(error, **facts)
    return True


def unlock(folder: Path) -> None:
    """Remove the lock of a run whose process has crashed."""
    place = Path(os.path.realpath(folder))
    _beside(place, f".{place.name}.lock").unlink(missing_ok=True)


def running_folder(folder: Path) -> Path:
    """Return the folder in which the newest run that has not ended writes, or would write."""
    place = Path(os.path.realpath(folder))
    known = [path for path in _numbered(place).values() if is_marked(path)]
    return known[-1] if known else _beside(place, f"{place.name}.running")


def refuse_other_content(folder: Path) -> None:
    """Refuse a folder for the results of a run that holds something else.

    Parameters
    ----------
    folder : Path
        Of results, or where nothing is yet.

    Raises
    ------
    InputRefused
        It is a file, or a folder of something else than a run.
    """
    if folder.exists() and not _is_run_or_empty(folder):
        what = "is no folder of a run, and would be overwritten"
        raise InputRefused([Problem(str(folder), what, "choose another folder")])


def _is_run_or_empty(folder: Path) -> bool:
    if not folder.is_dir():
        return False
    return "status" in read_data(folder / RUN) or not any(folder.iterdir())


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


def streamed_rows(path: Path, columns: int) -> NDArray[np.float64]:
    """Read the rows in the stream of a run, up to where it was cut off.

    Parameters
    ----------
    path : Path
        The stream.
    columns : int
        Number of columns, with the time.

    Returns
    -------
    array of float, shape (n, columns)

    Raises
    ------
    ValueError
        It holds rows of another length, or none.
    """
    import pyarrow as pa

    kind = pa.list_(pa.float64(), columns)
    parts = []
    for batch in batches(path):
        batch.validate(full=True)
        if batch.schema.types != [kind]:
            raise ValueError(f"holds {batch.schema.types[0]}, not rows of {columns} columns")
        rows = batch.column(0)
        if rows.null_count or rows.values.null_count:
            raise ValueError("values are missing")
        # its flatten() would import more
        parts.append(np.from_dlpack(rows.values).reshape(len(rows), columns))
    return np.concatenate([np.empty((0, columns)), *parts])


def streamed_frames(folder: Path) -> Iterator[tuple[str, float, bytes]]:
    """Read component, time (s) and state of each frame in the stream of a run."""
    for batch in batches(folder / STATES_STREAM):
        yield from zip(*(column.to_pylist() for column in batch.columns), strict=True)


def _convert_rows(folder: Path, columns: Sequence[Column]) -> None:
    import pyarrow as pa
    import pyarrow.csv
    import pyarrow.parquet

    rows = streamed_rows(folder / ROWS_STREAM, len(columns))
    table = pa.Table.from_arrays([_arrow(c, pa.float64()) for c in rows.T], schema=schema(columns))
    with naming(folder / PARQUET):
        pyarrow.parquet.write_table(
            table, folder / PARQUET, compression="zstd", use_dictionary=False
        )
    with naming(folder / CSV):
        pyarrow.csv.write_csv(table, folder / CSV)
    (folder / ROWS_STREAM).unlink()


def _convert_states(folder: Path) -> None:
    frames = streamed_frames(folder)
    first = next(frames, None)
    if first is not None:
        with naming(folder / STATES):
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

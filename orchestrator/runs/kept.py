"""Runs that have ended, kept until all of a batch have: what is killed in between goes on there.

A file for each run, named by everything that its result follows from: system, FMUs and program. It
has numbers and JSON, is written whole, and one that is damaged is as if it were not there. Other
files in the folder are the user's, and stay.
"""

import hashlib
import json
import math
import re
import zipfile
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..core.system.system import SystemSpec
from ..files import whole_file
from ..versions import sources_digest, versions
from .outcome import Outcome

FINISHED = ".finished-runs"
"""Folder, among the results of a batch, of its runs that have ended, until all have."""
ASKED = "asked.json"
"""File beside what has ended of an analysis, with what it was asked."""
_NAME = re.compile(r"run-[0-9a-f]{32}\.npz")
"""Name of a file of this module, which ends in the beginning of a digest."""
_UNFINISHED = re.compile(r"\.run-[0-9a-f]{32}\.[0-9a-f]{8}\.npz")
"""Name of one that was being written when its process was killed."""
_TEXTS, _TABLES = ("status", "error"), ("metrics", "options", "fmus", "units")
_PROGRAM = ("core", "metrics", "runs")
"""Rooms of the package from which the outcome of a run follows, besides the FMUs."""
_DAMAGED = (
    OSError,
    ValueError,
    LookupError,
    TypeError,
    AttributeError,  # of a list in the place of a table
    OverflowError,  # of a whole number that no float holds
    EOFError,
    MemoryError,  # of an array that says that it is huge
    RuntimeError,  # a flag says that a member is encrypted, or packed in a way that is not known
    zipfile.BadZipFile,
    zlib.error,
)


@dataclass(frozen=True)
class KeptRuns:
    """Outcomes of complete runs in a folder.

    Attributes
    ----------
    folder : Path
        Is made with the first outcome.
    """

    folder: Path

    def find(
        self, key: str, system: SystemSpec, allow_unstable: bool, about: object = None
    ) -> Outcome | None:
        """Return the outcome of a run that has ended before.

        Parameters
        ----------
        key : str
            Of its task.
        system : System
            That is run.
        allow_unstable : bool
            Whether a step may be longer than the stable one.
        about : object, optional
            What else the outcome follows from, as plain data.

        Returns
        -------
        Outcome or None
            None where there is none, or its file is damaged.
        """
        file = self._file(system, _present(system), allow_unstable, about)
        if file is None or not file.is_file():
            return None
        with suppress(*_DAMAGED):
            return _read(file, key)
        return None

    def keep(
        self, system: SystemSpec, allow_unstable: bool, outcome: Outcome, about: object = None
    ) -> None:
        """Keep the outcome of a run of this system, under the digests of the FMUs that have run.

        The files may be others by now.

        Raises
        ------
        OSError
            It cannot be written, and will be run again.
        """
        file = self._file(system, outcome.fmus, allow_unstable, about)
        if file is not None:
            self.folder.mkdir(parents=True, exist_ok=True)
            _write(file, outcome)

    def keep_or_tell(
        self,
        system: SystemSpec,
        allow_unstable: bool,
        outcome: Outcome,
        note: Callable[[str], None],
        about: object = None,
    ) -> None:
        """Keep the outcome of a run of this system; say so if that cannot be done."""
        try:
            self.keep(system, allow_unstable, outcome, about)
        except OSError as error:
            note(f"runs that have ended cannot be kept in {self.folder}: {error.strerror}")

    def clear(self) -> None:
        """Remove all outcomes, and the folder if it holds nothing else."""
        for file in [*self.folder.glob("run-*.npz"), *self.folder.glob(".run-*.npz")]:
            is_own = _NAME.fullmatch(file.name) or _UNFINISHED.fullmatch(file.name)
            if is_own and file.is_file() and not file.is_symlink():
                file.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def _file(
        self,
        system: SystemSpec,
        fmus: Mapping[str, str] | None,
        allow_unstable: bool,
        about: object,
    ) -> Path | None:
        """Return the file of a run with FMUs of these digests; None without digests of all."""
        if fmus is None or fmus.keys() != system.components.keys():
            return None
        content = {
            "system": system.model_dump(mode="json"),
            "fmus": dict(fmus),
            "allow_unstable": allow_unstable,
            "about": about,
            "program": program_stamp(),
            "versions": versions("numpy", "fmpy"),
        }
        text = json.dumps(content, sort_keys=True, default=str)
        return self.folder / f"run-{hashlib.sha256(text.encode()).hexdigest()[:32]}.npz"


def begun(place: Path) -> list[Path]:
    """Return the folders of analyses that have begun and not ended, in the folder of their results.

    Parameters
    ----------
    place : Path
        In which results lie, ``results`` for instance.
    """
    found = [*place.glob(f"*/{FINISHED}/{ASKED}"), *place.glob(f".*-finished-trials/{ASKED}")]
    return sorted(file.parent for file in found)


def _present(system: SystemSpec) -> dict[str, str] | None:
    """Return the digests of a system's FMUs; None if its components are not FMU files."""
    fmus = {name: Path(spec.fmu) for name, spec in system.components.items()}
    if not all(fmu.is_file() for fmu in fmus.values()):
        return None
    return {name: _sha256(fmu) for name, fmu in fmus.items()}


def _sha256(file: Path) -> str:
    status = file.stat()
    return _sha256_of(file, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=256)
def _sha256_of(file: Path, _changed: int, _size: int) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def program_stamp() -> str:
    """Return a digest of the sources that carry out a run."""
    return sources_digest(*_PROGRAM)


def _write(file: Path, outcome: Outcome) -> None:
    import numpy as np

    facts = {name: value for name, value in asdict(outcome).items() if name != "series"}
    facts["columns"] = list(outcome.series)
    arrays: dict[str, Any] = {
        f"column-{i}": column for i, column in enumerate(outcome.series.values())
    }
    words = np.frombuffer(json.dumps(facts).encode(), np.uint8)
    with whole_file(file) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(stream, facts=words, **arrays)


def _read(file: Path, key: str) -> Outcome:
    import numpy as np

    with np.load(file, allow_pickle=False) as stored:
        facts: Mapping[str, Any] = json.loads(stored["facts"].tobytes())
        columns = facts["columns"]
        series = {name: stored[f"column-{i}"] for i, name in enumerate(columns)}
    rest = {name: value for name, value in facts.items() if name not in ("columns", "key")}
    rest["warnings"] = tuple(rest["warnings"])
    outcome = Outcome(key, series=series, **rest)
    if not (_is_formed(outcome) and _is_of_rows(series)):
        raise ValueError("it has values of another kind")
    return outcome


def _is_formed(outcome: Outcome) -> bool:
    """Tell whether the facts of an outcome are of their types, and its numbers finite."""
    numbers = [*outcome.metrics.values(), outcome.wall_time]
    return (
        all(isinstance(getattr(outcome, name), str) for name in _TEXTS)
        and all(isinstance(getattr(outcome, name), dict) for name in _TABLES)
        and all(isinstance(value, str) for value in outcome.fmus.values())
        and all(isinstance(value, str) for value in outcome.units.values())
        and all(isinstance(text, str) for text in outcome.warnings)
        and all(type(value) in (int, float) and math.isfinite(value) for value in numbers)
        and outcome.failed_at is None  # what is kept is complete
    )


def _is_of_rows(series: Mapping[str, Any]) -> bool:
    """Tell whether all columns are finite numbers, one for each row."""
    import numpy as np

    kinds = {(column.dtype, column.shape) for column in series.values()}
    return (
        all(isinstance(name, str) for name in series)
        and all(dtype == np.float64 and len(shape) == 1 for dtype, shape in kinds)
        and len(kinds) <= 1
        and all(np.isfinite(column).all() for column in series.values())
    )

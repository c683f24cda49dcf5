"""Parts of a long computation that have ended, kept until all have: what is killed goes on there.

A file for some parts that were computed one after the other, named by everything that they follow
from. It has numbers, is written whole, and one that is damaged is as if it were not there. Other
files in the folder are the user's, and stay.
"""

import hashlib
import re
import time
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .files import whole_file

Arrays = Mapping[str, Any]
"""Arrays of a file, by name."""
INTERVAL = 5.0
"""Time (s) after which parts are written down: what a kill may cost."""
_DAMAGED = (OSError, ValueError, LookupError, EOFError, MemoryError, RuntimeError)
_DAMAGED_ARCHIVE = (zipfile.BadZipFile, zlib.error)


@dataclass
class KeptParts:
    """Files of parts in a folder.

    Attributes
    ----------
    folder : Path
        Is made with the first parts that are kept.
    kind : str
        Of the parts: ``trials``, ``values``. Their files' names begin with it.
    """

    folder: Path
    kind: str
    _written: float = field(default_factory=time.monotonic, init=False)
    _has_room: bool = field(default=True, init=False)

    @property
    def is_due(self) -> bool:
        """Whether the parts that wait are to be written down."""
        return time.monotonic() - self._written > INTERVAL

    def read(self, digest: str, take: Callable[[int, Arrays], None]) -> None:
        """Hand over what is kept, file by file in the order of their numbers.

        Parameters
        ----------
        digest : str
            Of everything that the parts follow from, see :func:`digest_of`.
        take : callable
            Called with number and content of a file; one that it refuses with a ValueError or a
            LookupError is as if it were not there, as a damaged one is.
        """
        for file in self._files(digest):
            with suppress(*_DAMAGED, *_DAMAGED_ARCHIVE):
                with np.load(file, allow_pickle=False) as stored:
                    content = {name: stored[name] for name in stored.files}
                take(_number(file), content)

    def next_number(self, digest: str) -> int:
        """Return the number after that of the last file, damaged ones included."""
        return max(map(_number, self._files(digest)), default=-1) + 1

    def write(self, digest: str, contents: Mapping[int, Arrays]) -> None:
        """Write files by their numbers.

        Where the disk is full, or cannot be written, everything that is kept is removed: the
        results need the room.
        """
        try:
            for number, arrays in contents.items() if self._has_room else ():
                self.folder.mkdir(parents=True, exist_ok=True)
                file = self.folder / f"{self.kind}-{digest}-{number:012d}.npz"
                with whole_file(file) as place, place.open("wb") as stream:
                    np.savez(stream, **arrays)
        except OSError:
            self._has_room = False
            self.clear()
        self._written = time.monotonic()

    def clear(self) -> None:
        """Remove everything that is kept, and the folder if it holds nothing else."""
        unfinished = re.compile(rf"\.{self.kind}-[0-9a-f]{{32}}-\d{{12}}\.[0-9a-f]{{8}}\.npz")
        found = self.folder.glob(f".{self.kind}-*.npz")
        killed = [file for file in found if unfinished.fullmatch(file.name)]
        for file in [*self._files(), *(file for file in killed if not file.is_symlink())]:
            file.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def _files(self, digest: str = "") -> list[Path]:
        """Return the files of these parts in the folder, of one computation or of all."""
        name = re.compile(rf"{self.kind}-[0-9a-f]{{32}}-\d{{12}}\.npz")
        found = sorted(self.folder.glob(f"{self.kind}-{digest}*.npz"))
        return [file for file in found if name.fullmatch(file.name) and not file.is_symlink()]


def _number(file: Path) -> int:
    return int(file.stem.rpartition("-")[2])


def digest_of(*about: Any) -> str:
    """Return a digest of everything that parts follow from.

    Parameters
    ----------
    *about
        Numbers, texts, arrays, dataclasses, and sequences and mappings of them.

    Returns
    -------
    str
        32 hexadecimal digits.
    """
    digest = hashlib.sha256()
    for part in _bytes_of(about):
        digest.update(part)
    return digest.hexdigest()[:32]


def _bytes_of(value: Any) -> Iterator[bytes]:
    if isinstance(value, np.ndarray):
        yield repr((value.dtype.str, value.shape)).encode()
        yield value.tobytes()
    elif is_dataclass(value):
        for entry in fields(value):
            yield entry.name.encode()
            yield from _bytes_of(getattr(value, entry.name))
    elif isinstance(value, Mapping):
        yield from _bytes_of(list(value.items()))
    elif isinstance(value, Sequence) and not isinstance(value, str | bytes):
        yield f"{len(value)} entries".encode()
        for entry in value:
            yield from _bytes_of(entry)
    else:
        yield repr(value).encode()

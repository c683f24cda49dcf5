"""The zip archive of an FMU or of an SSP, also one that was packed on Windows or by hand."""

import errno
import os
import posixpath
import stat
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import IO

from ...files import naming
from ...platforms import LONGEST_HEAD
from ..input_text import shown

MOST_UNPACKED = 2 << 30
"""Largest size (bytes) of an unpacked archive."""
MOST_DESCRIPTION = 256 << 20
"""Largest size (bytes) of a description in it."""
MOST_MEMBERS = 100_000
"""Largest number of files in it."""
_END_MARK = b"PK\x05\x06"
"""Begins the record at the end of an archive."""
_LONGEST_END = 22 + (1 << 16)
"""Largest size (bytes) of that record, with a comment."""
_UNTOLD = 0xFFFF
"""Number of members in it where there are more than it can tell."""
_AT_ONCE = 1 << 20
"""Bytes that are unpacked at a time."""
_UNREADABLE = (
    OSError,
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    NotImplementedError,
    RuntimeError,
    OverflowError,
    ValueError,
)
"""Errors that the reader raises for members that are damaged, encrypted, or packed oddly."""


class ArchiveError(Exception):
    """An archive that cannot be read.

    Attributes
    ----------
    remedy : str
        Something to do about it.
    """

    def __init__(self, what: str, remedy: str = "export it again") -> None:
        self.remedy = remedy
        super().__init__(what)


class Archive:
    """An archive whose members have clean names. A context manager.

    Backslashes count as slashes, and ``./`` in front of a name as nothing.

    Parameters
    ----------
    file : Path or binary file
        Of the archive.
    kind : str
        What it is to be, with its article, for messages.

    Raises
    ------
    ArchiveError
        It is no zip archive, or has a member that is a link or would lie outside of it.
    """

    def __init__(self, file: Path | IO[bytes], kind: str = "an FMU") -> None:
        try:
            self._zip = zipfile.ZipFile(file)
        except _UNREADABLE as error:
            if isinstance(error, OSError) and error.filename is not None:  # it cannot be opened
                raise
            raise ArchiveError(f"is not {kind}: not a zip archive") from error
        listed = self._zip.infolist()
        told = _number_told(file)
        if told not in (_UNTOLD, len(listed)):
            raise ArchiveError(f"is damaged: it names {len(listed)} of its {told} files")
        for info in listed:
            if stat.S_ISLNK(info.external_attr >> 16):
                raise ArchiveError(f"has a member that is a link: {shown(info.filename)}")
        self._members = {_clean(info.filename): info for info in listed}

    def __enter__(self) -> "Archive":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._zip.close()

    @property
    def names(self) -> set[str]:
        """Names of the files in the archive, in its order."""
        return {name for name, info in self._members.items() if not _is_folder(info)}

    def check_size(self) -> None:
        """Refuse an archive that would fill the disk.

        Raises
        ------
        ArchiveError
            Too many files, or too large ones.
        """
        size = sum(info.file_size for info in self._members.values())
        if size > MOST_UNPACKED or len(self._members) > MOST_MEMBERS:
            what = (
                f"unpacks to {size / 1e9:.2g} GB in {len(self._members):,} files, and at most "
                f"{MOST_UNPACKED / 1e9:.2g} GB in {MOST_MEMBERS:,} are taken"
            )
            raise ArchiveError(what, "leave out of its resources what is not needed")

    def read(self, name: str, most: int) -> bytes | None:
        """Return the content of a member; None if there is none of this name.

        Parameters
        ----------
        name : str
            Of the member.
        most : int
            Largest size (bytes).

        Raises
        ------
        ArchiveError
            It is damaged or too large.
        """
        info = self._members.get(name)
        if info is None:
            return None
        if info.file_size > most:
            what = (
                f"has a {name} of {info.file_size / 1e6:.3g} MB; at most {most / 1e6:.3g} are read"
            )
            raise ArchiveError(what)
        return b"".join(self._parts(name, info))

    def head(self, name: str) -> bytes:
        """Return the first bytes of a file in it, :data:`LONGEST_HEAD` at most.

        Parameters
        ----------
        name : str
            Of a file in the archive.

        Raises
        ------
        ArchiveError
            It is damaged.
        """
        return next(self._parts(name, self._members[name]), b"")[:LONGEST_HEAD]

    def _parts(self, name: str, info: zipfile.ZipInfo) -> Iterator[bytes]:
        """Yield the content of a member in parts; errors of whoever takes them are not its own."""
        try:
            with self._zip.open(info) as source:
                while part := source.read(_AT_ONCE):
                    yield part
        except _UNREADABLE as error:
            raise ArchiveError(f"cannot be unpacked: {name}: {error}") from error

    def unpack(self, folder: Path, under: str = "") -> None:
        """Write all files into a folder.

        Parameters
        ----------
        folder : Path
            Exists.
        under : str
            Begin of the names of the files that are written; by default all are.

        Raises
        ------
        ArchiveError
            A member is damaged.
        """
        self.check_size()
        chosen = {n: info for n, info in self._members.items() if n.startswith(under)}
        for name, info in chosen.items():
            target = folder / name
            with _possible(name):
                (target if _is_folder(info) else target.parent).mkdir(parents=True, exist_ok=True)
            if not _is_folder(info):
                with _possible(name), naming(target), target.open("wb") as copy:
                    for part in self._parts(name, info):
                        copy.write(part)


@contextmanager
def _possible(name: str) -> Iterator[None]:
    """Refuse a name that no file can have here: too long, or that of a file and of a folder."""
    try:
        yield
    except (FileExistsError, IsADirectoryError, NotADirectoryError) as error:
        raise ArchiveError(f"has a file and a folder of the same name: {name}") from error
    except OSError as error:
        if error.errno != errno.ENAMETOOLONG:
            raise
        raise ArchiveError(f"has a member whose name is too long: {shown(name)}") from error


def _number_told(file: Path | IO[bytes]) -> int:
    """Return the number of members that the end of an archive tells.

    The reader does not look at it: where a damaged entry hides those behind it, they are missing.
    """
    if isinstance(file, Path):
        with file.open("rb") as opened:
            return _number_told(opened)
    length = file.seek(0, os.SEEK_END)
    file.seek(max(0, length - _LONGEST_END))
    end = file.read()
    at = end.rfind(_END_MARK)
    return int.from_bytes(end[at + 10 : at + 12], "little") if at >= 0 else _UNTOLD


def _is_folder(info: zipfile.ZipInfo) -> bool:
    is_called_so = info.filename.endswith(("/", "\\")) or stat.S_ISDIR(info.external_attr >> 16)
    return is_called_so and info.file_size == 0


def _clean(name: str) -> str:
    """Return the name of a member with slashes, without steps that lead nowhere."""
    clean = posixpath.normpath(name.replace("\\", "/"))
    if clean.startswith(("/", "../")) or clean == ".." or ":" in clean.split("/")[0]:
        raise ArchiveError(f"has a member outside of it: {name!r}")
    return clean

"""The files of an SSP: an archive, or a folder with its description."""

import hashlib
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path, PurePosixPath
from urllib.parse import unquote, urlsplit

from rockshed.components.common.cache import cache_path
from rockshed.components.common.kept import folder_problem, make_private

from ..core.errors import InputRefused, Problem
from ..core.fmu.archive import Archive, ArchiveError
from ..temporary import TemporaryFolder

MAIN = "SystemStructure.ssd"
"""The description of an SSP, or of its default variant."""
_KEPT = ("resources", "extra", "documentation")
"""Folders of an SSP, beside its descriptions (SSP 2.0, chapter 3)."""
UNPACKED = "ssp"
"""Folder, among kept code, of unpacked archives."""
_DIGITS = 32
"""Of the hash that names the folder of an unpacked archive."""


class OutsideError(ValueError):
    """A reference to something that is not inside the SSP."""


@dataclass(frozen=True)
class Package:
    """An SSP as a folder.

    Attributes
    ----------
    path : Path
        As it was named: archive, folder or description.
    folder : Path
        With all files.
    main : str
        Name of the description.
    """

    path: Path
    folder: Path
    main: str = MAIN

    @property
    def description(self) -> bytes:
        """Content of the file of the description, as it stands there."""
        return (self.folder / self.main).read_bytes()

    def resolve(self, uri: str, base: str = "") -> Path:
        """Return the file that a reference means.

        Parameters
        ----------
        uri : str
            Relative to the file in which it stands.
        base : str
            That file, by its name in the SSP; by default the description.

        Returns
        -------
        Path
            It need not be there.

        Raises
        ------
        OutsideError
            It means no file, or one outside the SSP.
        """
        parts = urlsplit(uri)
        if parts.scheme or parts.netloc or parts.query:
            raise OutsideError(f"{uri} is no file of the SSP; nothing is fetched from elsewhere")
        name = unquote(parts.path)
        if not name or "\0" in name or name.startswith("/") or "\\" in name:
            raise OutsideError(f"{uri!r} names no file of the SSP")
        parent = PurePosixPath(base or self.main).parent
        file = Path(os.path.normpath(self.folder / parent / name))
        inside = Path(os.path.realpath(self.folder))
        if not Path(os.path.realpath(file)).is_relative_to(inside):
            raise OutsideError(f"{uri} lies outside of the SSP")
        return file

    def named(self, text: str) -> str:
        """Return a text in which files of the SSP have the names of the SSP: ``lab.ssp/...``."""
        place = self.path.parent if self.path.suffix.lower() == ".ssd" else self.path
        return text.replace(f"{self.folder}{os.sep}", f"{place}/")

    def name_of(self, file: Path) -> str:
        """Return the name in the SSP of one of its files."""
        return file.relative_to(self.folder).as_posix()

    def names(self) -> Iterator[str]:
        """Yield the names of all files: descriptions and what lies in the folders of an SSP."""
        found = [file for file in self.folder.iterdir() if file.suffix in (".ssd", ".ssv", ".ssm")]
        for kept in _KEPT:
            found += (self.folder / kept).rglob("*")
        for file in sorted(found):
            if file.is_file() and not file.is_symlink():
                yield self.name_of(file)


def is_ssp(target: str | Path) -> bool:
    """Tell whether a target is meant as an SSP: its archive, its description or its folder."""
    path = Path(target)
    if path.suffix.lower() in (".ssp", ".ssd"):
        return True
    return os.path.isfile(path / MAIN)  # Path.is_file raises where a name is too long


def open_package(path: Path) -> Package:
    """Open an SSP; an archive is unpacked into a folder that is kept.

    Parameters
    ----------
    path : Path
        Archive (``.ssp``), folder, or description (``.ssd``) in its folder.

    Returns
    -------
    Package

    Raises
    ------
    InputRefused
        There is none, it is damaged, or holds too much or anything outside of it.
    """
    if os.path.isdir(path):
        if not (path / MAIN).is_file():
            problem = Problem(str(path), f"has no {MAIN}", "name a folder of an SSP")
            raise InputRefused([problem])
        return Package(path, path.absolute())
    if not os.path.isfile(path):
        raise InputRefused([Problem(str(path), "there is no such file", "correct the path")])
    if path.suffix.lower() == ".ssd":
        return Package(path, path.absolute().parent, path.name)
    try:
        with path.open("rb") as file, Archive(file, "an SSP") as archive:
            archive.check_size()
            if MAIN not in archive.names:
                raise ArchiveError(f"is not an SSP: there is no {MAIN} in it")
            return Package(path, _unpacked(file, archive))
    except ArchiveError as error:
        raise InputRefused([Problem(str(path), str(error), error.remedy)]) from error
    except OSError as error:
        what = f"cannot be unpacked: {error.strerror or error}"
        raise InputRefused([Problem(str(path), what, "make room, or correct the path")]) from error


def _unpacked(file: BufferedReader, archive: Archive) -> Path:
    """Return the folder of an archive, by the hash of the file that it is read from.

    Runs that are gone on with find the same files there.
    """
    file.seek(0)
    digest = hashlib.file_digest(file, "sha256").hexdigest()[:_DIGITS]
    try:
        place = cache_path() / UNPACKED
        make_private(place)
        problem = folder_problem(place)
    except (OSError, RuntimeError) as error:
        problem = str(error)
    if problem:  # nobody else may put FMUs there, which are code
        return _unpack_temporarily(archive)
    folder = place / digest
    if not all((folder / name).is_file() for name in archive.names):
        _unpack_into(folder, archive)
    return folder


def _unpack_into(folder: Path, archive: Archive) -> None:
    """Unpack beside a folder, then put the whole into its place."""
    with TemporaryFolder("rockshed_ssp_", folder.parent) as temporary:
        made = temporary / "ssp"
        made.mkdir()
        archive.unpack(made)
        shutil.rmtree(folder, ignore_errors=True)
        try:
            os.replace(made, folder)
        except OSError:  # another process was faster
            if not folder.is_dir():
                raise


_temporary: list[TemporaryFolder] = []
"""Folders of this process; they go with it."""


def _unpack_temporarily(archive: Archive) -> Path:
    _temporary.append(TemporaryFolder("rockshed_ssp_"))
    folder = Path(_temporary[-1].name)
    archive.unpack(folder)
    return folder

"""Files that are kept between runs and hold code: taken whole, unchanged and of this user, or not.

Machine code in a file is executed, and an index of numba is a pickle, which can execute anything.
Somebody else may have planted such a file, a full disk or a power cut may have cut it short, and a
bit may have flipped. So a folder is used only where nobody but this user (and root) can write, and
each file begins with its length and a checksum. What does not fit is as good as absent: the code is
compiled anew.

Nothing here imports numba.
"""

import hashlib
import os
import secrets
import stat
import struct
import sys
from pathlib import Path

_HEADER = struct.Struct("<16sQ32s")
"""Begins a file: mark, length of the content, SHA-256 of the content."""
_MARK = b"rockshed kept v1"
_PRIVATE = 0o700
_OTHERS = stat.S_IWOTH
_GROUP = stat.S_IWGRP


def folder_problem(folder: Path) -> str:
    """Return why code in a folder cannot be trusted.

    Parameters
    ----------
    folder : Path
        It need not be there; then its nearest folder that is there counts.

    Returns
    -------
    str
        The reason in words; empty if there is none. Windows guards folders of a user by itself.
    """
    if sys.platform == "win32":
        return ""
    whole = Path(os.path.realpath(folder))
    for place in (whole, *whole.parents):
        try:
            found = place.stat()
        except FileNotFoundError:
            continue
        except OSError as error:
            return f"{place} cannot be looked at: {error.strerror or error}"
        if problem := _writers_problem(found, may_be_shared=place != whole):
            return f"{place} {problem}"
    return ""


def _writers_problem(found: os.stat_result, may_be_shared: bool) -> str:
    """Return who else can put files there; a shared folder such as /tmp protects what is in it."""
    if found.st_uid not in (0, os.geteuid()):
        return f"belongs to another user (number {found.st_uid})"
    if may_be_shared and found.st_mode & stat.S_ISVTX:
        return ""
    if found.st_mode & _OTHERS:
        return "can be written by others"
    if found.st_mode & _GROUP and not _is_private_group(found.st_gid, found.st_uid):
        return "can be written by a group"
    return ""


def _is_private_group(group: int, owner: int) -> bool:
    """Tell whether a group is root's, or one that a system makes for a single user."""
    import grp
    import pwd

    try:
        entry, user = grp.getgrgid(group), pwd.getpwuid(owner)
    except KeyError:
        return False
    return group == 0 or (entry.gr_name == user.pw_name and set(entry.gr_mem) <= {user.pw_name})


def make_private(folder: Path) -> None:
    """Make a folder and the ones above it, where this user alone can write.

    Parameters
    ----------
    folder : Path
        Nothing is changed where it is there.
    """
    if folder.is_dir():
        return
    make_private(folder.parent)
    folder.mkdir(mode=_PRIVATE, exist_ok=True)


def keep(file: Path, content: bytes) -> None:
    """Write a file for :func:`kept`: whole, on the disk, or not at all.

    Parameters
    ----------
    file : Path
        Its folder has to exist.
    content : bytes
        The content.
    """
    temporary = file.with_name(f".{secrets.token_hex(8)}.tmp")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    try:
        with os.fdopen(os.open(temporary, flags, 0o600), "wb") as target:
            target.write(_HEADER.pack(_MARK, len(content), hashlib.sha256(content).digest()))
            target.write(content)
            target.flush()
            os.fsync(target.fileno())
        os.replace(temporary, file)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def kept(file: Path) -> bytes | None:
    """Return the content of a file that :func:`keep` wrote.

    Parameters
    ----------
    file : Path
        The file.

    Returns
    -------
    bytes or None
        None where there is no such file, where it is not as it was written, or where somebody else
        could have written it.
    """
    try:
        with open(file, "rb") as source:
            if _file_problem(os.fstat(source.fileno())):
                return None
            return _content(source.read())
    except OSError:
        return None


def is_sound(file: Path) -> bool:
    """Tell whether a file would be taken."""
    return kept(file) is not None


def _file_problem(found: os.stat_result) -> str:
    if not stat.S_ISREG(found.st_mode):
        return "is no file"
    return "" if sys.platform == "win32" else _writers_problem(found, may_be_shared=False)


def _content(whole: bytes) -> bytes | None:
    if len(whole) < _HEADER.size:
        return None
    mark, length, digest = _HEADER.unpack_from(whole)
    content = whole[_HEADER.size :]
    if mark != _MARK or length != len(content) or digest != hashlib.sha256(content).digest():
        return None
    return content

"""Files that appear as a whole or not at all, whatever happens while they are written."""

import csv
import json
import os
import re
import secrets
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def naming(file: Path) -> Iterator[None]:
    """Name the file in an error of the system that names none: that of a full disk, for instance.

    Parameters
    ----------
    file : Path
        That is written.

    Raises
    ------
    OSError
        With a file name.
    """
    try:
        yield
    except OSError as error:
        if error.filename is not None:
            raise
        number = error.errno or _number_in(str(error))
        reason = os.strerror(number) if number else str(error)
        raise OSError(number, reason, str(file)) from error


def _number_in(text: str) -> int:
    """Return the number of the error in a text, as libraries put it there; 0 if there is none."""
    found = re.search(r"errno[ =]+(\d+)", text, re.IGNORECASE)
    return int(found[1]) if found else 0


@contextmanager
def whole_file(file: Path) -> Iterator[Path]:
    """Write a file elsewhere and put it into its place when the block ends.

    Parameters
    ----------
    file : Path
        Its folder has to exist. A file that is there already is replaced in one step.

    Yields
    ------
    Path
        Where to write: a name in the same folder that ends alike. After an exception it is removed
        and ``file`` stays as it was.
    """
    temporary = file.with_name(f".{file.stem}.{secrets.token_hex(4)}{file.suffix}")
    try:
        with naming(file):
            yield temporary
            os.replace(temporary, file)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def write_file(file: Path, content: str | bytes) -> None:
    """Write a file as a whole or not at all.

    Parameters
    ----------
    file : Path
        Its folder has to exist.
    content : str or bytes
        Text is written as UTF-8.
    """
    with whole_file(file) as temporary:
        temporary.write_bytes(content.encode() if isinstance(content, str) else content)


def write_json(file: Path, content: Any) -> None:
    """Write data as JSON, as a whole or not at all.

    Parameters
    ----------
    file : Path
        Its folder has to exist.
    content : object
        What JSON has no form for is written as its ``str``.
    """
    write_file(file, json.dumps(content, indent=2, default=str, ensure_ascii=False) + "\n")


def write_csv(file: Path, names: Iterable[str], columns: Iterable[Iterable[Any]]) -> None:
    """Write a table as CSV, as a whole or not at all.

    Parameters
    ----------
    file : Path
        Its folder has to exist.
    names : iterable of str
        Of the columns.
    columns : iterable of iterable
        All of one length.
    """
    with whole_file(file) as place, place.open("w", newline="", encoding="utf-8") as text:
        csv.writer(text).writerows([names, *zip(*columns, strict=True)])

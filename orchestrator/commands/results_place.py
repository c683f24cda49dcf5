"""The folder of the results that the user has named no folder for: it follows from a name."""

import json
import os
import re
from collections.abc import Callable, Mapping
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

from ..core.errors import InputRefused, Problem
from ..core.input_text import shown
from ..core.results.run_folder import RUN, refuse_other_content
from ..sites.source import SiteLike, site_source
from .options import RESULTS
from .screen import Screen

LONGEST_NAME = 150
"""Bytes of the name of a folder, at most; file systems take 255, and a run needs some of them."""
_FORBIDDEN = re.compile(
    r'[/\\:*?"<>|\x00-\x1f\x7f-\x9f]' if os.name == "nt" else r"[/\\\x00-\x1f\x7f-\x9f]"
)
"""Letters that a folder cannot have in its name."""
_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
"""Names that mean devices on Windows."""
_OWN_ENDINGS = (".running", ".old", ".lock")
"""Endings of the folders and files that a run makes beside its results."""

Origin = Mapping[str, Any]
"""Entries of ``run.json`` that say what was computed: the case, or the file of system or site."""


def folder_of_site(site: SiteLike, kind: str, screen: Screen) -> Path:
    """Return the folder of the results of a site.

    Parameters
    ----------
    site : path, mapping or Data
        The site; its name names the folder.
    kind : str
        Of the analysis.
    screen : Screen
        Of the command.

    Returns
    -------
    Path
        In the folder :data:`~rockshed.commands.options.RESULTS`.

    Raises
    ------
    InputRefused
        The site cannot be read, or its name cannot be that of a folder.
    """
    source = site_source(site)
    origin = {"kind": kind, "site_file": str(source.file)}
    return results_folder(source.name, source.places.of(("name",)), origin, screen)


def results_folder(name: str, where: str, origin: Origin, screen: Screen) -> Path:
    """Return the folder of the results of this name; results of something else stay.

    Parameters
    ----------
    name : str
        Of the system or site, any text.
    where : str
        Place of the name, for messages.
    origin : Origin
        What is going to be computed.
    screen : Screen
        Is told where the results go, if that is not the folder of the name.

    Returns
    -------
    Path
        ``results/NAME``; where there are results of another origin, ``results/NAME-2``, ...

    Raises
    ------
    InputRefused
        The name cannot be that of a folder.
    """
    if fault := name_fault(name):
        text = f"the name {shown(name)} {fault}, and would name the folder of the results"
        remedy = "give another name, or name the folder with --output-dir"
        raise InputRefused([Problem(where, text, remedy)])
    return free_folder(name, origin, provenance_in, screen)


def look_at_folder(folder: Path | None) -> Callable[[], None] | None:
    """Return a look at the folder that the user has named for results, if there is one.

    Parameters
    ----------
    folder : Path or None
        Where results of a run or of an analysis are to go.
    """
    return None if folder is None else partial(refuse_other_content, folder)


def look_at_place(folder: Path | None) -> Callable[[], None] | None:
    """Return a look at a named folder in which other files may stay.

    Parameters
    ----------
    folder : Path or None
        Where results of an analysis are to go.
    """
    return None if folder is None else partial(_refuse_file, folder)


def _refuse_file(folder: Path) -> None:
    if folder.is_file():
        raise InputRefused([Problem(str(folder), "is a file", "choose another folder")])


def provenance_in(folder: Path) -> Any:
    """Return what describes the run in a folder."""
    return json.loads((folder / RUN).read_text(encoding="utf-8"))


def free_folder(name: str, origin: Origin, read: Callable[[Path], Any], screen: Screen) -> Path:
    """Return the first folder of this name that holds no results of another origin.

    Parameters
    ----------
    name : str
        Of the folder.
    origin : Origin
        What is going to be computed.
    read : callable
        Returns the origin of the results in a folder.
    screen : Screen
        Is told where the results go, if that is not the folder of the name.

    Returns
    -------
    Path
        ``results/NAME``, or ``results/NAME-2``, ...
    """
    folder, said = free_place(name, origin, read)
    if said:
        screen.warn(said)
    return folder


def free_place(name: str, origin: Origin, read: Callable[[Path], Any]) -> tuple[Path, str]:
    """Return the folder of :func:`free_folder`, and what is to be said of it once it is used.

    Parameters
    ----------
    name : str
        Of the folder.
    origin : Origin
        What is going to be computed.
    read : callable
        Returns the origin of the results in a folder.

    Returns
    -------
    folder : Path
        ``results/NAME``, or ``results/NAME-2``, ...
    said : str
        Why it is not that of the name; empty where it is.
    """
    first = RESULTS / name
    places = (first if number == 1 else RESULTS / f"{name}-{number}" for number in count(1))
    folder = next(place for place in places if not _is_of_another(place, origin, read))
    told = f"{first} holds other results, which stay; these go into {folder}"
    return folder, "" if folder == first else told


def name_fault(name: str) -> str:
    """Return why a name cannot be that of a folder inside another one; empty if it can.

    Parameters
    ----------
    name : str
        Any text.

    Returns
    -------
    str
        Continues the name.
    """
    if found := _FORBIDDEN.search(name):
        return f"has the character {found.group()!r}"
    if not name.strip() or name != name.strip() or name.startswith(".") or name.endswith("."):
        return "begins or ends with a dot or a blank"
    if len(name.encode("utf-8", "surrogatepass")) > LONGEST_NAME:
        return f"is longer than {LONGEST_NAME} bytes"
    if name.lower().endswith(_OWN_ENDINGS):
        return f"ends in {name[name.rindex('.') :]}, as what a run makes beside its results does"
    return "is that of a device" if _DEVICES.fullmatch(name) else ""


def _is_of_another(folder: Path, origin: Origin, read: Callable[[Path], Any]) -> bool:
    """Tell whether a folder holds the results of something else; one that is no run's is none."""
    try:
        found = read(folder)
        return any(
            _resolved(key, found.get(key)) != _resolved(key, value) for key, value in origin.items()
        )
    except (OSError, ValueError, RecursionError, LookupError, TypeError, AttributeError):
        return False


def _resolved(key: str, value: Any) -> Any:
    """Return an entry such that two spellings of one file are equal."""
    is_file = key.endswith("_file") and isinstance(value, str) and "\0" not in value
    return Path(value).resolve() if is_file else value

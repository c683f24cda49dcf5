"""Probes of the archive, which is looked at without being unpacked."""

import posixpath
import stat
import zipfile
from pathlib import PurePosixPath

from ...core.fmu.archive import MOST_MEMBERS, MOST_UNPACKED
from ...platforms import NoBinaryError, this_machine
from ..subject.subject import Subject
from ..subject.variables import listed
from ..verdicts import Seen, failed, passed, warned

_MOST_PRESSED = 1000
"""Largest ratio of the sizes of a member unpacked and packed."""
_KNOWN = ("modelDescription.xml", "binaries", "sources", "resources", "documentation", "extra")
_KNOWN_3 = (*_KNOWN, "terminalsAndIcons")
_KNOWN_2 = (*_KNOWN, "model.png", "terminalsAndIcons")
"""Entries at the top of an FMU; terminals came with FMI 3.0 and are used for FMI 2.0 too."""


def names(subject: Subject) -> Seen:
    """Look for names that lead out of the FMU, links, and names that occur twice."""
    with zipfile.ZipFile(subject.file) as archive:
        members = archive.infolist()
    outside = [m.filename for m in members if _leads_out(m.filename)]
    if outside:
        return failed(
            f"{listed(outside)} would be written outside the folder of the FMU",
            "pack it with relative names",
        )
    links = [m.filename for m in members if stat.S_ISLNK(m.external_attr >> 16)]
    if links:
        return failed(f"{listed(links)} is a symbolic link", "pack the file itself")
    seen = [posixpath.normpath(m.filename) for m in members]
    twice = sorted({name for name in seen if seen.count(name) > 1})
    if twice:
        return warned(f"{listed(twice)} is in it twice", "pack each file once")
    return passed(f"{len(members)} members, all inside the FMU")


def _leads_out(name: str) -> bool:
    clean = posixpath.normpath(name.replace("\\", "/"))
    return clean.startswith(("/", "../")) or clean == ".." or ":" in clean.split("/")[0]


def size(subject: Subject) -> Seen:
    """Look for archives that would fill the disk, and damaged members."""
    with zipfile.ZipFile(subject.file) as archive:
        members = archive.infolist()
        total = sum(member.file_size for member in members)
        if total > MOST_UNPACKED or len(members) > MOST_MEMBERS:
            return failed(
                f"it unpacks to {total / 1e9:.2g} GB in {len(members):,} files",
                f"keep to {MOST_UNPACKED / 1e9:.2g} GB and {MOST_MEMBERS:,} files",
            )
        pressed = [
            member.filename
            for member in members
            if member.file_size > _MOST_PRESSED * max(1, member.compress_size) > 0
        ]
        if pressed:
            return warned(
                f"{listed(pressed)} is more than {_MOST_PRESSED} times as large unpacked",
                "leave it out if it is padding; tools may take it for an attack",
            )
        bad = archive.testzip()
    if bad:
        return failed(f"{bad} is damaged: its checksum is wrong", "pack it again")
    return passed(f"{total / 1e6:.3g} MB in {len(members)} members, none damaged")


def layout(subject: Subject) -> Seen:
    """Look for the library of this machine, and for files where FMI has none."""
    with zipfile.ZipFile(subject.file) as archive:
        listed_names = [member.filename for member in archive.infolist()]
    if slashed := [name for name in listed_names if "\\" in name]:
        return failed(f"{listed(slashed)} has backslashes", "pack it with slashes")
    try:
        place = subject.library.parent.name
    except NoBinaryError as error:
        return failed(f"it {error}", error.remedy)
    known = _KNOWN_3 if subject.version == 3 else _KNOWN_2
    odd = sorted({PurePosixPath(name).parts[0] for name in listed_names} - set(known))
    if odd:
        return warned(f"{listed(odd)} stands where FMI has nothing", "put it into extra/")
    standard = this_machine().folders(subject.version)[0]
    if place != standard:
        return warned(
            f"its library for {standard} is in binaries/{place}, where not every tool looks for it",
            f"put it into binaries/{standard}, as FMI has it",
        )
    return passed("description and library are where FMI has them")

"""Files inside an FMU about its license and about what it needs that it does not bring."""

import re
from collections.abc import Mapping
from importlib.metadata import distribution

from ..parts import Files

LICENSE = "documentation/licenses/license.txt"
NEEDED = "documentation/externalDependencies.txt"
_NEEDED_BY_PYTHON = """\
The kernels of this FMU are carried out by the Python of the program that loads it.

Needed, besides a program that gives its symbols to the libraries that it loads
(fmpy, libcosim and ecos in Python do):

Python {python}
numpy {numpy}
numba {numba}

Nothing is downloaded or installed. Compiled kernels are kept in the user's cache folder, or in
the one that the environment variable ROCKSHED_CACHE_DIR names. The native FMU of the same
component needs no Python.
"""


def license_files() -> Files:
    """Return the license of this program, under which the FMU stands."""
    return {LICENSE: license_text("rockshed")}


def license_text(package: str) -> bytes:
    """Return the text of a package's license, which has to accompany every copy.

    Parameters
    ----------
    package : str
        Name of an installed distribution.

    Returns
    -------
    bytes
        Its files LICENSE, one after the other.
    """
    texts = [
        file.read_binary() for file in distribution(package).files or () if file.name == "LICENSE"
    ]
    return b"\n".join(texts)


def needed_by_python() -> Files:
    """Return what an FMU with Python needs on the computer, as the package's own metadata say."""
    about = distribution("rockshed").metadata
    wanted = {"python": about["Requires-Python"] or ""}
    for line in about.get_all("Requires-Dist") or ():
        for package in ("numpy", "numba"):
            if line.startswith(package) and ";" not in line:
                wanted[package] = line.removeprefix(package).strip()
    return {NEEDED: _NEEDED_BY_PYTHON.format(**wanted).encode()}


_NEEDED_BY_NATIVE = """\
The binaries of this FMU need nothing but an operating system with its C library:

{libraries}

Nothing is downloaded or installed, and no program is started.
"""


def needed_by_native(libraries: Mapping[str, tuple[str, bytes]]) -> Files:
    """Return what the binaries of a native FMU need on the computer.

    Parameters
    ----------
    libraries : mapping of str to (str, bytes)
        Processor that a library is compiled for, and its content, by its path.
    """
    lines = [
        f"{path}: processor {processor} or later{_c_library(content)}"
        for path, (processor, content) in libraries.items()
    ]
    return {NEEDED: _NEEDED_BY_NATIVE.format(libraries="\n".join(lines)).encode()}


def _c_library(content: bytes) -> str:
    """Return the C library that a library for Linux asks for, in words; empty for others."""
    asked = re.findall(rb"GLIBC_([0-9.]+)\0", content)
    if not asked:
        return ""
    newest = max(asked, key=lambda version: tuple(map(int, version.split(b"."))))
    return f", glibc {newest.decode()} or later"

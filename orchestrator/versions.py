"""Versions of Python and of packages, for records of what has computed something."""

import platform
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


@cache
def version_of(package: str) -> str | None:
    """Return the version of an installed package, None where there is none.

    Parameters
    ----------
    package : str
        Name under which it is installed.
    """
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def versions(*packages: str) -> dict[str, str | None]:
    """Return the versions of Python, rockshed and other packages by name.

    Parameters
    ----------
    *packages : str
        Names under which they are installed.
    """
    names = ("rockshed", *packages)
    return {"python": platform.python_version(), **{name: version_of(name) for name in names}}


@cache
def sources_digest(*rooms: str) -> str:
    """Return a digest of the Python sources in some rooms of this package.

    Parameters
    ----------
    *rooms : str
        Names of folders beside this module.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    digest = sha256()
    for room in rooms:
        for file in sorted((Path(__file__).parent / room).rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()

"""Versions of Python and of packages, for records of what has computed something."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version


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

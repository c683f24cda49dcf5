"""Where a site comes from: a TOML file, or the same data made in Python."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..input_files.form import Data, read_toml
from ..input_files.places import Places

SiteLike = str | Path | Mapping[str, Any] | Data
"""Path of a site file, or its content as a mapping or as data of the right form."""


@dataclass(frozen=True)
class SiteSource:
    """Content of a site, and where its values stand.

    Attributes
    ----------
    content : mapping
        Keys and values as in a site file.
    places : Places
        Of the values.
    file : Path or None
        None where the site was made in Python.
    """

    content: Mapping[str, Any]
    places: Places
    file: Path | None = None

    @property
    def folder(self) -> Path:
        """Folder from which the relative paths in the site count."""
        return self.file.parent if self.file else Path()

    def plain(self) -> Any:
        """Return the site as plain data that mean the same in any folder: its file, or content."""
        return str(self.file.absolute()) if self.file else self.content

    @property
    def name(self) -> str:
        """Name of the site: its own, or that of its file."""
        own = self.content.get("name")
        if own and isinstance(own, str):
            return own
        return self.file.stem if self.file else "site"


def site_source(site: SiteLike, called: str = "site", **replaced: Any) -> SiteSource:
    """Read a site.

    Parameters
    ----------
    site : path, mapping or Data
        A TOML file, or its content.
    called : str
        What messages call one that was made in Python.
    **replaced
        Values of keys that replace those of the site; None leaves the site's.

    Returns
    -------
    SiteSource
        Content and places, not yet checked.

    Raises
    ------
    InputRefused
        The file cannot be read, or is not TOML.
    """
    changes = {key: value for key, value in replaced.items() if value is not None}
    if isinstance(site, Data):
        content = site.model_dump(by_alias=True, exclude_unset=True)
        return SiteSource({**content, **changes}, Places(called, replaced=tuple(changes)))
    if isinstance(site, Mapping):
        return SiteSource({**site, **changes}, Places(called, replaced=tuple(changes)))
    content, places = read_toml(Path(site))
    return SiteSource({**content, **changes}, replace(places, replaced=tuple(changes)), Path(site))

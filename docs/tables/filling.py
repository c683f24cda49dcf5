"""Blocks of pages that are written from kept results."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from .convergence import TABLES as CONVERGENCE
from .kept import NotKeptError
from .masters import TABLES as MASTERS
from .other_papers import TABLES as OTHERS
from .platforms import TABLES as PLATFORMS
from .sonoda1993 import TABLES as SONODA
from .systems import TABLES as SYSTEMS

ROOT = Path(__file__).resolve().parents[2]
PAGES = (
    "README.md",
    "docs/sonoda1993.md",
    "docs/convergence.md",
    "docs/impact-systems.md",
    "docs/compatibility.md",
    "docs/masters.md",
)
"""Pages with blocks."""
BLOCK = re.compile(r"^<!-- table: ([\w.-]+)/([\w-]+) -->\n(.*?)^<!-- end -->$", re.M | re.S)
"""Paper, name, text."""

TABLES: Mapping[str, Mapping[str, Callable[[], str]]] = {
    "sonoda1993": SONODA,
    "others": OTHERS,
    "convergence": CONVERGENCE,
    "systems": SYSTEMS,
    "platforms": PLATFORMS,
    "masters": MASTERS,
}
"""Functions that write a block, by paper and name."""


def filled(text: str) -> str:
    """Return a page with every block written from what is kept.

    Raises
    ------
    NotKeptError
        A block has a name that nobody writes, or a row that it needs is missing.
    """
    return BLOCK.sub(lambda found: block(found[1], found[2]), text)


def block(paper: str, name: str) -> str:
    """Return a block with its marks."""
    if name not in TABLES.get(paper, {}):
        raise NotKeptError(f"{paper}/{name}: there is no such table")
    text = TABLES[paper][name]().strip("\n")
    return f"<!-- table: {paper}/{name} -->\n{text}\n<!-- end -->"

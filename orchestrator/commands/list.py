"""The command ``rockshed list``: cases and components."""

from ..runs.catalogue import list_cases, list_components
from ..tables import Table
from .screen import opened


def command() -> None:
    """List all cases and components."""
    with opened() as screen:
        names = Table(("case", ""))
        for row in list_cases():
            others = f" = {row['other names']}" if row["other names"] else ""
            names.add(f"{row['case']}{others}", row["summary"])
        screen.show(names, "", list_components())

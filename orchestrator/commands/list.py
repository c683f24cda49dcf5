"""The command ``rockshed list``: cases and components."""

from rockshed.components.catalogue import NAMES, component

from ..cases.registry import cases
from ..tables import Table
from .screen import opened


def command() -> None:
    """List all cases and components."""
    with opened() as screen:
        names = Table(("case", ""))
        for case in cases().values():
            names.add(" = ".join((case.name, *case.other_names)), case.summary)
        parts = Table(("component", "", "sizes"))
        for name in NAMES:
            declared = component(name)
            sizes = (f"{size} = {entry.default}" for size, entry in declared.sizes.items())
            parts.add(name, declared.title, ", ".join(sizes))
        screen.show(names, "", parts)

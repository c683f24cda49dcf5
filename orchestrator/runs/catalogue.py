"""Lists of what there is: cases and components."""

from rockshed.components.catalogue import NAMES, component

from ..cases.registry import cases
from ..tables import Table


def list_cases() -> Table:
    """List the cases of the catalogue.

    Returns
    -------
    Table
        ``case``, ``other names`` and ``summary``; iterating gives a dict for each row.

    Examples
    --------
    >>> import rockshed
    >>> [row["case"] for row in rockshed.list_cases()][0]
    'lab-impact'
    """
    table = Table(("case", "other names", "summary"))
    for case in cases().values():
        table.add(case.name, ", ".join(case.other_names), case.summary)
    return table


def list_components() -> Table:
    """List the components of the catalogue.

    Returns
    -------
    Table
        ``component``, ``title`` and ``sizes`` with their defaults; iterating gives a dict for each
        row.

    Examples
    --------
    >>> import rockshed
    >>> [row["sizes"] for row in rockshed.list_components() if row["component"] == "RBSMBeam"]
    ['elements = 24, support_count = 2']
    """
    table = Table(("component", "title", "sizes"))
    for name in NAMES:
        made = component(name)
        sizes = (f"{size} = {entry.default}" for size, entry in made.sizes.items())
        table.add(name, made.title, ", ".join(sizes))
    return table

"""Table of the band that the rules of the effective width make of the headlines of a run."""

from typing import Any

from rockshed.components.common.units import SCREEN_UNITS

from ..core.results.reading import StoredRun
from ..tables import Table
from . import names

HEADLINES = {
    names.PEAK_ROCK: ("kN", 0),
    names.SETTLED_ROCK: ("kN", 0),
    names.PEAK_TRANSMITTED: ("kN", 0),
    names.SETTLED_TRANSMITTED: ("kN", 0),
    names.PENETRATION: ("m", 2),
    names.DEFLECTION: ("mm", 1),
    names.PEAK_MOMENT: ("kN m", 0),
    names.PEAK_REACTION: ("kN", 0),
}
"""Unit on the screen and decimals of the metrics whose band is told; those of all girders."""


def width_band_table(run: StoredRun) -> Table:
    """Return the headlines with the smallest and the largest effective width of all rules.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    Table
        Without a row where the band was not computed.
    """
    found: dict[str, dict[str, Any]] = run.provenance.get("band", {})
    titles = [f"{found[name]['width']:.2f} m" for name in found]
    titles = [
        f"{title} (this run)" if name == "run" else title for name, title in zip(found, titles)
    ]
    made = Table(("quantity", "unit", *titles), right=titles, title="band of the effective width")
    for name, (unit, decimals) in HEADLINES.items():
        values = [entry["metrics"].get(name) for entry in found.values()]
        if values and None not in values:
            shown = (f"{value / SCREEN_UNITS[unit]:,.{decimals}f}" for value in values)
            made.add(name, unit, *shown)
    return made

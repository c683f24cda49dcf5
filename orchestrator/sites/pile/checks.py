"""Faults of a pile that its form does not show."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...core.errors import Problem
from ...input_files.form import if_formed, told_if_formed
from ...input_files.places import Key, Places
from .site import PileSite, ShaftLayer

if TYPE_CHECKING:
    from .preparation import PreparedPile

MOST_ROWS = 20_000_000
"""Largest number of rows of the traces of all blows, a GiB and a half."""
LEAST_TRAVELS = 4.0
"""Travel times that a blow takes at least: to the toe and back, twice."""


def site_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Yield what is wrong with depths along a pile, as far as its form is right.

    Parameters
    ----------
    site : PileSite
        Data of the pile.
    where : Places
        Of the values of the site.

    Yields
    ------
    Problem
        Faults of layers and gauge.
    """
    for i, layer in enumerate(if_formed(getattr, site, "shaft") or ()):
        yield from told_if_formed(_layer_problems, site, i, layer, where)
    yield from told_if_formed(_gauge_problems, site, where)


def design_problems(pile: "PreparedPile", where: Places) -> Iterator[Problem]:
    """Yield what is wrong with a complete pile.

    Parameters
    ----------
    pile : PreparedPile
        Complete, but not yet accepted.
    where : Places
        Of the values of the site.

    Yields
    ------
    Problem
        Faults of resistances and times.
    """
    yield from _weight_problems(pile, where)
    yield from _time_problems(pile, where.of(("time",)))


def _length(site: PileSite) -> float:
    """Return the length of a rod (m)."""
    return sum(section.length for section in site.rod)


def _layer_problems(site: PileSite, i: int, layer: ShaftLayer, where: Places) -> Iterator[Problem]:
    """Yield a layer of soil that is upside down, not on the rod, or without resistance."""
    if layer.bottom <= layer.top:
        text = f"the layer goes from {layer.top:g} m to {layer.bottom:g} m"
        yield Problem(where.of(("shaft", i)), text, "let it end below its beginning")
    elif layer.bottom > _length(site) * (1.0 + 1e-9):
        text = f"{layer.bottom:g} m is below the toe, at {_length(site):g} m"
        remedy = "end the layer there, or lengthen the rod"
        yield Problem(where.of(("shaft", i, "to")), text, remedy)
    if layer.resistance == 0.0:
        text = "the friction of the layer never resists: its resistance is 0 N"
        yield Problem(where.of(("shaft", i, "resistance")), text, "leave the layer out")


def _gauge_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    length = _length(site)
    if site.gauge > length:
        text = f"the gauge at {site.gauge:g} m is below the toe"
        yield Problem(where.of(("gauge",)), text, f"give at most {length:g} m")


def _weight_problems(pile: "PreparedPile", where: Places) -> Iterator[Problem]:
    """Yield the resistances that do not carry rod and hammer at rest."""
    for resistance, key in _resistances(pile):
        if resistance <= pile.weight:
            text = (
                f"the soil bears {resistance:g} N, and rod and ram weigh {pile.weight:.4g} N: they "
                "sink without a blow"
            )
            yield Problem(where.of(key), text, "give it more resistance")


def _resistances(pile: "PreparedPile") -> Iterator[tuple[float, Key]]:
    """Yield value (N) and place of the ultimate resistances for which blows are computed."""
    bearing = pile.site.bearing
    place: Key = ("ground", "penetration") if pile.site.ground else ("toe", "resistance")
    yield pile.resistance, place
    for i, resistance in enumerate(bearing.resistances if bearing else []):
        yield resistance, ("bearing", "resistances", i)


def _time_problems(pile: "PreparedPile", place: str) -> Iterator[Problem]:
    """Yield the faults of a time that is too long to be kept, or too short for a blow."""
    blows = pile.site.blows
    rows = blows * pile.time / pile.step
    if rows > MOST_ROWS:
        text = (
            f"{blows} blows of {pile.time:g} s in steps of {pile.step:.3g} s are {rows:.2g} rows, "
            f"and at most {MOST_ROWS:.2g} are kept"
        )
        yield Problem(place, text, "shorten time, or give fewer blows or segments")
    least = LEAST_TRAVELS * pile.travel_time
    if pile.time < least:
        text = (
            f"{pile.time:g} s is too short for a blow: a wave needs {pile.travel_time:.3g} s from "
            "head to toe"
        )
        yield Problem(place, text, f"give at least {least:.2g} s")

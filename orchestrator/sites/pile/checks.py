"""Faults of a pile that its form does not show."""

from collections.abc import Iterator

from rockshed.components.common.units import standard_gravity

from ...core.errors import Problem
from ...input_files.form import if_formed, told_if_formed
from ...input_files.places import Key, Places
from .site import PileSite, ShaftLayer

MOST_ROWS = 20_000_000
"""Largest number of rows of the traces of all blows, a GiB and a half."""
LEAST_TRAVELS = 4.0
"""Travel times that a blow takes at least: to the toe and back, twice."""


def site_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Yield what is wrong with a pile, as far as its form is right.

    Parameters
    ----------
    site : PileSite
        Data of the pile.
    where : Places
        Of the values of the site.

    Yields
    ------
    Problem
        Faults of depths and resistances.
    """
    for i, layer in enumerate(if_formed(getattr, site, "shaft") or ()):
        yield from told_if_formed(_layer_problems, site, i, layer, where)
    yield from told_if_formed(_gauge_problems, site, where)
    yield from told_if_formed(_weight_problems, site, where)


def _length(site: PileSite) -> float:
    """Return the length of a rod (m)."""
    return sum(section.length for section in site.rod)


def _layer_problems(site: PileSite, i: int, layer: ShaftLayer, where: Places) -> Iterator[Problem]:
    """Yield a layer of soil that is upside down or not on the rod."""
    if layer.bottom <= layer.top:
        text = f"the layer goes from {layer.top:g} m to {layer.bottom:g} m"
        yield Problem(where.of(("shaft", i)), text, "let it end below its beginning")
    elif layer.bottom > _length(site) * (1.0 + 1e-9):
        text = f"{layer.bottom:g} m is below the toe, at {_length(site):g} m"
        remedy = "end the layer there, or lengthen the rod"
        yield Problem(where.of(("shaft", i, "to")), text, remedy)


def _gauge_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    length = _length(site)
    if site.gauge > length:
        text = f"the gauge at {site.gauge:g} m is below the toe"
        yield Problem(where.of(("gauge",)), text, f"give at most {length:g} m")


def _weight_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Yield the resistances that do not carry rod and ram at rest."""
    mass = sum(section.length * section.area * section.density for section in site.rod)
    weight = site.gravity * mass + standard_gravity * site.hammer.mass
    for resistance, key in _resistances(site):
        if resistance <= weight:
            text = (
                f"the soil bears {resistance:g} N, and rod and ram weigh {weight:.4g} N: they sink "
                "without a blow"
            )
            yield Problem(where.of(key), text, "give it more resistance")


def _resistances(site: PileSite) -> Iterator[tuple[float, Key]]:
    """Yield value (N) and place of the ultimate resistances for which blows are computed."""
    shaft = sum(layer.resistance for layer in site.shaft)
    yield site.toe.resistance + shaft, ("toe", "resistance")
    for i, resistance in enumerate(site.bearing.resistances if site.bearing else []):
        yield resistance, ("bearing", "resistances", i)


def time_problems(
    site: PileSite, place: str, time: float, step: float, travel_time: float
) -> Iterator[Problem]:
    """Yield the faults of a time that is too long to be kept, or too short for a blow.

    Parameters
    ----------
    site : PileSite
        Data of the pile.
    place : str
        Of the time in the file.
    time, step, travel_time : float
        Of a blow, of the exchange, of a wave from head to toe (s).

    Yields
    ------
    Problem
    """
    rows = site.blows * time / step
    if rows > MOST_ROWS:
        text = (
            f"{site.blows} blows of {time:g} s in steps of {step:.3g} s are {rows:.2g} rows, "
            f"and at most {MOST_ROWS:.2g} are kept"
        )
        yield Problem(place, text, "shorten time, or give fewer blows or segments")
    least = LEAST_TRAVELS * travel_time
    if time < least:
        text = (
            f"{time:g} s is too short for a blow: a wave needs {travel_time:.3g} s from head to toe"
        )
        yield Problem(place, text, f"give at least {least:.2g} s")

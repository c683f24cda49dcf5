"""Faults of a pile that its form does not show."""

from collections.abc import Iterator

from rockshed.components.common.units import standard_gravity

from ...core.errors import Problem
from ...input_files.places import Key, Places
from .site import PileSite

MOST_ROWS = 20_000_000
"""Largest number of rows of the traces of all blows, a GiB and a half."""
LEAST_TRAVELS = 4.0
"""Travel times that a blow takes at least: to the toe and back, twice."""


def site_problems(
    site: PileSite, where: Places, time: float, step: float, travel_time: float
) -> Iterator[Problem]:
    """Yield what is wrong with a pile of the right form.

    Parameters
    ----------
    site : PileSite
        Data of the pile.
    where : Places
        Of the values of the site.
    time : float
        Of a blow (s).
    step : float
        Of the exchange (s).
    travel_time : float
        Of a wave from head to toe (s).

    Yields
    ------
    Problem
        Faults of depths, resistances and times.
    """
    yield from _depth_problems(site, where)
    yield from _weight_problems(site, where)
    yield from _time_problems(site, where.of(("time",)), time, step, travel_time)


def _depth_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Yield the faults of soil and gauge that are not on the rod."""
    length = sum(section.length for section in site.rod)
    for i, layer in enumerate(site.shaft):
        if layer.bottom <= layer.top:
            text = f"the layer goes from {layer.top:g} m to {layer.bottom:g} m"
            yield Problem(where.of(("shaft", i)), text, "let it end below its beginning")
        elif layer.bottom > length * (1.0 + 1e-9):
            text = f"{layer.bottom:g} m is below the toe, at {length:g} m"
            remedy = "end the layer there, or lengthen the rod"
            yield Problem(where.of(("shaft", i, "to")), text, remedy)
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


def _time_problems(
    site: PileSite, place: str, time: float, step: float, travel_time: float
) -> Iterator[Problem]:
    """Yield the faults of a time that is too long to be kept, or too short for a blow."""
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

"""From a pile as data to hammer and rod that can be computed.

Everything that is wrong with a site is collected before it is refused.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance
from rockshed.components.common.units import standard_gravity

from ...core.errors import InputRefused, Problem
from ...input_files.fields import doubts, explained
from ...input_files.form import first, formed, if_formed, told_if_formed
from ...input_files.places import Key, Places
from ...input_files.setting import setter
from ..source import SiteLike, SiteSource, site_source
from .checks import site_problems, time_problems
from .site import QUAKE, SHAFT_DAMPING, PileSite, Section

Settings = Callable[[PileSite], Iterator[tuple[str, Any, Key]]]
"""Yields name, value and place of the parameters of a component."""
SHORTEST, TRAVELS = 0.1, 20.0
"""Time of a blow where the site has none: the longer of this (s) and so many travel times."""


@dataclass(frozen=True)
class PreparedPile:
    """A pile that can be computed.

    Attributes
    ----------
    source : SiteSource
        Where the site was read.
    site : PileSite
        Its data.
    warnings : tuple of str
        Values beyond what is usual.
    """

    source: SiteSource
    site: PileSite
    warnings: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the site, or of its file."""
        return self.source.name

    @property
    def resistance(self) -> float:
        """Ultimate static resistance (N) of shaft and toe."""
        return self.site.toe.resistance + sum(layer.resistance for layer in self.site.shaft)

    @property
    def rated_energy(self) -> float:
        """Energy (J) of the fall."""
        return self.site.hammer.mass * standard_gravity * self.site.hammer.drop

    @cached_property
    def travel_time(self) -> float:
        """Time (s) in which a wave goes from head to toe."""
        return sum(section.length / wave_speed(section) for section in self.site.rod)

    @property
    def step(self) -> float:
        """Travel time of a segment (s), which is the exchange step."""
        return self.travel_time / self.site.segments

    @property
    def time(self) -> float:
        """Time of a blow (s)."""
        return self.site.time or max(SHORTEST, TRAVELS * self.travel_time)

    @property
    def steps(self) -> int:
        """Number of exchanges in a blow."""
        return max(1, round(self.time / self.step))

    @cached_property
    def depths(self) -> NDArray[np.float64]:
        """Depths (m) of the ends of the segments, shape (segments + 1,), that of the head first."""
        rod = self.site.rod
        return np.interp(
            np.linspace(0.0, self.travel_time, self.site.segments + 1),
            [0.0, *accumulate(section.length / wave_speed(section) for section in rod)],
            [0.0, *accumulate(section.length for section in rod)],
        )

    @property
    def middles(self) -> NDArray[np.float64]:
        """Depths (m) of the middles of the segments, shape (segments,)."""
        return 0.5 * (self.depths[1:] + self.depths[:-1])

    def hammer(self) -> Instance:
        """Return a hammer that is about to strike, not yet initialised."""
        hammer = component("Hammer").instance()
        for name, value, _ in _hammer_settings(self.site):
            hammer[name] = value
        hammer["internal_step"] = self.step
        return hammer

    def rod(self, resistance: float | None = None) -> Instance:
        """Return the rod at rest, initialised.

        Parameters
        ----------
        resistance : float, optional
            Ultimate resistance (N) of the whole soil, which is scaled to it.

        Returns
        -------
        Instance
            Of the component PileRod.
        """
        sections = len(self.site.rod)
        rod = component("PileRod").instance(segments=self.site.segments, sections=sections)
        for name, value, _ in _rod_settings(self.site):
            rod[name] = value
        scale = 1.0 if resistance is None else resistance / self.resistance
        for name, values in self.soil().items():
            rod[name][:] = values * (scale if name == "shaft.resistance" else 1.0)
        rod["toe.resistance"] = scale * self.site.toe.resistance
        rod.initialise()
        return rod

    def soil(self) -> dict[str, NDArray[np.float64]]:
        """Return the soil along the shaft.

        A layer gives each segment the part of its resistance that belongs to the length which both
        share; quake and damping are those of the layer that gives most.

        Returns
        -------
        dict of str to array of float, shape (segments,)
            By name of the rod's parameter: resistance (N), quake (m), damping (s/m).
        """
        segments = self.site.segments
        resistance = np.zeros(segments)
        quake = np.full(segments, QUAKE)
        damping = np.full(segments, SHAFT_DAMPING)
        largest = np.zeros(segments)
        for layer in self.site.shaft:
            lower = np.minimum(self.depths[1:], layer.bottom)
            shared = lower - np.maximum(self.depths[:-1], layer.top)
            part = layer.resistance * np.maximum(shared, 0.0) / (layer.bottom - layer.top)
            resistance += part
            leading = part > largest
            quake[leading] = layer.quake
            damping[leading] = layer.damping
            largest[leading] = part[leading]
        return {
            "shaft.resistance": resistance,
            "shaft.quake": quake,
            "shaft.damping": damping,
        }


def prepare(site: SiteLike, blows: int | None = None) -> PreparedPile:
    """Read and check a pile.

    Parameters
    ----------
    site : path, mapping or PileSite
        Site file (TOML), or its content.
    blows : int, optional
        Replaces the number of the site.

    Returns
    -------
    PreparedPile
        From which hammer and rod can be made.

    Raises
    ------
    InputRefused
        Everything that is wrong with the site, with line and column.
    """
    source = site_source(site, blows=blows)
    where = source.places
    problems: list[Problem] = []
    data = formed(PileSite, source.content, where, problems)
    doubted = tuple(doubts(data, where))
    pile = PreparedPile(source, data, doubted)
    for of_component in (("Hammer", _hammer_settings), ("PileRod", _rod_settings)):
        if_formed(_check_values, data, *of_component, where, problems)
    problems += site_problems(data, where)
    problems += told_if_formed(_time_problems, pile)
    if not problems:
        problems += _refusals(pile)
    if problems:
        raise InputRefused(first(explained(problems, doubted)))
    return pile


def wave_speed(section: Section) -> float:
    """Return the speed (m/s) of longitudinal waves in a section of a rod, sqrt(E / rho)."""
    return float(np.sqrt(section.modulus / section.density))


def _refusals(pile: PreparedPile) -> list[Problem]:
    """Return what the components refuse."""
    try:
        pile.rod()
        pile.hammer().initialise()
    except ComponentError as error:
        return [Problem(pile.source.places.source, text) for text in error.problems]
    return []


def _hammer_settings(site: PileSite) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of the hammer's parameters."""
    yield "mass", site.hammer.mass, ("hammer", "mass")
    yield "drop_height", site.hammer.drop, ("hammer", "drop")
    yield "efficiency", site.hammer.efficiency, ("hammer", "efficiency")
    if site.cushion is not None:
        yield "cushion.stiffness", site.cushion.stiffness, ("cushion", "stiffness")
        yield "cushion.restitution", site.cushion.restitution, ("cushion", "restitution")


def _rod_settings(site: PileSite) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of the rod's parameters but for the resistances of the soil."""
    for i, section in enumerate(site.rod):
        for name in ("length", "area", "modulus", "density"):
            yield f"section.{name}[{i + 1}]", getattr(section, name), ("rod", i, name)
    yield "toe.quake", site.toe.quake, ("toe", "quake")
    yield "toe.damping", site.toe.damping, ("toe", "damping")
    yield "gravity", site.gravity, ("gravity",)
    yield "gauge.depth", site.gauge, ("gauge",)
    yield "toe.condition", "soil", ("toe",)
    yield "head.port", "waves", ("rod",)
    yield "exchange", "sequential", ("rod",)


def _check_values(
    site: PileSite, name: str, settings: Settings, where: Places, problems: list[Problem]
) -> None:
    """Append the values that a component does not accept."""
    setting = setter(component(name).instance(), where, problems)
    for parameter, value, key in settings(site):
        if "[" not in parameter:
            setting(parameter, value, key)


def _time_problems(pile: PreparedPile) -> Iterator[Problem]:
    place = pile.source.places.of(("time",))
    yield from time_problems(pile.site, place, pile.time, pile.step, pile.travel_time)

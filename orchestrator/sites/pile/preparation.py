"""From a pile as data to hammer and rod that can be computed.

Everything that is wrong with a site is collected before it is refused.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
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
from ...input_files.form import first, formed
from ...input_files.places import Key, Places
from ...input_files.setting import setter
from ..source import SiteLike, SiteSource, site_source
from .checks import design_problems, site_problems
from .completion import bearing_area, completed
from .design import PileDesign, RodSection
from .ground import GroundProfile
from .site import QUAKE, SHAFT_DAMPING, PileSite

SHORTEST, TRAVELS = 0.1, 20.0
"""Time of a blow where the site has none: the longer of this (s) and so many travel times."""


@dataclass(frozen=True)
class PreparedPile:
    """A pile that can be computed.

    Attributes
    ----------
    source : SiteSource
        Where the site was read.
    site : PileDesign
        Its data, complete.
    warnings : tuple of str
        Values beyond what is usual.
    given : PileSite, optional
        Data as its file has them.
    """

    source: SiteSource
    site: PileDesign
    warnings: tuple[str, ...] = ()
    given: PileSite | None = None

    @property
    def name(self) -> str:
        """Name of the site, or of its file."""
        return self.source.name

    @property
    def resistance(self) -> float:
        """Ultimate static resistance (N) of shaft and toe."""
        return self.site.toe.resistance + self.shaft_resistance

    @property
    def shaft_resistance(self) -> float:
        """Ultimate static resistance (N) of the shaft."""
        layers = sum(layer.resistance for layer in self.site.shaft)
        return layers + sum(part.resistance for part in self.site.friction)

    @property
    def weight(self) -> float:
        """Weight (N) of rod, helmet and ram at rest."""
        hammer = self.site.hammer.mass + self.site.helmet
        if self.site.hammer.anvil:
            hammer += self.site.hammer.anvil.mass
        return self.site.gravity * self.site.mass + standard_gravity * hammer

    @property
    def rated_energy(self) -> float:
        """Energy (J) of the fall."""
        return self.site.hammer.energy

    def at(self, penetration: float) -> "PreparedPile":
        """Return the pile with its toe at another depth (m) below the ground surface.

        Only a pile in ground in layers has one.
        """
        ground, rod = self.site.ground, self.site.rod
        if ground is None:
            raise ValueError("the pile does not stand in ground in layers")
        profile = GroundProfile(ground, self.site.soil)
        changed = {
            "ground": ground.model_copy(update={"penetration": penetration}),
            "toe": profile.toe(penetration, bearing_area(ground, rod) or 0.0),
            "friction": profile.friction(penetration, rod),
        }
        return replace(self, site=self.site.model_copy(update=changed))

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
        for piece in self.site.friction:
            upper = np.maximum(self.depths[:-1], piece.top)
            lower = np.minimum(self.depths[1:], piece.bottom)
            middle = (0.5 * (upper + lower) - piece.top) / (piece.bottom - piece.top)
            mean = piece.upper + middle * (piece.lower - piece.upper)
            part = mean * np.maximum(lower - upper, 0.0)
            resistance += part
            leading = part > largest
            quake[leading] = piece.quake
            damping[leading] = piece.damping
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
    problems += site_problems(data, where)
    design = completed(data, where, problems)
    if design is None:
        raise InputRefused(first(explained(problems, doubted)))
    pile = PreparedPile(source, design, doubted, data)
    problems += _value_problems(design, where)
    problems += design_problems(pile, where)
    if not problems:
        problems += _refusals(pile)
    if problems:
        raise InputRefused(first(explained(problems, doubted)))
    return pile


def wave_speed(section: RodSection) -> float:
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


def _hammer_settings(site: PileDesign) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of the hammer's parameters."""
    hammer = site.hammer
    yield "mass", hammer.mass, ("hammer", "mass")
    yield "drop_height", hammer.fall, ("hammer", "drop")
    yield "efficiency", hammer.efficiency, ("hammer", "efficiency")
    if site.cushion is not None:
        yield "cushion.stiffness", site.cushion.stiffness, ("cushion", "stiffness")
        yield "cushion.restitution", site.cushion.restitution, ("cushion", "restitution")
    if site.helmet:
        yield "helmet.mass", site.helmet, ("helmet", "mass")
    if site.pile_cushion is not None:
        second = site.pile_cushion
        yield "pile_cushion.stiffness", second.stiffness, ("pile_cushion", "stiffness")
        yield "pile_cushion.restitution", second.restitution, ("pile_cushion", "restitution")
    for part in ("anvil", "gas"):
        for name, value in dict(getattr(hammer, part) or {}).items():
            yield f"{part}.{name}", value, ("hammer", part, name)


def _rod_settings(site: PileDesign) -> Iterator[tuple[str, Any, Key]]:
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


def _value_problems(site: PileDesign, where: Places) -> list[Problem]:
    """Return the values that the components do not accept."""
    problems: list[Problem] = []
    setting = setter(component("Hammer").instance(), where, problems)
    for name, value, key in _hammer_settings(site):
        setting(name, value, key)
    setting = setter(component("PileRod").instance(), where, problems)
    for name, value, key in _rod_settings(site):
        if "[" not in name:
            setting(name, value, key)
    return problems

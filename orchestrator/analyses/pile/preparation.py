"""From a site file to hammer and rod that can be computed. Everything that is wrong is collected before it is refused."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance

from ...core.errors import InputRefused, Problem
from ...input_files.form import first, formed, read_toml
from ...input_files.places import Places
from ...input_files.setting import setter
from ...sites.pile.site import PileSite, Section, Shaft

MOST_ROWS = 20_000_000
"""Of the traces of all blows: a GiB and a half."""
SHORTEST, TRAVELS = 0.1, 20.0
"""Time of a blow where none is given: so many seconds, or so many travel times of a wave."""
LEAST_TRAVELS = 4.0
"""Travel times that a blow takes at least: to the toe and back, twice."""


@dataclass(frozen=True)
class Prepared:
    """A site that can be computed."""

    file: Path
    site: PileSite

    @property
    def name(self) -> str:
        """Of the site, or of its file."""
        return self.site.name or self.file.stem

    @property
    def resistance(self) -> float:
        """Ultimate static resistance (N) of shaft and toe."""
        return self.site.toe.resistance + sum(layer.resistance for layer in self.site.shaft)

    @property
    def rated_energy(self) -> float:
        """Energy (J) of the fall."""
        return self.site.hammer.mass * 9.80665 * self.site.hammer.drop

    @cached_property
    def travel_time(self) -> float:
        """Of a wave from head to toe (s)."""
        return sum(section.length / _speed(section) for section in self.site.rod)

    @property
    def step(self) -> float:
        """Travel time of a segment (s): the exchange step."""
        return self.travel_time / self.site.segments

    @property
    def time(self) -> float:
        """Of a blow (s)."""
        return self.site.time or max(SHORTEST, TRAVELS * self.travel_time)

    @property
    def steps(self) -> int:
        """Exchanges in a blow."""
        return max(1, round(self.time / self.step))

    @cached_property
    def depths(self) -> NDArray[np.float64]:
        """Depth (m) of the ends of the segments, the head's first."""
        return np.interp(
            np.linspace(0.0, self.travel_time, self.site.segments + 1),
            [0.0, *accumulate(section.length / _speed(section) for section in self.site.rod)],
            [0.0, *accumulate(section.length for section in self.site.rod)],
        )

    def hammer(self) -> Instance:
        """A hammer that begins its blow."""
        made = component("Hammer").instance()
        for name, value, _ in _hammer_values(self.site):
            made[name] = value
        made["internal_step"] = self.step
        return made

    def rod(self, resistance: float | None = None) -> Instance:
        """The rod at rest, initialised. resistance: of the whole soil (N), which is scaled to it."""
        made = component("PileRod").instance(
            segments=self.site.segments, sections=len(self.site.rod)
        )
        for name, value, _ in _rod_values(self.site):
            made[name] = value
        scale = 1.0 if resistance is None else resistance / self.resistance
        for name, values in self.soil().items():
            made[name][:] = values * (scale if name == "shaft.resistance" else 1.0)
        made["toe.resistance"] = scale * self.site.toe.resistance
        made.initialise()
        return made

    def soil(self) -> dict[str, NDArray[np.float64]]:
        """What the segments' shaft has, by name of the rod's parameter: layers by the length that they share with a segment."""
        found = {
            "shaft.resistance": np.zeros(self.site.segments),
            "shaft.quake": np.full(self.site.segments, 2.5e-3),
            "shaft.damping": np.full(self.site.segments, 0.16),
        }
        largest = np.zeros(self.site.segments)
        for layer in self.site.shaft:
            shared = np.minimum(self.depths[1:], layer.bottom) - np.maximum(
                self.depths[:-1], layer.top
            )
            part = layer.resistance * np.maximum(shared, 0.0) / (layer.bottom - layer.top)
            found["shaft.resistance"] += part
            leading = part > largest
            found["shaft.quake"][leading], found["shaft.damping"][leading] = (
                layer.quake,
                layer.damping,
            )
            largest[leading] = part[leading]
        return found


def prepare(file: Path, blows: int | None = None) -> Prepared:
    """Read a site and make it ready; ``blows`` replaces the number in the file.

    Raises:
        InputRefused: everything that is wrong with it, with line and column.
    """
    data, where = read_toml(file)
    problems: list[Problem] = []
    site = formed(
        PileSite, {**data, **({} if blows is None else {"blows": blows})}, where, problems
    )
    if site is None:
        raise InputRefused(first(problems))
    problems += [
        *_value_problems(site, where),
        *_depth_problems(site, where),
        *_weight_problems(site, where),
    ]
    made = Prepared(file, site)
    rows = site.blows * made.time / made.step
    if rows > MOST_ROWS:
        problems.append(
            Problem(
                where.of(("time",)),
                f"{site.blows} blows of {made.time:g} s in steps of {made.step:.3g} s are "
                f"{rows:.2g} rows, and at most {MOST_ROWS:.2g} are kept",
                "shorten time, or give fewer blows or segments",
            )
        )
    if made.time < (least := LEAST_TRAVELS * made.travel_time):
        problems.append(
            Problem(
                where.of(("time",)),
                f"{made.time:g} s is too short for a blow: a wave needs "
                f"{made.travel_time:.3g} s from head to toe",
                f"give at least {least:.2g} s",
            )
        )
    if not problems:
        try:
            made.rod()
            made.hammer().initialise()
        except ComponentError as error:
            problems += [Problem(str(file), text) for text in error.problems]
    if problems:
        raise InputRefused(first(problems))
    return made


def _speed(section: Section) -> float:
    return float(np.sqrt(section.modulus / section.density))


def _hammer_values(site: PileSite) -> Iterator[tuple[str, Any, tuple[str | int, ...]]]:
    """Name and value of the hammer's parameters, and where they stand."""
    yield "mass", site.hammer.mass, ("hammer", "mass")
    yield "drop_height", site.hammer.drop, ("hammer", "drop")
    yield "efficiency", site.hammer.efficiency, ("hammer", "efficiency")
    if site.cushion is not None:
        yield "cushion.stiffness", site.cushion.stiffness, ("cushion", "stiffness")
        yield "cushion.restitution", site.cushion.restitution, ("cushion", "restitution")


def _rod_values(site: PileSite) -> Iterator[tuple[str, Any, tuple[str | int, ...]]]:
    """Name and value of the rod's parameters but for the soil's resistances, and where they stand."""
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


def _value_problems(site: PileSite, where: Places) -> list[Problem]:
    """Values that the components do not take."""
    problems: list[Problem] = []
    setting = setter(component("Hammer").instance(), where, problems)
    for name, value, key in _hammer_values(site):
        setting(name, value, key)
    setting = setter(component("PileRod").instance(), where, problems)
    for name, value, key in _rod_values(site):
        setting(name, value, key) if "[" not in name else None
    return problems


def _depth_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Soil and gauge beside the rod."""
    length = sum(section.length for section in site.rod)
    for i, layer in enumerate(site.shaft):
        if layer.bottom <= layer.top:
            yield Problem(
                where.of(("shaft", i)),
                f"the layer goes from {layer.top:g} m to {layer.bottom:g} m",
                "let it end below its beginning",
            )
        elif layer.bottom > length * (1.0 + 1e-9):
            yield Problem(
                where.of(("shaft", i, "to")),
                f"{layer.bottom:g} m is below the toe, at {length:g} m",
                "end the layer there, or lengthen the rod",
            )
    if site.gauge > length:
        yield Problem(
            where.of(("gauge",)),
            f"the gauge at {site.gauge:g} m is below the toe",
            f"give at most {length:g} m",
        )


def _weight_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Soil that does not carry rod and ram at rest."""
    gravity = site.gravity
    mass = sum(section.length * section.area * section.density for section in site.rod)
    weight, least = (
        gravity * mass + 9.80665 * site.hammer.mass,
        site.toe.resistance + _total(site.shaft),
    )
    for resistance, key in [
        (least, ("toe", "resistance")),
        *(
            (value, ("bearing", "resistances", i))
            for i, value in enumerate(site.bearing.resistances if site.bearing else [])
        ),
    ]:
        if resistance <= weight:
            yield Problem(
                where.of(key),
                f"the soil bears {resistance:g} N, and rod and ram weigh {weight:.4g} N: they sink "
                "without a blow",
                "give it more resistance",
            )


def _total(layers: Sequence[Shaft]) -> float:
    return sum(layer.resistance for layer in layers)

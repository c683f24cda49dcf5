"""From ground in layers to friction along a pile and the soil under its toe."""

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise

from rockshed.components.common.units import standard_gravity

from .design import Friction, RodSection
from .site import Ground, NamedSoil, ToeSoil

WATER = 1000.0
"""Density of water (kg/m3)."""


@dataclass(frozen=True)
class Piece:
    """A stretch of depth with unit friction that is linear in it.

    Attributes
    ----------
    top, bottom : float
        Depths below the ground surface (m).
    upper, lower : float
        Unit friction at both (Pa).
    soil : str
        Name of the soil.
    """

    top: float
    bottom: float
    upper: float
    lower: float
    soil: str

    def at(self, depth: float) -> float:
        """Return the unit friction (Pa) at a depth (m) within the piece."""
        part = (depth - self.top) / (self.bottom - self.top)
        return self.upper + part * (self.lower - self.upper)

    def between(self, top: float, bottom: float) -> "Piece":
        """Return the part of the piece between two depths (m)."""
        upper = max(self.top, top)
        lower = min(self.bottom, bottom)
        return replace(self, top=upper, bottom=lower, upper=self.at(upper), lower=self.at(lower))


@dataclass(frozen=True)
class GroundProfile:
    """Stress and friction over the depth of ground whose form has been checked.

    Attributes
    ----------
    ground : Ground
        Layers and water table.
    soils : mapping of str to NamedSoil
        By name.
    """

    ground: Ground
    soils: dict[str, NamedSoil]

    @property
    def bounds(self) -> list[float]:
        """Depths (m) of the surface and of the lower ends of the layers."""
        return [0.0, *(layer.bottom for layer in self.ground.layers)]

    def soil_at(self, depth: float) -> tuple[str, NamedSoil]:
        """Return name and soil of the layer at a depth (m); at a bound, of the one below."""
        place = bisect_right(self.bounds[1:], depth)
        name = self.ground.layers[min(place, len(self.ground.layers) - 1)].soil
        return name, self.soils[name]

    def stress(self, depth: float) -> float:
        """Return the vertical effective stress (Pa) at a depth (m).

        Weight of the soils above, less the pressure of water below its table. A soil without a
        density has no weight.
        """
        total = 0.0
        for (top, bottom), layer in zip(pairwise(self.bounds), self.ground.layers, strict=True):
            density = self.soils[layer.soil].density or 0.0
            total += density * max(0.0, min(bottom, depth) - top)
        table = math.inf if self.ground.water is None else self.ground.water
        return standard_gravity * (total - WATER * max(0.0, depth - table))

    def pieces(self) -> Iterator[Piece]:
        """Yield the stretches of all layers with friction, from the surface downwards."""
        table = self.ground.water
        for (top, bottom), layer in zip(pairwise(self.bounds), self.ground.layers, strict=True):
            soil = self.soils[layer.soil]
            inner = [table] if table is not None and top < table < bottom else []
            for upper, lower in pairwise([top, *inner, bottom]):
                values = [self._unlimited(soil, top, depth) for depth in (upper, lower)]
                if max(values) > 0.0:
                    yield from _limited(Piece(upper, lower, values[0], values[1], layer.soil), soil)

    def _unlimited(self, soil: NamedSoil, top: float, depth: float) -> float:
        """Return the unit friction (Pa) while driving at a depth (m) in a layer from ``top`` on."""
        if soil.beta is not None:
            return soil.driving * soil.beta * self.stress(depth)
        growth = (soil.friction_growth or 0.0) * (depth - top)
        return soil.driving * ((soil.friction or 0.0) + growth)

    def friction(self, penetration: float, rod: Sequence[RodSection]) -> list[Friction]:
        """Return the friction along a rod whose toe stands at a depth.

        Parameters
        ----------
        penetration : float
            Depth of the toe below the ground surface (m).
        rod : sequence of RodSection
            From head to toe, those in the ground with a perimeter.

        Returns
        -------
        list of Friction
            By depth below the head.
        """
        ends = [0.0, *accumulate(section.length for section in rod)]
        head = penetration - ends[-1]
        made = []
        for piece in self.pieces():
            soil = self.soils[piece.soil]
            for (begin, end), section in zip(pairwise(ends), rod, strict=True):
                part = piece.between(begin + head, end + head)
                if part.bottom - part.top <= 0.0:
                    continue
                perimeter = section.perimeter or 0.0
                made.append(
                    Friction(
                        top=part.top - head,
                        bottom=part.bottom - head,
                        upper=perimeter * part.upper,
                        lower=perimeter * part.lower,
                        quake=soil.quake,
                        damping=soil.damping,
                        soil=piece.soil,
                    )
                )
        return made

    def toe(self, penetration: float, area: float) -> ToeSoil:
        """Return the soil under a toe of some area (m2) at a depth (m)."""
        _, soil = self.soil_at(penetration)
        unit = soil.toe or 0.0
        if soil.toe_factor is not None:
            unit = soil.toe_factor * self.stress(penetration)
        unit = min(unit, soil.toe_limit or math.inf)
        return ToeSoil(resistance=unit * area, quake=soil.toe_quake, damping=soil.toe_damping)


def _limited(piece: Piece, soil: NamedSoil) -> Iterator[Piece]:
    """Yield a piece whose friction has a largest value: what is below it, and what is cut."""
    limit = soil.driving * (soil.friction_limit or math.inf)
    low, high = sorted((piece.upper, piece.lower))
    if high <= limit:
        yield piece
        return
    if low >= limit:
        yield replace(piece, upper=limit, lower=limit)
        return
    part = (limit - piece.upper) / (piece.lower - piece.upper)
    crossing = piece.top + part * (piece.bottom - piece.top)
    yield Piece(piece.top, crossing, min(piece.upper, limit), limit, piece.soil)
    yield Piece(crossing, piece.bottom, limit, min(piece.lower, limit), piece.soil)

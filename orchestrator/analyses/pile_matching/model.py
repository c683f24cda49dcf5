"""The rod below the gauge under the measured wave: what would come back with some soil."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.common.cache import source_stamp

from ...sites.pile.preparation import PreparedPile
from ..frame import FloatArray
from .measured import MeasuredBlow

MOST_FACTOR = 30.0
"""Largest factor, and its reciprocal the smallest, between a value sought and its start."""


@dataclass(frozen=True)
class Sought:
    """A parameter of the soil that is sought, as a factor on its value in the file.

    Attributes
    ----------
    name, unit : str
        Identifier and SI unit.
    start : float
        Value in the file.
    """

    name: str
    unit: str
    start: float


class WaveModel:
    """A pile from its gauge downwards, driven by the measured wave that goes down.

    At the gauge F = Z (f - b) and v = f + b, with f and b the velocities of the waves downwards and
    upwards. f = (F/Z + v)/2 is taken from the measurement; the force of the wave upwards,
    (F - Z v)/2 = -Z b, is computed and compared. It has all that the soil does to the wave.

    Attributes
    ----------
    pile : PreparedPile
        Its head is the place of the gauge.
    step : float
        Travel time of a segment (s).
    down, up : array of float, shape (steps,)
        Forces Z f and (F - Z v)/2 of the measured waves (N), means over the steps.
    sought : list of Sought
        Parameters.
    """

    def __init__(self, pile: PreparedPile, blow: MeasuredBlow) -> None:
        site = pile.site.model_copy(update={"gravity": 0.0, "gauge": 0.0})
        self.pile = PreparedPile(pile.source, site)
        rod = self.pile.rod()
        self.step = float(rod["time_step"])
        self.impedance = float(rod["head.impedance"])
        steps = int((blow.time[-1] - blow.time[0]) / self.step)
        self.time: FloatArray = blow.time[0] + self.step * (np.arange(steps) + 0.5)
        force = blow.mean(blow.force, self.step, steps)
        velocity = blow.mean(blow.velocity, self.step, steps)
        self.down = 0.5 * (force + self.impedance * velocity)
        self.up = 0.5 * (force - self.impedance * velocity)
        self.sought = list(_sought(self.pile))

    @property
    def about(self) -> tuple[object, ...]:
        """Everything that a wave upwards follows from besides the soil's factors."""
        stamp = source_stamp(component("PileRod").folder)
        return stamp, self.pile.site.model_dump(mode="json"), self.step, self.down

    def wave(self, factors: Sequence[float] | FloatArray) -> FloatArray:
        """Return the force of the wave upwards (N) with the soil scaled.

        Parameters
        ----------
        factors : sequence of float
            One for each of :attr:`sought`.

        Returns
        -------
        array of float, shape (steps,)
            Means over the steps.
        """
        rod = self.with_soil(factors).rod()
        wave = rod.references["head.wave"]
        force = rod.references["head.force"]
        up = np.empty(len(self.down))
        for number, down in enumerate(self.down):
            up[number] = -0.5 * rod.w[wave]
            rod.w[force] = down + up[number]
            rod.step(number * self.step, self.step)
        return up

    def with_soil(self, factors: Sequence[float] | FloatArray) -> PreparedPile:
        """Return the pile with the soil scaled by factors, one for each of :attr:`sought`."""
        layers = len(self.pile.site.shaft)
        shaft_quake, shaft_damping, toe, toe_quake, toe_damping = factors[layers:]
        shaft = [
            layer.model_copy(
                update={
                    "resistance": layer.resistance * factor,
                    "quake": layer.quake * shaft_quake,
                    "damping": layer.damping * shaft_damping,
                }
            )
            for layer, factor in zip(self.pile.site.shaft, factors[:layers], strict=True)
        ]
        given = self.pile.site.toe
        under = given.model_copy(
            update={
                "resistance": given.resistance * toe,
                "quake": given.quake * toe_quake,
                "damping": given.damping * toe_damping,
            }
        )
        site = self.pile.site.model_copy(update={"shaft": shaft, "toe": under})
        return PreparedPile(self.pile.source, site)


def _sought(pile: PreparedPile) -> list[Sought]:
    """Return the parameters that are sought; quake and damping of the first layer stand for all."""
    layers = pile.site.shaft
    found = [
        Sought(f"shaft_{i}.resistance", "N", layer.resistance) for i, layer in enumerate(layers, 1)
    ]
    return [
        *found,
        Sought("shaft.quake", "m", layers[0].quake),
        Sought("shaft.damping", "s/m", layers[0].damping),
        Sought("toe.resistance", "N", pile.site.toe.resistance),
        Sought("toe.quake", "m", pile.site.toe.quake),
        Sought("toe.damping", "s/m", pile.site.toe.damping),
    ]

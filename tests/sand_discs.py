"""A few sand discs where a test wants them: small experiments with the sand cushion through its
public side."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.component import Instance
from rockshed.components.falling_rock import COMPONENT as FALLING_ROCK
from rockshed.components.sand_cushion import COMPONENT
from rockshed.components.sand_cushion.declarations import ROW, SUM

Pairs = Sequence[tuple[float, float]] | NDArray[np.float64]

RADIUS = 0.005
"""Radius of a sand disc by default (m)."""
EMPTY_SPACE = {
    "base": "floor",
    "gravity": 0.0,
    "settling.time": 0.0,
    "box.left": -5.0,
    "box.width": 10.0,
    "base.y": -5.0,
    "rock.position.y": 50.0,
    "rotation": "free",
    "stiffness_factor": 1.0,
}
"""No gravity; floor, walls and rock far away: discs on their own."""
SMALL_BOX = {"base": "floor", "box.left": 0.0, "box.width": 0.1, "rock.position.y": 1.0}
"""A box ten discs wide on the floor, the rock out of the way; the beam discs, if any, begin at its
left wall."""


def cushion(parameters: Mapping[str, Any], discs: int = 60, elements: int = 4) -> Instance:
    """An initialised cushion of ``discs`` sand discs; the rock is in the middle of the box and
    fits, unless told otherwise."""
    instance = COMPONENT.instance(discs=discs, elements=elements)
    for name, value in parameters.items():
        instance[name] = value
    if "rock.position.x" not in parameters:
        instance["rock.position.x"] = instance["box.left"] + 0.5 * instance["box.width"]
    if "rock.radius" not in parameters:
        instance["rock.radius"] = min(instance["rock.radius"], 0.495 * instance["box.width"])
    instance.initialise()
    return instance


def discs_at(
    positions: Pairs,
    velocities: Pairs | None = None,
    spins: Sequence[float] | NDArray[np.float64] | None = None,
    parameters: Mapping[str, Any] | None = None,
    elements: int = 4,
) -> Instance:
    """Discs at given centres (m) with given velocities (m/s) and spins (rad/s), in empty space
    unless parameters say otherwise."""
    instance = cushion({**EMPTY_SPACE, **(parameters or {})}, len(positions), elements)
    body = rows(instance)
    body[:, 0:2] = positions
    if velocities is not None:
        body[:, 2:4] = velocities
    if spins is not None:
        body[:, 4] = np.asarray(spins) * body[:, 5]
    instance.evaluate()
    return instance


def stirred(instance: Instance, speed: float, seed: int = 1) -> Instance:
    """Give the discs random velocities of about ``speed`` (m/s)."""
    rows(instance)[:, 2:4] = np.random.default_rng(seed).normal(
        0.0, speed, (instance.sizes["discs"], 2)
    )
    instance.evaluate()
    return instance


def rows(instance: Instance) -> NDArray[np.float64]:
    """The sand discs' rows of the state, a view: x, y, vx, vy, omega * radius, radius, 1/mass,
    sqrt(mass) / 2."""
    view: NDArray[np.float64] = instance.state("body").reshape(-1, ROW)[: instance.sizes["discs"]]
    return view


def masses(instance: Instance) -> NDArray[np.float64]:
    """Mass of each sand disc (kg)."""
    return 1.0 / rows(instance)[:, 6]


def weight(instance: Instance) -> float:
    """Weight of all sand (N)."""
    return float(masses(instance).sum() * instance["gravity"])


def sand_stiffness(instance: Instance) -> float:
    """k_n of two equal discs (N/m): eq. (1) of the paper with dD = R_ij0."""
    return float(instance["stiffness_factor"] * instance["modulus"] * instance["thickness"])


def run(instance: Instance, duration: float, step: float | None = None) -> None:
    """Advance by ``duration`` (s), in one communication step unless ``step`` (s) is given."""
    count = 1 if step is None else round(duration / step)
    for i in range(count):
        instance.step(i * duration / count, duration / count)


def force_rebuild(instance: Instance) -> None:
    """Make the component search its contacts anew at the next step."""
    instance.state("sums")[SUM.travelled] = 1e9


def restitution(damping_ratio: float) -> float:
    """Rebound / approach speed of a linear spring and dashpot without tension: contact ends when
    the force is zero.

    Schwager and Poeschel (2007), Granular Matter 9, 465-469. damping_ratio = c / (2 sqrt(k m_eff)).
    """
    return math.exp(-damping_ratio * contact_duration(damping_ratio, 1.0))


def contact_duration(damping_ratio: float, frequency: float) -> float:
    """Time (s) until the force of that contact is zero; frequency = sqrt(k / m_eff) (rad/s)."""
    beta, difference = damping_ratio, 1.0 - damping_ratio**2
    if difference > 0.0:
        omega = math.sqrt(difference)
        return math.atan2(2.0 * beta * omega, beta * beta - omega * omega) / omega / frequency
    omega = math.sqrt(-difference)
    return math.log((beta + omega) / (beta - omega)) / omega / frequency


class RockOnSand:
    """A falling rock and a sand cushion that exchange every ``step`` (s), the sand first, inputs
    held: the paper's scheme."""

    def __init__(
        self,
        sand: Instance,
        position: tuple[float, float],
        velocity: tuple[float, float],
        step: float,
        gravity: float = 0.0,
    ) -> None:
        self.sand, self.rock, self.step, self.steps = sand, FALLING_ROCK.instance(), step, 0
        self.rock["position0.x"], self.rock["position0.y"] = position
        self.rock["velocity0.x"], self.rock["velocity0.y"] = velocity
        self.rock["gravity"], self.rock["internal_step"] = gravity, step
        self.rock["mass"], self.rock["radius"] = sand["rock.mass"], sand["rock.radius"]
        self.rock.initialise()
        self._tell_sand()
        sand.evaluate()

    def _tell_sand(self) -> None:
        for name in (
            "position.x",
            "position.y",
            "angle",
            "velocity.x",
            "velocity.y",
            "angular_velocity",
        ):
            self.sand[f"rock.{name}"] = self.rock[name]

    def advance(self, duration: float) -> None:
        """Go on for ``duration`` (s)."""
        for _ in range(round(duration / self.step)):
            time = self.steps * self.step
            self.sand.step(time, self.step)
            self.rock["force.x"], self.rock["force.y"] = (
                self.sand["rock.force.x"],
                self.sand["rock.force.y"],
            )
            self.rock["torque"] = self.sand["rock.torque"]
            self.rock.step(time, self.step)
            self._tell_sand()
            self.steps += 1

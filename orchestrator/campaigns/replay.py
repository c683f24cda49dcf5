"""One trial again, by itself: the component stepped through it, instant by instant."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.component import Instance
from rockshed.components.slope_rockfall.declarations import BODY
from rockshed.components.slope_rockfall.records import KNOT, OUTCOME, ROCK
from rockshed.components.slope_rockfall.trajectory import MOST_EVENTS, set_rock, trace

from ..core.errors import InputRefused, Problem
from ..sites.rockfall.preparation import PreparedSlope
from .campaign import Campaign, compute, own_buffers
from .passages import ENDS

MODES = ("in flight", "rolling", "sliding", "spinning", "at rest", "handed over")
"""Modes of motion in words, in the order of the component's output ``mode``."""
_OUTPUTS = {
    "x": "position.x",
    "y": "position.y",
    "angle": "angle",
    "vx": "velocity.x",
    "vy": "velocity.y",
    "mode": "mode",
    "height": "height",
    "energy": "energy.kinetic",
}

PARAMETERS = {
    "mass": ROCK.mass,
    "radius": ROCK.radius,
    "moment_of_inertia": ROCK.moment_of_inertia,
    "elongation": ROCK.elongation,
    "position0.x": ROCK.x,
    "position0.y": ROCK.y,
    "velocity0.x": ROCK.vx,
    "velocity0.y": ROCK.vy,
    "angular_velocity0": ROCK.omega,
    "angle0": ROCK.angle,
}
"""Parameters of the component that a rock sets, and its columns."""
_FEWEST_KNOTS = 1000
"""Events for which there is room at first."""


@dataclass(frozen=True)
class Replay:
    """A trial at evenly spaced times, and at its end.

    Attributes
    ----------
    number : int
        Of the trial.
    end : str
        End of the trial in words.
    time : array of float, shape (n,)
        Instants (s).
    x, y, angle, vx, vy, mode, height, energy : array of float, shape (n,)
        Place (m), angle (rad) and velocity (m/s) of the centre, number of the mode of motion,
        height (m) above the slope, kinetic energy (J).
    radius, elongation : float
        sqrt(a b) (m) and a / b of its semi-axes.
    """

    number: int
    end: str
    time: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    angle: NDArray[np.float64]
    vx: NDArray[np.float64]
    vy: NDArray[np.float64]
    mode: NDArray[np.float64]
    height: NDArray[np.float64]
    energy: NDArray[np.float64]
    radius: float
    elongation: float

    @property
    def speed(self) -> NDArray[np.float64]:
        """Speed of the centre (m/s), shape (n,)."""
        return np.hypot(self.vx, self.vy)


def check(campaign: Campaign, numbers: Iterable[int]) -> None:
    """Refuse trials that the campaign does not have.

    Parameters
    ----------
    campaign : Campaign
        With its number of trials.
    numbers : iterable of int
        Of the trials.

    Raises
    ------
    InputRefused
        There are no such trials.
    """
    remedy = f"choose one from 0 to {campaign.trials - 1}"
    problems = [
        Problem(f"replay {number}", "the campaign has no such trial", remedy)
        for number in numbers
        if not 0 <= number < campaign.trials
    ]
    if problems:
        raise InputRefused(problems)


def set_rock_of(campaign: Campaign, number: int, rock: Instance) -> None:
    """Give an instance the rock and the start of a trial.

    Parameters
    ----------
    campaign : Campaign
        To which the trial belongs.
    number : int
        Of the trial.
    rock : Instance
        Not yet initialised.
    """
    if campaign.rocks is None:
        return
    drawn = campaign.rocks.sample(number, 1)[0]
    for name, column in PARAMETERS.items():
        rock[name] = drawn[column]


def replay(slope: PreparedSlope, campaign: Campaign, number: int, interval: float) -> Replay:
    """Compute a trial step by step.

    Parameters
    ----------
    slope : PreparedSlope
        With the component.
    campaign : Campaign
        To which the trial belongs.
    number : int
        Of the trial.
    interval : float
        Time (s) between two instants.

    Returns
    -------
    Replay
        Until the trial ends, with the bits of the campaign.
    """
    outcome = compute(campaign, number, 1).outcomes[0]
    rock = slope.instance.component.instance(**slope.instance.sizes)
    rock.w[:] = campaign.w
    set_rock_of(campaign, number, rock)
    rock["trial"] = number
    rock.initialise()
    end = float(outcome[OUTCOME.time])
    times = np.append(np.arange(0.0, end, interval), end)
    rows = np.empty((len(times), len(_OUTPUTS)))
    places = [rock.references[name] for name in _OUTPUTS.values()]
    rows[0] = rock.w[places]
    for i in range(1, len(times)):
        rock.step(times[i - 1], times[i] - times[i - 1])
        rows[i] = rock.w[places]
    curves = dict(zip(_OUTPUTS, rows.T, strict=True))
    long = float(rock["elongation"]) if slope.site.rock.shape == "ellipse" else 1.0
    words = ENDS[int(outcome[OUTCOME.end])]
    return Replay(number, words, times, **curves, radius=float(rock["radius"]), elongation=long)


def events_of(campaign: Campaign, number: int) -> NDArray[np.float64]:
    """Compute a trial, and return the motion at its start, its events and its end.

    Parameters
    ----------
    campaign : Campaign
        To which the trial belongs.
    number : int
        Of the trial.

    Returns
    -------
    array of float, shape (n, len(KNOT))
        Between two rows the accelerations are constant.
    """
    w, x, k, rocks = own_buffers(campaign, number, 1)
    if len(rocks):
        set_rock(rocks[0], w, x, k)
    knots = np.empty((_FEWEST_KNOTS, len(KNOT)))
    while True:
        lines, barriers = campaign.lines, campaign.barriers
        where = (campaign.left, campaign.right, lines, barriers)
        count = trace(campaign.seed, number, *where, w, x, k, np.zeros(len(BODY)), knots)
        if count < len(knots) or len(knots) >= MOST_EVENTS:
            return knots[:count]
        knots = np.empty((8 * len(knots), len(KNOT)))

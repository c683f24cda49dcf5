"""The rock of a campaign with which a shed is computed: that of a percentile, or of a trial."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.records import ARRIVAL, KNOT

from ..core.errors import Problem, counted
from ..metrics.percentiles import Percentile, needed, percentile, proportion, rank
from ..sites.rockfall.preparation import PreparedSlope
from .arrivals import Receiver
from .campaign import Campaign
from .replay import events_of
from .roof import CushionOnProfile, Strikes

ENERGY, SPEED = "energy", "speed"
"""Quantities of which a percentile is taken: kinetic energy (J) and speed (m/s)."""
PERCENT = 95.0
"""Percentile where neither it nor a trial is given."""
_POINTS = 12
"""Points of a stretch of motion in a drawn trajectory."""


@dataclass(frozen=True)
class Choice:
    """How a rock is chosen.

    Attributes
    ----------
    quantity : str
        :data:`ENERGY` or :data:`SPEED`, both at the cushion's surface.
    percent : float
        Percentile of it, in percent; where a trial is given it has no meaning.
    trial : int or None
        Number of the trial that is taken.
    """

    quantity: str = ENERGY
    percent: float = PERCENT
    trial: int | None = None


@dataclass(frozen=True)
class ChosenRock:
    """A rock of a campaign that strikes a cushion.

    Attributes
    ----------
    slope : PreparedSlope
        The site.
    campaign : Campaign
        Its trials.
    cushion : CushionOnProfile
        Where it lies.
    receiver : Receiver
        The box in which rocks are handed over.
    arrived : array of float, shape (trials, len(ARRIVAL))
        Rocks at the box.
    strikes : Strikes
        Rocks that strike the cushion.
    choice : Choice
        How it was chosen.
    place : int
        Of the rock in ``strikes``.
    """

    slope: PreparedSlope
    campaign: Campaign
    cushion: CushionOnProfile
    receiver: Receiver
    arrived: NDArray[np.float64]
    strikes: Strikes
    choice: Choice
    place: int

    @property
    def trial(self) -> int:
        """Number of its trial in the campaign, from 0."""
        return int(self.strikes.number[self.place])

    @property
    def values(self) -> NDArray[np.float64]:
        """The quantity of all rocks that strike the cushion (J or m/s)."""
        return values_of(self.strikes, self.choice.quantity)

    @property
    def percentile(self) -> Percentile | None:
        """The percentile with its interval; None where a trial was given."""
        if self.choice.trial is not None:
            return None
        return percentile(np.sort(self.values), self.choice.percent / 100.0)

    @property
    def share(self) -> tuple[float, float, float]:
        """Part of the trials whose rock strikes the cushion, and its interval."""
        count = len(self.strikes.number)
        return count / self.strikes.trials, *proportion(count, self.strikes.trials)

    def trajectory(self) -> list[list[float]]:
        """Return the way of its centre down to the hand-over as points, x and y in m."""
        events = events_of(self.campaign, self.trial)
        until = float(self.arrived[self.trial, ARRIVAL.time])
        return [[float(x), float(y)] for x, y in _points(events, until)]


def _points(events: NDArray[np.float64], until: float) -> Iterator[tuple[float, float]]:
    """Yield points between the events of a trial, up to a time (s)."""
    ends = [*events[1:, KNOT.time], until]
    for row, end in zip(events, ends, strict=True):
        last = min(end, until) - row[KNOT.time]
        if last < 0.0:
            return
        for t in np.linspace(0.0, last, _POINTS):
            yield (
                row[KNOT.x] + t * (row[KNOT.vx] + 0.5 * t * row[KNOT.ax]),
                row[KNOT.y] + t * (row[KNOT.vy] + 0.5 * t * row[KNOT.ay]),
            )


def values_of(strikes: Strikes, quantity: str) -> NDArray[np.float64]:
    """Return a quantity of all rocks that strike a cushion (J or m/s), shape (n,)."""
    return strikes.energy if quantity == ENERGY else strikes.speed


def chosen_place(strikes: Strikes, choice: Choice) -> int:
    """Return the place of a rock among those that strike the cushion.

    Of equal values the earlier trial comes first.

    Parameters
    ----------
    strikes : Strikes
        Of which :func:`choice_problems` finds no fault.
    choice : Choice
        Percentile or trial.
    """
    if choice.trial is not None:
        return int(np.searchsorted(strikes.number, choice.trial))
    order = np.argsort(values_of(strikes, choice.quantity), kind="stable")
    return int(order[rank(len(order), choice.percent / 100.0)])


def choice_problems(
    strikes: Strikes, choice: Choice, arrived: NDArray[np.float64], where: Sequence[str]
) -> Iterator[Problem]:
    """Yield why no rock can be chosen so.

    Parameters
    ----------
    strikes : Strikes
        Rocks that strike the cushion.
    choice : Choice
        Percentile or trial.
    arrived : array of float, shape (trials, len(ARRIVAL))
        Rocks at the box around the cushion.
    where : sequence of str
        Places of the roof, of the percentile and of the trial in the project.

    Yields
    ------
    Problem
    """
    at_roof, at_percent, at_trial = where
    count = len(strikes.number)
    if not count:
        text = f"no rock strikes the cushion: {in_words(strikes)}"
        remedy = "correct slope.x and slope.y, or take more trials"
        yield Problem(at_roof, text, remedy)
    elif choice.trial is not None:
        if choice.trial not in strikes.number:
            yield Problem(at_trial, *_missed(strikes, choice.trial, arrived))
    elif needed(choice.percent / 100.0) > count:
        fewest = needed(choice.percent / 100.0)
        text = (
            f"slope.percentile: {count} rocks that strike the cushion do not bear "
            f"{choice.percent:g} %: its 95 % interval has two bounds from {fewest} on"
        )
        wanted = -(-fewest * strikes.trials // count)
        yield Problem(at_percent, text, f"give some {wanted:,} trials, or a lower percentile")


def _missed(strikes: Strikes, trial: int, arrived: NDArray[np.float64]) -> tuple[str, str]:
    """Return why a trial cannot be taken, and what to do."""
    remedy = f"trials that strike it: {', '.join(map(str, strikes.number[:5]))}, ..."
    if trial >= strikes.trials:
        return f"slope.trial: the campaign has {strikes.trials:,} trials, from 0 on", remedy
    if not arrived[trial, ARRIVAL.arrived]:
        return f"slope.trial: the rock of trial {trial} does not come to the roof", remedy
    text = (
        f"slope.trial: the rock of trial {trial} comes to the roof, and does not strike the "
        "cushion a radius or more from its ends"
    )
    return text, remedy


def in_words(strikes: Strikes) -> str:
    """Return where the rocks of a campaign go, in a line.

    Parameters
    ----------
    strikes : Strikes
        Of the campaign.
    """
    told = (
        (len(strikes.number), "strike the cushion"),
        (strikes.on_ends, "strike it within a radius of an end"),
        (strikes.beyond, "come by over it"),
        (strikes.below, "come from the side, below its surface"),
        (strikes.elsewhere, "do not come to the roof"),
    )
    listed = ", ".join(f"{number:,} {words}" for number, words in told if number)
    return f"of {counted(strikes.trials, 'rock')} {listed}"

"""From the table ``[iteration]`` to places on the buses, and the schedule that is iterated.

A window is iterated: the time after which all components have come to a common exchange, one
exchange where no component is slower. In an iteration, one component after the other makes all its
steps of the window. Each step has inputs of its own, between the values at exchanges.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import ceil, lcm

import numpy as np
from numpy.typing import NDArray

from ..errors import Problem
from ..fmu.slave import REAL
from .iteration import InputMoment, IteratedConnection, Iteration
from .names import nearest, select
from .plan import End, PlannedIteration
from .schedule import Action, Operation, Schedule
from .system import SystemSpec


def iterated_schedule(order: Sequence[str], steps: Mapping[str, int], exchange: int) -> Schedule:
    """Order the operations of each exchange of a window.

    Parameters
    ----------
    order : sequence of str
        Components.
    steps : mapping of str to int
        Communication step of each component (ticks).
    exchange : int
        Exchange step (ticks).

    Returns
    -------
    Schedule
        Its period is a window. Inputs are set before each step, and carry the times of that step.
    """
    period = lcm(*(max(1, steps[name] // exchange) for name in order))
    return Schedule(
        exchange,
        tuple(
            tuple(o for name in order for o in _turn(number, name, steps[name], exchange))
            for number in range(period)
        ),
    )


def _turn(number: int, name: str, step: int, exchange: int) -> list[Operation]:
    """Return the operations of a component in an exchange; none where its step goes on."""
    end = (number + 1) * exchange
    if end % max(step, exchange):
        return []
    begins = range(end - max(step, exchange), end, step)
    pairs = [
        (Operation(Action.SET, name, at, step), Operation(Action.STEP, name, at, step))
        for at in begins
    ]
    return [*(operation for pair in pairs for operation in pair), Operation(Action.GET, name)]


def plan_iteration(
    system: SystemSpec, inputs: Sequence[End], outputs: Sequence[End], source: Sequence[int]
) -> PlannedIteration | None:
    """Replace names by places; return None with another master.

    Parameters
    ----------
    system : SystemSpec
        Checked.
    inputs, outputs : sequence of End
        The buses.
    source : sequence of int
        Place among the outputs that feeds each input; one behind them feeds none.
    """
    if system.master != "implicit":
        return None
    feeding = [outputs[place] if place < len(outputs) else None for place in source]
    rules = [_rule(system.iteration, end, target) for end, target in zip(feeding, inputs)]
    return PlannedIteration(
        tuple(moment for moment, _, _ in rules),
        np.array([tolerance for _, tolerance, _ in rules]),
        np.array([absolute for _, _, absolute in rules]),
    )


def _rule(
    iteration: Iteration, source: End | None, target: End
) -> tuple[InputMoment, float, float]:
    """Return moment, tolerance and tolerated difference of a connection."""
    moment, tolerance, absolute = iteration.input, iteration.tolerance, iteration.absolute
    if source is not None:
        for entry in iteration.connections:
            if _names(entry, source, target):
                moment = entry.input or moment
                tolerance = entry.tolerance or tolerance
                absolute = entry.absolute or absolute
        if source.port.kind != REAL:
            moment = "end"
    return moment, tolerance, absolute


def _names(entry: IteratedConnection, source: End, target: End) -> bool:
    return bool(select(entry.source, [source.name]) and select(entry.target, [target.name]))


def iteration_problems(iteration: Iteration, links: Iterable[tuple[End, End]]) -> list[Problem]:
    """Return what is wrong with a table: entries that name no connection.

    Parameters
    ----------
    iteration : Iteration
        Of the system.
    links : iterable of (End, End)
        Source and target of every connection.
    """
    known = list(links)
    names = [f"{source.name} -> {target.name}" for source, target in known]
    return [
        Problem("iteration.connections", f"{entry} is no connection", nearest(str(entry), names))
        for entry in iteration.connections
        if not any(_names(entry, source, target) for source, target in known)
    ]


def weights(
    moment: InputMoment, step: tuple[float, float], every: int, period: int
) -> NDArray[np.float64]:
    """Return how much each exchange of a window counts for an input.

    Parameters
    ----------
    moment : str
        Of the values.
    step : (float, float)
        Beginning and end of the step of the target, in exchanges since the window began.
    every : int
        Number of exchanges after which the source has new values.
    period : int
        Number of exchanges in the window.

    Returns
    -------
    array of float, shape (period + 1,)
        For the beginning of the window, and the end of each of its exchanges.
    """
    found = np.zeros(period + 1)
    begin, end = step
    if moment == "mean":
        for last in range(every, period + every, every):
            overlap = min(end, last) - max(begin, last - every)
            found[last] += max(0.0, overlap) / (end - begin) if last <= period else 0.0
        return found
    at = {"begin": begin, "middle": 0.5 * (begin + end), "end": end}[moment]
    last = max(every, ceil(at / every) * every)
    part = (at - (last - every)) / every
    found[last - every] = 1.0 - part
    found[last] = part
    return found

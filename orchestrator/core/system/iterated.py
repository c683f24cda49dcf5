"""From the table ``[iteration]`` to places on the buses, and the schedule that is iterated.

A window is iterated: the time after which all components have come to a common exchange, one
exchange where no component is slower. In an iteration, one component after the other makes all its
steps of the window. Each step has inputs of its own, between the values at exchanges.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from ..errors import Problem
from ..fmu.slave import REAL
from .iteration import InputMoment, IteratedConnection, Iteration
from .names import nearest, select
from .plan import End, PlannedIteration
from .schedule import Action, Operation, Schedule
from .system import SystemSpec
from .timing import Timing


def iterated_schedule(
    order: Sequence[str], steps: Mapping[str, int], exchange: int, window: int
) -> Schedule:
    """Order the operations of each exchange of a window.

    Parameters
    ----------
    order : sequence of str
        Components.
    steps : mapping of str to int
        Communication step of each component (ticks).
    exchange : int
        Exchange step (ticks).
    window : int
        Exchanges that are iterated together, a multiple of those of each step.

    Returns
    -------
    Schedule
        Its period is the window. Inputs are set before each step, and carry the times of that step.
    """
    return Schedule(
        exchange,
        tuple(
            tuple(o for name in order for o in _turn(number, name, steps[name], exchange))
            for number in range(window)
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


def window_problems(system: SystemSpec, timing: Timing) -> list[Problem]:
    """Return what does not go together with the length of a window.

    Parameters
    ----------
    system : SystemSpec
        With the implicit master.
    timing : Timing
        Of its run.
    """
    problems = []
    order = system.iteration.interpolation
    if timing.window < order:
        has = "one exchange" if timing.window == 1 else f"{timing.window} exchanges"
        window = timing.lasts(order * timing.exchange)
        what = f"is {order}, and the window has {has}"
        remedy = f"let iteration.window be {window:g} s or more, or leave it out"
        problems.append(Problem("iteration.interpolation", what, remedy))
    slow = [name for name in timing.steps if timing.steps[name] > timing.exchange]
    if timing.window > 1 and system.scenario:
        why = f", while {', '.join(slow)} steps over several exchanges" if slow else ""
        what = f"with the implicit master and a window of {timing.window} exchanges{why}"
        remedy = "choose another master, or a window and steps of one exchange"
        problems.append(Problem("scenario", what, remedy))
    return problems


def weights(
    moment: InputMoment, step: tuple[float, float], every: int, period: int, order: int = 1
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
    order : int
        Of the polynomial between the values; lower where the window has too few of them.

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
    interval = max(1, ceil(at / every)) - 1
    known = period // every
    degree = min(order, known)
    first = min(max(0, interval - degree // 2), known - degree)
    points = [at / every - first]
    if moment == "middle" and degree > 1:  # two points have the mean of a polynomial up to cubic
        apart = 0.5 * (end - begin) / every / sqrt(3.0)
        points = [points[0] - apart, points[0] + apart]
    nodes = slice(every * first, every * (first + degree) + 1, every)
    found[nodes] = np.mean([_counts(degree, point) for point in points], axis=0)
    return found


def _counts(degree: int, at: float) -> NDArray[np.float64]:
    """Return how much values at 0, 1, 2, ... count in the value of their polynomial (Lagrange)."""
    nodes = np.arange(degree + 1.0)
    others = [np.delete(nodes, node) for node in range(degree + 1)]
    return np.array([np.prod((at - other) / (node - other)) for node, other in enumerate(others)])

"""Inputs between exchanges, compiled: polynomials through the newest values.

In each step an input has the mean of its polynomial over the step. A component that holds it then
gets the impulse (of a force) or the way (of a velocity) that the polynomial has, whatever the
number of its steps; the middle of the step, which is the same up to order 1, would lose that of a
parabola.
"""

from collections.abc import Callable
from typing import Any

from numba import njit


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a function of the loop with numba.

    Nothing is allocated, so arrays need no counted references; counting them would cost 7 us an
    exchange.
    """
    return njit(error_model="numpy", _nrt=False)(function)


@compiled
def keep_values(tables, move, now):  # type: ignore[no-untyped-def]
    """Let the polynomials of a component have the values on the bus, which are set at a tick."""
    for i in range(move["first_extrapolated"], move["end_extrapolated"]):
        entry = tables.extrapolated[i]
        every = entry["every"]
        since = now + entry["ahead"] * tables.units - tables.start
        shown = tables.start + since // every * every
        jumps = tables.jumps[entry["owner"]]
        if jumps != entry["jumps"]:  # what was before says nothing about what comes
            entry["known"] = 0
            entry["jumps"] = jumps
        if entry["known"] == 0 or shown != entry["newest"]:
            entry["oldest"] = entry["older"]
            entry["earliest"] = entry["before"]
            entry["older"] = entry["newest"]
            entry["before"] = entry["value"]
            entry["newest"] = shown
            entry["known"] = min(entry["known"] + 1, 3)
        entry["value"] = tables.inputs[entry["place"]]


@compiled
def extrapolate(tables, move, begin, length):  # type: ignore[no-untyped-def]
    """Write the means of the polynomials of a component over a step (ticks) onto the bus."""
    for i in range(move["first_extrapolated"], move["end_extrapolated"]):
        entry = tables.extrapolated[i]
        tables.inputs[entry["place"]] = mean_over(entry, begin, length)


@compiled
def mean_over(entry, begin, length):  # type: ignore[no-untyped-def]
    """Return the mean of a polynomial over a step (ticks), in Newton's form.

    With u since the newest of the values f0, f1, f2 at the times 0, -a, -b, it is f0 + p u +
    q u (u + a), with the divided differences p and q.
    """
    order = min(entry["order"], entry["known"] - 1)
    value = entry["value"]
    if order < 1:
        return value
    first = float(begin - entry["newest"])
    last = first + float(length)
    a = float(entry["newest"] - entry["older"])
    slope = (value - entry["before"]) / a
    middle = 0.5 * (first + last)
    mean = value + slope * middle
    if order < 2:
        return mean
    b = float(entry["newest"] - entry["oldest"])
    curvature = (slope - (entry["before"] - entry["earliest"]) / (b - a)) / b
    squares = (first * first + first * last + last * last) / 3.0
    return mean + curvature * (squares + a * middle)


@compiled
def look_for_jumps(tables, operation):  # type: ignore[no-untyped-def]
    """Count an event of a component if an output that changes at events alone has changed."""
    changed = 0
    for i in range(operation["first_discrete"], operation["end_discrete"]):
        entry = tables.discrete[i]
        value = tables.outputs[entry["place"]]
        if value != entry["last"]:
            changed = 1
            entry["last"] = value
    tables.jumps[operation["owner"]] += changed

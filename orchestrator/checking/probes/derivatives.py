"""Probes of partial derivatives, directional and adjoint."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...core.errors import counted
from ..subject.motions import course, first_difference
from ..subject.partial import (
    DerivativeState,
    Matrix,
    after_a_step,
    elements,
    quotients,
    while_initialising,
)
from ..subject.subject import Subject
from ..subject.variables import Declared
from ..verdicts import BAD, Seen, failed, not_applicable, passed

_NEAR = 1e-3
"""Relative difference of two derivatives that are equal: FMUs may take differences themselves."""
_STEPS = 3
"""Steps that are compared after derivatives were asked for."""
_NOTHING = "there is no real unknown, or nothing by which it may be derived"
_REMEDY = "derive the equations of this state; keep to the order of unknowns, knowns and seeds"


def _lacking(subject: Subject, adjoint: bool = False) -> Seen | None:
    """Return that the description provides no such derivatives, if that is so."""
    if adjoint:
        flag = "providesAdjointDerivatives"
        provided = subject.can.providesAdjointDerivatives
    else:
        flag = "providesDirectionalDerivative" + ("s" if subject.version == 3 else "")
        provided = subject.has_directional_derivatives
    return None if provided else not_applicable(f"{flag} is false")


def running(subject: Subject) -> Seen:
    """Compare directional derivatives with quotients of differences, after a step."""
    return _lacking(subject) or _compared(subject, after_a_step(subject))


def initialising(subject: Subject) -> Seen:
    """Compare directional derivatives with quotients of differences, while initialising."""
    return _lacking(subject) or _compared(subject, while_initialising(subject))


def undeclared(subject: Subject) -> Seen:
    """Look for derivatives by variables that the description declares no dependency on."""
    return _lacking(subject) or _in_both_states(subject, _undeclared)


def linear(subject: Subject) -> Seen:
    """Ask for several seeds at once, in two orders, and compare with the sum of single ones."""
    return _lacking(subject) or _in_both_states(subject, _not_linear)


def adjoint(subject: Subject) -> Seen:
    """Compare adjoint derivatives with directional ones, or else with quotients of differences."""
    if nothing := _lacking(subject, adjoint=True):
        return nothing
    if _lacking(subject) is None:
        return _in_both_states(subject, _not_transposed)
    found = [
        _in_both_states(subject, partial(_undeclared, adjoint=True)),
        _in_both_states(subject, partial(_not_linear, adjoint=True)),
        _compared(subject, after_a_step(subject), adjoint=True),
        _compared(subject, while_initialising(subject), adjoint=True),
    ]
    return next((seen for seen in found if seen.verdict in BAD), found[0])


def unchanged(subject: Subject) -> Seen:
    """Make steps with and without asking for derivatives before them."""
    ways = [way for way in (False, True) if _lacking(subject, adjoint=way) is None]
    if not ways:
        return _lacking(subject) or not_applicable(_NOTHING)
    courses = []
    for asks in (False, True):
        asked = after_a_step(subject)
        if asked.is_empty:
            return not_applicable(_NOTHING)
        for way in ways if asks else ():
            asked.told(adjoint=way)
        courses.append(course(subject, asked.instance, _STEPS, subject.readable))
        asked.instance.free()
    if difference := first_difference(*courses):
        return failed(
            f"after derivatives were asked for {difference}",
            "put everything back that is changed to find a derivative",
        )
    return passed(f"{counted(_STEPS, 'step')} are the same bit for bit after derivatives")


# ---------------------------------------------------------------- looks


def _in_both_states(subject: Subject, look: Callable[[DerivativeState], Seen | None]) -> Seen:
    """Look at the derivatives after a step and while initialising, until something is wrong."""
    number = 0
    for state in (after_a_step, while_initialising):
        asked = state(subject)
        if not asked.is_empty:
            if seen := look(asked):
                return seen
            number += len(elements(asked.unknowns)) * len(elements(asked.knowns))
        asked.instance.free()
    if not number:
        return not_applicable(_NOTHING)
    return passed(f"{counted(number, 'derivative')}, after a step and while initialising")


def _undeclared(asked: DerivativeState, adjoint: bool = False) -> Seen | None:
    told = asked.told(adjoint)
    if lost := _not_finite(asked, told):
        return lost
    hidden = asked.dependencies(declared=False) & (told != 0.0)
    return _said(
        asked,
        hidden,
        lambda at: f"is {told[at]:.6g}, and the dependency is not declared",
        "declare the dependency, or return 0",
    )


def _not_linear(asked: DerivativeState, adjoint: bool = False) -> Seen | None:
    told = asked.told(adjoint)
    if lost := _not_finite(asked, told):
        return lost
    matrix = told.T if adjoint else told
    seed = (-1.0) ** np.arange(matrix.shape[1]) * (1.5 + np.arange(matrix.shape[1]))
    sums, room = matrix @ seed, _NEAR * (np.abs(matrix) @ np.abs(seed))
    chosen = elements(asked.knowns if adjoint else asked.unknowns)
    for way in ("", " in another order"):
        found = _weighted(asked, seed, adjoint, backwards=bool(way))
        for (_, name), its, total, most in zip(chosen, found, sums, room, strict=True):
            if not abs(its - total) <= most:
                return failed(
                    f"for {counted(len(seed), 'seed')} at once{way} the derivative of {name} "
                    f"{asked.when} is {its:.6g}, and the sum of those for each is {total:.6g}",
                    "add up the derivatives times their seeds, in the order of the call",
                )
    return None


def _weighted(asked: DerivativeState, seed: Matrix, adjoint: bool, backwards: bool) -> list[float]:
    """Return the derivatives for a seed for all at once, asked for perhaps in another order."""
    unknowns, knowns = asked.unknowns, asked.knowns
    if not backwards:
        return asked.instance.derivatives(unknowns, knowns, list(seed), adjoint)
    weighted, chosen = (unknowns, knowns) if adjoint else (knowns, unknowns)
    turned = [value for part in _parts(seed, weighted)[::-1] for value in part]
    found = asked.instance.derivatives(unknowns[::-1], knowns[::-1], turned, adjoint)
    return [value for part in _parts(np.array(found), chosen[::-1])[::-1] for value in part]


def _parts(values: Matrix, variables: Sequence[Declared]) -> list[Matrix]:
    """Return the values of the elements of each variable."""
    return np.split(values, np.cumsum([variable.size for variable in variables])[:-1])


def _not_transposed(asked: DerivativeState) -> Seen | None:
    directional, found = asked.told(), asked.told(adjoint=True)
    if lost := _not_finite(asked, directional) or _not_finite(asked, found):
        return lost
    room = _NEAR * np.maximum(np.abs(directional), np.abs(found))
    wrong = np.abs(found - directional) > room
    return _said(
        asked,
        wrong,
        lambda at: f"is {found[at]:.6g} as an adjoint and {directional[at]:.6g} as a directional",
        "weigh the unknowns and return one derivative for each known",
    ) or _not_linear(asked, adjoint=True)


def _compared(subject: Subject, asked: DerivativeState, adjoint: bool = False) -> Seen:
    """Compare derivatives by declared knowns with quotients of differences."""
    if asked.is_empty:
        return not_applicable(_NOTHING)
    told = asked.told(adjoint)
    if lost := _not_finite(asked, told):
        return lost
    found = quotients(subject, asked)
    asked.instance.free()
    looked = asked.dependencies(declared=True) & found.known
    if not np.any(looked):
        return not_applicable(
            "none of the knowns that may be set moves an unknown that depends on it"
        )
    room = _NEAR * np.maximum(np.abs(found.central), np.abs(told))
    wrong = looked & ~((found.lowest - room <= told) & (told <= found.highest + room))
    return _said(
        asked,
        wrong,
        lambda at: f"is {told[at]:.6g}, and differences give {found.central[at]:.6g}",
        _REMEDY,
    ) or passed(f"{counted(int(looked.sum()), 'derivative')} {asked.when} as differences give them")


def _not_finite(asked: DerivativeState, told: Matrix) -> Seen | None:
    return _said(
        asked,
        ~np.isfinite(told),
        lambda at: f"is {told[at]}, or is left as it was",
        "return a finite number for each, or an error",
    )


def _said(
    asked: DerivativeState,
    wrong: NDArray[np.bool_],
    about: Callable[[tuple[int, int]], str],
    remedy: str,
) -> Seen | None:
    """Return that derivatives are wrong, with the first of them; None where none is."""
    places = np.argwhere(wrong)
    if not len(places):
        return None
    at = (int(places[0][0]), int(places[0][1]))
    more = f"; {len(places) - 1} more are wrong" if len(places) > 1 else ""
    return failed(f"{asked.word(*at)} {about(at)}{more}", remedy)

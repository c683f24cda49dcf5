"""Partial derivatives of the FMU under check: those that it tells, and quotients of differences.

FMI 2.0 (2.1.9) and 3.0 (2.2.11) let them be asked for in the initialisation mode, of the initial
unknowns, and between steps, of outputs and of derivatives of states.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .calls import Called, CallRefused
from .subject import Subject
from .variables import Declared, Numbers

Matrix = NDArray[np.float64]
"""A row for each element of the unknowns, a column for each of the knowns."""

_MOST_ELEMENTS = 300
"""Elements of unknowns, and of knowns, that are looked at."""
_CHANGES = {"Float32": 1e-2}
_CHANGE = 1e-4
"""Change of a known for a quotient of differences, in its usual size."""
_ROUNDING = {"Float32": 1e-5}
_ROUNDING_OF_DOUBLE = 1e-13
"""Part of a value that rounding may take, with some calculation behind it."""
_AWAY = 1 / 64
"""Distance of inputs from their start values, in their usual size, at the most twice as much."""
_SHORT = 1e-6
"""Length of a short step, in communication steps."""


@dataclass(frozen=True)
class DerivativeState:
    """An instance in a state in which FMI lets derivatives be asked for.

    Attributes
    ----------
    when : str
        The state, in words.
    instance : Called
        In this state.
    unknowns, knowns : list of Declared
        Variables that may be derived, and by which.
    movable : frozenset of str
        Names of knowns that may be set in this state.
    depends : mapping of str to set of str, or None
        Knowns of each unknown, as declared; None where nothing is declared.
    at_once : bool
        Whether FMI has unknowns follow at once when a known is set, without a step.
    """

    when: str
    instance: Called
    unknowns: list[Declared]
    knowns: list[Declared]
    movable: frozenset[str]
    depends: Mapping[str, set[str] | None]
    at_once: bool

    @property
    def is_empty(self) -> bool:
        """Tell whether there is no derivative to ask for."""
        return not (self.unknowns and self.knowns)

    def word(self, row: int, column: int) -> str:
        """Return a derivative in words."""
        unknown, known = elements(self.unknowns)[row], elements(self.knowns)[column]
        return f"the derivative of {unknown[1]} by {known[1]} {self.when}"

    def dependencies(self, declared: bool) -> NDArray[np.bool_]:
        """Tell for each derivative whether its dependency is declared, or is not.

        Those of a variable by itself are neither: FMI does not have them declared.
        """
        return np.array(
            [
                [
                    unknown.name != known.name and self._is_declared(unknown, known) == declared
                    for known, _ in elements(self.knowns)
                ]
                for unknown, _ in elements(self.unknowns)
            ]
        )

    def _is_declared(self, unknown: Declared, known: Declared) -> bool:
        names = self.depends[unknown.name]
        return names is None or known.name in names

    def told(self, adjoint: bool = False) -> Matrix:
        """Return the derivatives that the FMU tells, one call for each column or row."""
        chosen = self.unknowns if adjoint else self.knowns
        lines = []
        for variable in chosen:
            for number in range(variable.size):
                seed = [float(place == number) for place in range(variable.size)]
                unknowns, knowns = self.unknowns, self.knowns
                groups = ([variable], knowns) if adjoint else (unknowns, [variable])
                lines.append(self.instance.derivatives(*groups, seed, adjoint))
        found = np.array(lines, dtype=float)
        return found if adjoint else found.T


def elements(variables: Sequence[Declared]) -> list[tuple[Declared, str]]:
    """Return each element of some variables, with its name."""
    return [
        (v, v.name if v.size == 1 else f"{v.name}[{number}]")
        for v in variables
        for number in range(1, v.size + 1)
    ]


# ---------------------------------------------------------------- states to ask in


def after_a_step(subject: Subject) -> DerivativeState:
    """Return an instance after a step with inputs away from their start values."""
    instance = subject.begun()
    _move_away(subject, instance)
    if instance.attempt(instance.step, subject.step).refused:  # not with such inputs
        instance.free()
        instance = subject.begun()
        instance.step(subject.step)
    listed = [*subject.model.outputs, *subject.model.derivatives]
    knowns = [v for v in subject.variables if _is_known_between_steps(subject, v)]
    derived = (unknown.variable.derivative for unknown in subject.model.derivatives)
    states = {state.name for state in derived if state is not None}
    states -= {v.name for v in knowns}
    movable = frozenset(v.name for v in knowns)
    knowns += [v for v in subject.variables if v.name in states]
    return _asked(subject, instance, listed, (knowns, movable), at_once=False)


def _is_known_between_steps(subject: Subject, variable: Declared) -> bool:
    if not variable.is_real:
        return False
    if variable.causality == "input":
        return variable.variability == "continuous"
    is_tunable = (variable.causality, variable.variability) == ("parameter", "tunable")
    return subject.version == 3 and is_tunable


def while_initialising(subject: Subject) -> DerivativeState:
    """Return an instance in the initialisation mode, its inputs away from their start values."""
    instance = subject.instantiate()
    instance.enter_initialisation(subject.start, subject.horizon)
    _move_away(subject, instance)
    knowns = [v for v in subject.variables if v.is_real and _is_known_at_the_start(v)]
    movable = frozenset(v.name for v in knowns)
    listed = subject.model.initialUnknowns
    return _asked(subject, instance, listed, (knowns, movable), at_once=True)


def _is_known_at_the_start(variable: Declared) -> bool:
    if variable.variability == "constant" or variable.causality == "structuralParameter":
        return False
    return variable.causality == "input" or variable.initial == "exact"


def _asked(
    subject: Subject,
    instance: Called,
    listed: Sequence[Any],
    known: tuple[list[Declared], frozenset[str]],
    at_once: bool,
) -> DerivativeState:
    depends = {
        u.variable.name: None if u.dependencies is None else {d.name for d in u.dependencies}
        for u in listed
    }
    unknowns = [v for v in subject.variables if v.name in depends and v.is_real]
    knowns, movable = known
    when = "while initialising" if at_once else "after a step"
    return DerivativeState(
        when, instance, _first(unknowns), _first(knowns), movable, depends, at_once
    )


def _first(variables: Sequence[Declared]) -> list[Declared]:
    """Return the first variables, as many as are looked at."""
    chosen: list[Declared] = []
    left = _MOST_ELEMENTS
    for variable in variables:
        if not variable.is_alias and 0 < variable.size <= left:
            chosen.append(variable)
            left -= variable.size
    return chosen


def _move_away(subject: Subject, instance: Called) -> None:
    """Set each real input to another distance from its start: zeros and equals hide mistakes."""
    number = 0
    for variable in subject.inputs(real=True):
        values = []
        for start in variable.start or ():
            number += 1
            by = _AWAY * (1.0 + 0.618034 * number % 1.0) * _usual_size(variable, start)
            values.append(next((v for v in (start + by, start - by) if variable.allows(v)), start))
        if values:
            instance.attempt(instance.set, variable, tuple(values))


def _usual_size(variable: Declared, value: float) -> float:
    return max(abs(value), variable.nominal)


# ---------------------------------------------------------------- quotients of differences


@dataclass(frozen=True)
class Quotients:
    """Quotients of differences of the unknowns: NaN where a known could not be changed.

    Attributes
    ----------
    central : Matrix
        Of two values about the present one.
    lowest, highest : Matrix
        Between them lies the derivative, as far as the values tell: of the quotients to both sides,
        which differ at a kink, with room for rounding.
    """

    central: Matrix
    lowest: Matrix
    highest: Matrix

    @property
    def known(self) -> NDArray[np.bool_]:
        """Tell for each derivative whether there is a quotient."""
        return np.isfinite(self.central)

    @property
    def still(self) -> NDArray[np.bool_]:
        """Tell for each unknown whether nothing moves it."""
        return ~np.any(np.nan_to_num(self.central) != 0.0, axis=1)

    def without(self, rows: NDArray[np.bool_]) -> "Quotients":
        """Return them without the quotients of some unknowns."""
        nothing = np.full_like(self.central, math.nan)
        return self.replaced(rows, Quotients(nothing, nothing, nothing))

    def replaced(self, rows: NDArray[np.bool_], by: "Quotients") -> "Quotients":
        """Return them with those of some unknowns from others."""
        chosen = rows[:, np.newaxis]
        return Quotients(
            np.where(chosen, by.central, self.central),
            np.where(chosen, by.lowest, self.lowest),
            np.where(chosen, by.highest, self.highest),
        )

    def widened(self, by: Matrix) -> "Quotients":
        """Return them with more room."""
        return Quotients(self.central, self.lowest - by, self.highest + by)


def quotients(subject: Subject, asked: DerivativeState) -> Quotients:
    """Return quotients of differences of the unknowns by the knowns that may be set.

    Values are read at once after a known is set. Between steps FMI allows outputs that follow with
    the next step only: for those the state is taken back, and a very short step made with each
    value. What does not follow then either has no quotients.
    """
    found = _quotients(asked, _AtOnce(asked))
    still = found.still
    if asked.at_once or not np.any(still):
        return found
    can = subject.can
    if not (can.canGetAndSetFMUstate and can.canHandleVariableCommunicationStepSize):
        return found.without(still)
    state = asked.instance.state()
    near, far = (
        _quotients(asked, _AfterShortStep(asked, state, part * subject.step))
        for part in (_SHORT, 10.0 * _SHORT)
    )
    near = near.widened(np.abs(far.central - near.central))
    return found.replaced(still, near.without(near.still))


class _AtOnce:
    """Sets a known and reads the unknowns."""

    def __init__(self, asked: DerivativeState) -> None:
        self._asked = asked

    def __call__(self, known: Declared, values: Numbers) -> Matrix:
        """Return the values of the unknowns with other values of a known."""
        self._asked.instance.set(known, values)
        return self.read()

    def read(self) -> Matrix:
        """Return the present values of the unknowns."""
        found = self._asked.instance.get(self._asked.unknowns)
        return np.array([value for values in found.values() for value in values], dtype=float)


class _AfterShortStep(_AtOnce):
    """Goes back to a state, sets a known, makes a short step and reads the unknowns."""

    def __init__(self, asked: DerivativeState, state: Any, step: float) -> None:
        super().__init__(asked)
        self._state = state
        self._time = asked.instance.time
        self._step = step

    def __call__(self, known: Declared, values: Numbers) -> Matrix:
        """Return the values of the unknowns after a short step with other values of a known."""
        instance = self._asked.instance
        instance.restore(self._state)
        instance.time = self._time
        instance.set(known, values)
        instance.step(self._step)
        return self.read()


def _quotients(asked: DerivativeState, response: _AtOnce) -> Quotients:
    columns = [column for known in asked.knowns for column in _columns(asked, response, known)]
    central, lowest, highest = (np.array(part).T for part in zip(*columns, strict=True))
    return Quotients(central, lowest, highest)


def _columns(
    asked: DerivativeState, response: _AtOnce, known: Declared
) -> Iterator[tuple[Matrix, Matrix, Matrix]]:
    """Yield a column of quotients and their range for each element of a known."""
    unknown = np.full(len(elements(asked.unknowns)), math.nan)
    nothing = (unknown, unknown, unknown)
    if known.name not in asked.movable:
        yield from [nothing] * known.size
        return
    (own,) = asked.instance.get([known]).values()
    for place in range(known.size):
        try:
            yield _column(asked, response, known, (own, place)) or nothing
        except CallRefused:
            yield nothing


def _column(
    asked: DerivativeState, response: _AtOnce, known: Declared, at: tuple[Numbers, int]
) -> tuple[Matrix, Matrix, Matrix] | None:
    own, place = at
    by = _CHANGES.get(known.kind, _CHANGE) * _usual_size(known, own[place])
    low, high = own[place] - by, own[place] + by
    if not (known.allows(low) and known.allows(high)):
        return None

    def answer(value: float) -> Matrix:
        return response(known, (*own[:place], value, *own[place + 1 :]))

    below, above, here = answer(low), answer(high), answer(own[place])
    sides = (here - below) / by, (above - here) / by
    kinds = [v.kind for v, _ in elements(asked.unknowns)]
    part = np.array([_ROUNDING.get(kind, _ROUNDING_OF_DOUBLE) for kind in kinds])
    rounding = part * np.maximum(np.abs(below), np.abs(above)) / by
    lowest, highest = np.minimum(*sides) - rounding, np.maximum(*sides) + rounding
    return (above - below) / (2.0 * by), lowest, highest

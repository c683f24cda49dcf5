"""Going back: states of FMUs kept in memory, and the proof that nothing is lost on the way.

An FMU may say that it can go back (``canGetAndSetFMUstate``) and forget half of it: an input, a
filter, a random number. What is iterated with it then converges to something else. So each FMU is
proved before the first exchange, by its first step, and refused by name.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple, cast

import numpy as np

from ..errors import InputRefused, Problem
from ..fmu.slave import FATAL, REAL, Slave, SlaveWithRollback
from ..loop.buses import Buses
from ..loop.exchange import Excerpt, ExchangeLoop
from ..system.schedule import Action

_NUDGE = 2.0**-20
"""Relative and absolute change of inputs between two steps that have to be the same."""


class Rollback:
    """Keeps the states of all slaves at one time, and goes back to them.

    Parameters
    ----------
    slaves : mapping of str to Slave
        Proved by :func:`prove_rollback`.
    """

    def __init__(self, slaves: Mapping[str, Slave]) -> None:
        self._slaves = {name: cast(SlaveWithRollback, slave) for name, slave in slaves.items()}

    def mark(self) -> None:
        """Keep the present states.

        Raises
        ------
        RuntimeError
            A slave failed; its name begins the text.
        """
        for slave in self._slaves.values():
            slave.mark()

    def roll_back(self) -> None:
        """Go back to the states that were kept.

        Raises
        ------
        RuntimeError
            A slave failed; its name begins the text.
        """
        for slave in self._slaves.values():
            slave.roll_back()


def prove_rollback(
    buses: Buses, slaves: Mapping[str, Slave], loop: ExchangeLoop, wanted_by: str
) -> None:
    """Prove that every slave comes back to the bit, by its first step.

    It makes the step three times from one state, and in between once with other inputs, which it
    has to forget. Each time it has to show the same outputs, and to have the same serialized state
    where it gives one. It is left in the state in which it was.

    Parameters
    ----------
    buses : Buses
        With the values after the initialisation; they stay.
    slaves : mapping of str to Slave
        Initialised, by component.
    loop : ExchangeLoop
        Between them.
    wanted_by : str
        What needs it.

    Raises
    ------
    InputRefused
        With all components that do not come back, and what differed.
    """
    problems = [
        Problem(name, f"cannot go back to an earlier state, and {wanted_by} needs that", _REMEDY)
        for name, slave in slaves.items()
        if not hasattr(slave, "mark")
    ]
    if not problems:
        kept = buses.inputs.copy(), buses.outputs.copy()
        for name in slaves:
            trial = _Trial(name, buses, slaves, loop)
            with _unheard(slaves[name]):
                differing = trial.difference()
            buses.inputs[:], buses.outputs[:] = kept
            if differing:
                what = f"does not come back to an earlier state, which {wanted_by} needs"
                problems.append(Problem(name, f"{what}: {differing}", _REMEDY))
        loop.warned_table[:] = 0
        loop.returned_table[:] = 0
    if problems:
        raise InputRefused(problems)


_REMEDY = "choose another master, or have the FMU keep all of its state"


class _Shown(NamedTuple):
    """Everything that a slave tells about its state: outputs, and serialized state or nothing."""

    outputs: bytes
    state: bytes


class _Trial:
    """The trial of one component."""

    def __init__(
        self, name: str, buses: Buses, slaves: Mapping[str, Slave], loop: ExchangeLoop
    ) -> None:
        self._name = name
        self._buses = buses
        self._slave = cast(SlaveWithRollback, slaves[name])
        self._serializes = buses.plan.descriptions[name].serializes_state
        self._set = self._part(loop, Action.SET)
        self._step = self._part(loop, Action.STEP)
        self._places = sorted(buses.shows[name])

    def _part(self, loop: ExchangeLoop, action: Action) -> Excerpt:
        """Return the first operation of this kind."""
        number = next(
            number
            for number, operation in enumerate(self._buses.operations)
            if (operation.component, operation.action) == (self._name, action)
        )
        return loop.part(number, number + 1)

    def difference(self) -> str:
        """Return what is not the same after going back; nothing if all is."""
        try:
            return self._difference()
        except RuntimeError as error:
            return str(error)

    def _difference(self) -> str:
        at_start = self._shown()
        self._slave.mark()
        if self._step.carry_out(0) is not None:  # then the run will tell of it
            self._slave.roll_back()
            return ""
        first = self._shown()
        self._slave.roll_back()
        self._step.carry_out(0)
        if told := self._differing(first, "after the same step again"):
            return told
        self._slave.roll_back()
        self._step_with_other_inputs()
        self._slave.roll_back()
        self._step.carry_out(0)
        if told := self._differing(first, "after a step with other inputs was taken back"):
            return told
        self._slave.roll_back()
        return self._differing(at_start, "after all steps were taken back")

    def _step_with_other_inputs(self) -> None:
        """Make a step that is taken back; whether the slave likes its inputs does not matter."""
        buses = self._buses
        kept = buses.outputs.copy()
        real = [end.port.kind == REAL for end in buses.plan.outputs]
        places = np.flatnonzero(real)
        buses.outputs[places] += _NUDGE * (1.0 + np.abs(buses.outputs[places]))
        if self._set.carry_out(0) is None:
            self._step.carry_out(0)
        buses.outputs[:] = kept

    def _shown(self) -> _Shown:
        outputs = self._buses.outputs
        for block in self._buses.getters.get(self._name, []):
            self._slave.get(block.references, outputs[block.places], block.type)
        shown = outputs[self._places].tobytes()
        return _Shown(shown, self._slave.state() if self._serializes else b"")

    def _differing(self, before: _Shown, when: str) -> str:
        now = self._shown()
        if now == before:
            return ""
        values = np.frombuffer(before.outputs)
        others = np.frombuffer(now.outputs)
        for place, value, other in zip(self._places, values, others):
            if value.tobytes() != other.tobytes():
                name = self._buses.plan.outputs[place].name
                return f"{name} is {other!s} {when}, and was {value!s}"
        return f"its serialized state is another {when}"


@contextmanager
def _unheard(slave: Slave) -> Iterator[None]:
    """Forget what a slave says meanwhile, unless it has failed beyond repair."""
    earlier = slave.messages
    slave.messages = type(earlier)()
    try:
        yield
    finally:
        for message in slave.messages:
            if message[0] == FATAL:
                earlier.append(message)
        slave.messages = earlier

"""Checkpoints of a run that goes on: everything that changes is taken from it, or put back.

What a run gets before its first step follows from its system and is made anew. What is put back is
held against what the components show, and where a run comes by a checkpoint that an earlier
process has written, it has to have the same values to the bit: the state of an FMU that does not
hold everything is found out.
"""

import math
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ...versions import sources_digest
from ..errors import InputRefused, Problem, RunFailed
from ..fmu.slave import Slave
from ..results.checkpoints import Checkpoint, write_checkpoint
from ..system.plan import Plan
from ..system.timing import exchanges_in
from .buses import Buses
from .ledger import Accounts
from .master import Master
from .recording import Hearing, Recorder

PROGRAM = "core"
"""Room of the package from which the course of a run follows, besides the FMUs."""
_REMEDY = "run it again from the start"


@dataclass(frozen=True)
class Parts:
    """The parts of a run whose values make up its state.

    Attributes
    ----------
    slaves : mapping of str to Slave
        By component.
    buses, accounts, recorder, master, hearing
        Of the run.
    """

    slaves: Mapping[str, Slave]
    buses: Buses
    accounts: Accounts
    recorder: Recorder
    master: Master
    hearing: Hearing

    @property
    def _tables(self) -> dict[str, NDArray[Any]]:
        """Values that are changed in their place."""
        buses = self.buses
        return {
            "inputs": buses.inputs,
            "outputs": buses.outputs,
            "channels": buses.channels,
            "watched": buses.watched,
            "linear": buses.linear,
            "fired": buses.fired,
            "extrapolated": buses.extrapolated,
            "discrete": buses.discrete,
            "jumps": buses.jumps,
            "warned": self.master.warned_table,
            "returned": self.master.returned_table,
        }

    def take(self) -> Checkpoint:
        """Return the state after the exchanges that have been carried out.

        Raises
        ------
        RunFailed
            A slave does not give its state.
        """
        self.recorder.flush()
        facts = {
            "program": sources_digest(PROGRAM),
            "rows": self.recorder.rows_passed,
            "frames": self.recorder.frames_passed,
            "times": self.master.times,
            "texts": dict(self.buses.texts.newest),
            "changes": {name: list(all_) for name, all_ in self.buses.texts.changes.items()},
            "said": {
                name: [[status, text, count] for (status, text), count in said.items()]
                for name, said in self.hearing.said.items()
            },
        }
        tables = {name: table.copy() for name, table in self._tables.items()}
        tables |= self.accounts.memory() | self.master.driver.memory()
        states = {name: self._state(slave) for name, slave in self.slaves.items()}
        return Checkpoint(self.master.exchanges, facts, tables, states)

    def _state(self, slave: Slave) -> bytes:
        try:
            return slave.state()
        except RuntimeError as error:
            raise RunFailed(slave.name, self.master.reached, str(error)) from error

    def put_back(self, checkpoint: Checkpoint) -> None:
        """Go to a state.

        Parameters
        ----------
        checkpoint : Checkpoint
            Of a run of the same system. All parts are those of a run before its first step.

        Raises
        ------
        InputRefused
            It is no state of this system, or components do not take theirs.
        """
        try:
            self._put_back(checkpoint)
        except (LookupError, TypeError, ValueError, AttributeError) as error:
            what = f"is no state of a run: {type(error).__name__}: {error}"
            raise InputRefused([Problem("checkpoint", what, _REMEDY)]) from error

    def _put_back(self, checkpoint: Checkpoint) -> None:
        """Go to a state; its hash is right, but anybody may have written that."""
        self._refuse_other(checkpoint)
        problems = [text for name in self.slaves if (text := self._restored(name, checkpoint))]
        if problems:
            raise InputRefused(problems)
        for name, table in self._tables.items():
            table[...] = checkpoint.tables[name]
        self.accounts.recall(checkpoint.tables)
        self.master.driver.recall(checkpoint.tables)
        self.recorder.rows_passed = checkpoint.rows
        self.recorder.frames_passed = checkpoint.frames
        self.buses.texts.newest = dict(checkpoint.facts["texts"])
        self.buses.texts.changes = {
            name: [(float(at), str(text)) for at, text in changes]
            for name, changes in checkpoint.facts["changes"].items()
        }
        self.hearing.earlier = {
            name: Counter({(int(status), str(text)): int(n) for status, text, n in said})
            for name, said in checkpoint.facts["said"].items()
        }
        self.master.go_to(checkpoint.exchange, checkpoint.facts["times"])

    def _refuse_other(self, checkpoint: Checkpoint) -> None:
        """Refuse the state of another system; the hash says that it is one of this program."""
        here = {**self._tables, **self.accounts.memory(), **self.master.driver.memory()}
        shapes = {name: (table.shape, table.dtype) for name, table in here.items()}
        found = {name: (table.shape, table.dtype) for name, table in checkpoint.tables.items()}
        if found != shapes or [*checkpoint.states] != [*self.slaves]:
            what = "is the state of another system"
            raise InputRefused([Problem("checkpoint", what, _REMEDY)])

    def _restored(self, name: str, checkpoint: Checkpoint) -> Problem | None:
        """Restore a slave, and return what is wrong with that."""
        slave = self.slaves[name]
        try:
            slave.restore(checkpoint.states[name])
        except RuntimeError as error:
            return Problem(name, f"does not take its state back: {error}", _REMEDY)
        timing = self.buses.plan.timing
        if checkpoint.exchange % max(1, timing.steps[name] // timing.exchange):
            return None  # its inputs are those of a step that has not been made
        before = checkpoint.tables["outputs"]
        shown = self.buses.outputs
        self.buses.take(slave)
        for place in sorted(self.buses.shows[name]):
            if shown[place].tobytes() != before[place].tobytes():
                end = self.buses.plan.outputs[place]
                return Problem(name, _other(end.name, shown[place], before[place], name), _REMEDY)
        return None

    def compare(self, taken: Checkpoint, witness: Checkpoint) -> None:
        """Compare the values of the master with those of an earlier process at this exchange.

        Parameters
        ----------
        taken, witness : Checkpoint
            Of this process and the earlier one, after the same number of exchanges.

        Raises
        ------
        InputRefused
            They differ; with the first output that does.
        """
        here = taken.tables
        if all(here[name].tobytes() == table.tobytes() for name, table in witness.tables.items()):
            return
        outputs = zip(self.buses.plan.outputs, here["outputs"], witness.tables["outputs"])
        at = f"at t = {self.master.reached:.9g} s"
        for end, value, before in outputs:
            if value.tobytes() != before.tobytes():
                what = f"{at}, {_other(end.name, value, before, 'a component')}"
                raise InputRefused([Problem("checkpoint", what, _REMEDY)])
        what = f"{at}, works or extremes are others than those that were computed before"
        raise InputRefused([Problem("checkpoint", what, _REMEDY)])


def _other(name: str, value: float, before: float, owner: str) -> str:
    return (
        f"{name} is {value!s}, and was {before!s} in the run: the serialized state of {owner} does "
        "not hold everything, or it does not compute the same twice"
    )


class Checkpointing:
    """Takes checkpoints at regular intervals.

    Parameters
    ----------
    every : int
        Number of exchanges between two checkpoints.
    folder : Path
        Folder in which the run writes.
    witness : Checkpoint, optional
        Of an earlier process, whose values this run has to come by.

    Attributes
    ----------
    parts : Parts
        Of the run; set before the first exchange.
    wall_time : float
        Time (s) that the checkpoints took.
    """

    parts: Parts

    def __init__(self, every: int, folder: Path, witness: Checkpoint | None = None) -> None:
        self.every = every
        self.wall_time = 0.0
        self._folder = folder
        self._witness = witness

    def next(self, exchange: int) -> int:
        """Return the number of exchanges after which the next checkpoint is taken."""
        return exchange - exchange % self.every + self.every

    def look(self, exchange: int) -> None:
        """Take a checkpoint if one is due.

        Raises
        ------
        RunFailed
            A slave does not give its state.
        InputRefused
            The values are not those of an earlier process.
        """
        if exchange % self.every or exchange == self.parts.buses.plan.timing.exchanges:
            return  # nothing goes on from the end
        began = time.perf_counter()
        taken = self.parts.take()
        if self._witness is not None and self._witness.exchange == exchange:
            self.parts.compare(taken, self._witness)
        write_checkpoint(self._folder, taken)
        self.wall_time += time.perf_counter() - began


def checkpoint_exchanges(plan: Plan, seconds: float | None) -> int:
    """Return the number of exchanges between two checkpoints.

    Parameters
    ----------
    plan : Plan
        Of the run.
    seconds : float or None
        Simulated time (s) between two checkpoints; None where there are none.

    Returns
    -------
    int
        0 for None.

    Raises
    ------
    InputRefused
        The time is no whole number of exchanges, or FMUs cannot serialize their states.
    """
    if seconds is None:
        return 0
    problems = [
        Problem(
            name,
            "its FMU cannot serialize its state (canSerializeFMUState), and a checkpoint needs "
            "that of every component",
            "leave checkpoint_every out, or export the FMU with it",
        )
        for name in plan.order
        if not plan.descriptions[name].serializes_state
    ]
    number = exchanges_in(plan.timing, seconds)
    problems += interval_problems(plan, number, seconds)
    if problems:
        raise InputRefused(problems)
    return number or 0


def interval_problems(plan: Plan, number: int | None, seconds: float) -> list[Problem]:
    """Return what is wrong with a time (s) between checkpoints of so many exchanges."""
    timing = plan.timing
    if number is None or number < 1:
        step = timing.lasts(timing.exchange)
        whole = max(1, round(seconds / step)) if math.isfinite(seconds) else 1
        whole_steps = f"whole number of exchange steps of {step:g} s"
        what = f"{seconds:g} s is no {whole_steps if seconds > 0.0 else 'time above 0'}"
        remedy = f"give {timing.lasts(whole * timing.exchange):.12g} s, for instance"
    elif number >= timing.exchanges:
        lasts = timing.lasts(timing.exchanges * timing.exchange)
        what = f"{seconds:g} s: there would be none, as the run lasts {lasts:g} s"
        remedy = "make it shorter"
    elif plan.longer and number % timing.output_every:
        rows = timing.lasts(timing.output_every * timing.exchange)
        what = f"{seconds:g} s would shorten adaptive exchanges, which end at rows alone"
        remedy = f"give a multiple of output_interval = {rows:g} s"
    else:
        return []
    return [Problem("checkpoint_every", what, remedy)]

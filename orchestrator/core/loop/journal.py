"""The call that a run is making, in a file that outlives the process.

A crash (SIGSEGV, ...) ends a process without a word. The loop therefore notes each call before it
makes it, in memory that is a file; the :mod:`~rockshed.core.supervisor` reads it after a crash.
"""

import json
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import check_of
from ..system.clock import to_seconds
from ..system.plan import Plan
from ..system.schedule import Action, Operation
from .tables import IntegerTable

FILE = "journal.bin"
LEGEND = "journal.json"
EXCHANGE, OPERATION = range(2)
"""Places in a journal."""
_NOTHING = -1
_BY_ITSELF = ("crashed", "ended")
"""Beginnings of what code does when nobody has asked it to end."""
_DAMAGED = (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError)
"""Errors that a journal leads to in which a crash has left nonsense."""
_IS_FILE = os.name == "posix"
"""Whether memory that is a file can be removed while it is in use."""


class Journal:
    """The journal of a run.

    Parameters
    ----------
    folder : Path or None
        In which the run writes; None where nobody would read a journal.
    plan : Plan
        Of the run.

    Attributes
    ----------
    entries : array of int64, shape (2,)
        Exchange and operation under way. An operation of -1 is none of an FMU; -2, -3, ... are
        preparations of the first, second, ... component, and behind those of all come their ends.
    """

    def __init__(self, folder: Path | None, plan: Plan) -> None:
        self._folder = folder
        self._components = list(plan.order)
        self._fmus = {name: plan.system.components[name].fmu for name in plan.order}
        self.entries: IntegerTable = np.zeros(2, np.int64)
        if folder is not None and _IS_FILE:
            self.entries = np.memmap(folder / FILE, np.int64, "w+", shape=(2,))
        self.entries[:] = _NOTHING
        self.legend([])

    def legend(self, operations: Sequence[Operation], plan: Plan | None = None) -> None:
        """Write down what the numbers of operations mean.

        Parameters
        ----------
        operations : sequence of Operation
            In the order of their numbers.
        plan : Plan, optional
            Gives times; not needed where there are no operations.
        """
        if self._folder is None:
            return
        legend = {
            "components": self._components,
            "fmus": self._fmus,
            "start": plan.timing.start if plan else 0,
            "rate": plan.timing.rate if plan else 1,
            "exchange": plan.schedule.exchange if plan else 0,
            "period": plan.schedule.period if plan else 1,
            "operations": [[o.component, int(o.action), o.begin, o.length] for o in operations],
        }
        (self._folder / LEGEND).write_text(json.dumps(legend), encoding="utf-8")

    def prepares(self, component: str) -> None:
        """Note that a component is being made or initialised."""
        self.entries[OPERATION] = _NOTHING - 1 - self._components.index(component)

    def ends(self, component: str) -> None:
        """Note that a component is being terminated and freed."""
        place = len(self._components) + self._components.index(component)
        self.entries[OPERATION] = _NOTHING - 1 - place

    def rests(self) -> None:
        """Note that no component is called."""
        self.entries[OPERATION] = _NOTHING

    def moved(self, folder: Path) -> None:
        """Note that the folder of the run has another name now."""
        if self._folder is not None:
            self._folder = folder

    def close(self) -> None:
        """Remove the files: the run has not crashed."""
        self.entries[:] = _NOTHING
        if self._folder is not None:
            for name in (FILE, LEGEND):
                (self._folder / name).unlink(missing_ok=True)


def last_entry(folder: Path, reason: str) -> str:
    """Say what a run was doing when its process ended.

    Parameters
    ----------
    folder : Path
        In which the run was writing.
    reason : str
        Name of the signal or exception that ended it, or what its code did.

    Returns
    -------
    str
        Component, time, call and reason, and what finds out why its code crashed; no component if
        the code of none was running.
    """
    how = _how(reason)
    with suppress(*_DAMAGED):  # code that crashes may have written anywhere before
        return _doing(folder, how)
    return f"the run {how}"


def _doing(folder: Path, how: str) -> str:
    entries = np.fromfile(folder / FILE, np.int64)
    legend = json.loads((folder / LEGEND).read_text(encoding="utf-8"))
    operation = int(entries[OPERATION])
    if operation == _NOTHING:
        return f"the run {how}"
    if operation > _NOTHING:
        component = legend["operations"][operation][0]
        said = _call(legend, operation, int(entries[EXCHANGE]), how)
    else:
        number = _NOTHING - 1 - operation
        component = legend["components"][number % len(legend["components"])]
        ready = number < len(legend["components"])
        when = "while it was made ready" if ready else "when it was ended, after the run"
        said = f"{component}: its code {how} {when}"
    remedy = check_of(str(legend["fmus"][component])) if how.startswith(_BY_ITSELF) else ""
    return f"{said}; {remedy}" if remedy else said


def _how(reason: str) -> str:
    if reason == "SIGKILL":
        return f"was killed ({reason})"
    return f"crashed ({reason})" if reason.startswith(("SIG", "exception")) else reason


def _call(legend: dict[str, Any], operation: int, exchange: int, how: str) -> str:
    component, action, begin, length = legend["operations"][operation]
    period = exchange // legend["period"] * legend["period"]
    ticks = {
        Action.STEP: period * legend["exchange"] + begin,
        Action.EXTRAPOLATE: period * legend["exchange"] + begin,
        Action.RECORD: (exchange + 1) * legend["exchange"],
    }.get(Action(action), exchange * legend["exchange"])
    what = {
        Action.SET: "when its inputs were set",
        Action.EXTRAPOLATE: "when its inputs were set",
        Action.STEP: f"in the step by {to_seconds(length, legend['rate']):.6g} s",
        Action.GET: "when its outputs were read",
        Action.RECORD: "when its outputs were read",
    }[Action(action)]
    at = to_seconds(legend["start"] + ticks, legend["rate"])
    return f"{component} at t = {at:.9g} s: its code {how} {what}"

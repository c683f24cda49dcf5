"""Texts that pass from component to component, and those that are recorded.

They lie on no bus: the loop calls Python for them, as it does for slaves in Python.
"""

import ctypes
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any, cast

from ..fmu.slave import ERROR, FATAL, OK, Slave, SlaveLost, SlaveWithTexts, worst
from ..system.plan import End, Plan, with_whole_arrays
from ..system.schedule import Action
from ..system.values import start_value
from .tables import IntegerTable

MOST_CHANGES = 10_000
"""Changes of a recorded text that are kept."""

TextChanges = dict[str, list[tuple[float, str]]]
"""Texts of each recorded variable with the times (s) at which they came."""


class Texts:
    """Texts of a run.

    Parameters
    ----------
    plan : Plan
        Says which are passed on and which are recorded.
    journal : array of int64
        Exchange under way first, -1 before the first one.

    Attributes
    ----------
    newest : dict of str to str
        Newest text of each output that is passed on or recorded, by ``component.port``.
    changes : TextChanges
        Of the recorded ones, from the start on; of each at most :data:`MOST_CHANGES`.
    """

    def __init__(self, plan: Plan, journal: IntegerTable) -> None:
        self._plan = plan
        self._journal = journal
        self._source = {target.name: source.name for target, source in plan.texts}
        self._targets = _variables(plan, (target for target, _ in plan.texts))
        sources = [source for _, source in plan.texts]
        self._sources = _variables(plan, [*sources, *plan.recorded_texts])
        self.newest: dict[str, str] = {}
        self.changes: TextChanges = {end.name: [] for end in plan.recorded_texts}

    def has(self, component: str, action: Action) -> bool:
        """Tell whether an action of a component moves texts."""
        moved = {Action.SET: self._targets, Action.GET: self._sources}
        return component in moved.get(action, {})

    def give(self, slave: Slave) -> int:
        """Set all connected texts of a slave to the newest ones; return the worst status."""
        status = OK
        given = {port.name: str(value) for port, value in self._plan.starts[slave.name]}
        for ends in self._targets.get(slave.name, []):
            texts = [self._text(end, given) for end in ends]
            if all(text is not None for text in texts):
                setter = cast(SlaveWithTexts, slave).set_texts
                status = worst(status, setter(ends[0].port.reference, list(map(str, texts))))
        return status

    def _text(self, end: End, given: Mapping[str, str]) -> str | None:
        """Return the text of an input; None if its source has not shown any yet."""
        if end.name in self._source:
            return self.newest.get(self._source[end.name])
        return given.get(end.port.name, str(start_value(end.port)))

    def take(self, slave: Slave) -> int:
        """Get all texts of a slave that are passed on or recorded; return the worst status."""
        status = OK
        for ends in self._sources.get(slave.name, []):
            getter = cast(SlaveWithTexts, slave).get_texts
            found, texts = getter(ends[0].port.reference, len(ends))
            status = worst(status, found)
            for end, text in zip(ends, texts):
                self._note(end.name, text)
        return status

    def _note(self, name: str, text: str) -> None:
        if self.newest.get(name) == text:
            return
        self.newest[name] = text
        changes = self.changes.get(name)
        if changes is None or len(changes) >= MOST_CHANGES:
            return
        at = self._plan.timing.seconds(int(self._journal[0]) + 1)
        if changes and changes[-1][0] == at:  # during the initialisation it has changed again
            changes.pop()
        changes.append((at, text))

    @property
    def cut(self) -> list[str]:
        """Say which texts have changed so often that not all changes are kept."""
        return [
            f"{name}: the first {MOST_CHANGES:,} changes of this text are kept"
            for name, changes in self.changes.items()
            if len(changes) >= MOST_CHANGES
        ]


def _variables(plan: Plan, ends: Iterable[End]) -> dict[str, list[list[End]]]:
    """Return variables by component, an array of FMI 3.0 with all elements."""
    found: dict[str, list[list[End]]] = {}
    whole = with_whole_arrays(plan.descriptions, ends)
    for (component, _), elements in groupby(whole, lambda end: (end.component, end.port.array)):
        found.setdefault(component, []).append(list(elements))
    return found


_MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p
)


class TextCalls:
    """C functions by which the loop moves the texts of slaves.

    Parameters
    ----------
    texts : Texts
        Of the run.
    slaves : mapping of str to Slave
        By component.
    """

    def __init__(self, texts: Texts, slaves: Mapping[str, Slave]) -> None:
        self._texts = texts
        self._slaves = slaves
        self._made: dict[tuple[str, Action], Any] = {}

    def addresses(self, component: str, action: Action) -> Sequence[int]:
        """Return the address of a function that moves the texts of an action, if there are any."""
        if not self._texts.has(component, action):
            return ()
        key = (component, action)
        if key not in self._made:
            self._made[key] = _MOVE(self._call(*key))
        return (int(ctypes.cast(self._made[key], ctypes.c_void_p).value or 0),)

    def _call(self, component: str, action: Action) -> Any:
        slave = self._slaves[component]
        move = self._texts.give if action is Action.SET else self._texts.take

        def call(*_arguments: Any) -> int:
            try:
                return move(slave)
            except SlaveLost:  # its messages say so
                return FATAL
            except Exception as error:  # none can cross the loop
                slave.messages.append((ERROR, f"{type(error).__name__}: {error}"))
                return ERROR

        return call

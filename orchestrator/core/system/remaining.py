"""A system without its faults of form, to see what else is wrong with it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError

from ..errors import InputRefused, Problem
from ..fmu.slave import Slave, Source
from .planning import problems_with
from .system import SystemSpec

_TIMES = {
    "start_time": 0.0,
    "stop_time": 1.0,
    "exchange_step": 1.0,
    "output_interval": 1.0,
    "state_interval": 1.0,
}
"""Times (s) in the place of faulty ones; then none is looked at."""
_LISTS = (("connections",), ("scenario", "set"), ("scenario", "fault"))
"""Lists whose entries the others can do without."""
_NAMED = ("shared", "bonds")
"""Tables likewise."""
_PASSES = 4
"""A fault may hide another one of the same entry."""


class NoFmu:
    """Source of a component whose FMU is not to be had, which has been told."""

    path = ""
    """As an FMU file has one: such a component may be isolated."""

    def __init__(self) -> None:
        self.origin: dict[str, str] = {}

    def model_description(self) -> bytes:
        """Refuse without a further reason.

        Raises
        ------
        InputRefused
            Always.
        """
        raise InputRefused([])

    def instantiate(self, name: str) -> Slave:
        """Refuse without a further reason.

        Raises
        ------
        InputRefused
            Always.
        """
        raise InputRefused([])


@dataclass
class Remaining:
    """The sound part of the data of a system.

    Attributes
    ----------
    data : dict
        As in a TOML file; it loses what is faulty.
    unnamed : set of str
        Components whose FMU is not named.
    timed, connected : bool
        Whether its times are those of the data, and all connections.
    """

    data: dict[str, Any]
    unnamed: set[str] = field(default_factory=set)
    timed: bool = True
    connected: bool = True
    _numbers: dict[tuple[str, ...], list[int]] = field(default_factory=dict)

    def system(self) -> SystemSpec | None:
        """Return the system of what is sound; None where too little is."""
        for _ in range(_PASSES):
            try:
                return SystemSpec.model_validate(self.data)
            except ValidationError as error:
                faults = [fault["loc"] for fault in error.errors()]
            if not all(map(self._without, faults)):
                return None
            for above in _LISTS:
                self._shorten(above, [loc[len(above)] for loc in faults if _is_in(loc, above)])
        return None

    def _without(self, loc: Sequence[Any]) -> bool:
        """Take a faulty value out; tell whether the rest can do without it."""
        head = loc[0]
        if head == "name":
            self.data["name"] = "system"
        elif head in _TIMES:
            self.data[head] = _TIMES[head]
            self.timed = False
        elif head == "components":
            return len(loc) > 1 and "[key]" not in loc and self._without_in(*loc[1:3], *loc[3:4])
        elif any(_is_in(loc, above) for above in _LISTS):
            return True  # all of a list go at once
        elif head in (*_NAMED, "scenario") and len(loc) > 1:
            self.data[head] = {k: v for k, v in self.data[head].items() if k != loc[1]}
        else:
            self.data.pop(head, None)
            self.connected = self.connected and head != "connections"
        return True

    def _without_in(self, component: str, key: str = "fmu", inner: Any = None) -> bool:
        """Take a faulty value out of a component."""
        entry = self.data["components"][component]
        entry = dict(entry) if isinstance(entry, dict) else {}
        if key == "parameters" and isinstance(entry.get(key), dict) and inner is not None:
            entry[key] = {k: v for k, v in entry[key].items() if k != inner}
        elif key == "fmu":
            entry[key] = ""
            self.unnamed.add(component)
        else:
            entry.pop(key, None)
            self.timed = self.timed and key != "step"
        self.data["components"] = {**self.data["components"], component: entry}
        return True

    def _shorten(self, above: tuple[str, ...], faulty: Sequence[Any]) -> None:
        """Take faulty entries out of a list, and keep the numbers of the others."""
        table = self.data
        for key in above[:-1]:
            table = table.get(key, {})
        listed = table.get(above[-1])
        if not faulty or not isinstance(listed, list):
            return
        numbers = self._numbers.get(above, [*range(len(listed))])
        sound = [place for place in range(len(listed)) if place not in faulty]
        table[above[-1]] = [listed[place] for place in sound]
        self._numbers[above] = [numbers[place] for place in sound]
        self.connected = self.connected and above != ("connections",)

    def numbered(self, problem: Problem) -> Problem:
        """Return a problem with the number that an entry of a list has in the whole data."""
        for above, numbers in self._numbers.items():
            before = ".".join(above) + "."
            number, dot, rest = problem.where.removeprefix(before).partition(".")
            if problem.where.startswith(before) and number.isdigit():
                where = f"{before}{numbers[int(number)]}{dot}{rest}"
                return Problem(where, problem.what, problem.remedy)
        return problem


def other_problems(
    known: Remaining,
    sources_of: Callable[[SystemSpec], Mapping[str, Source]],
    changed: Callable[[SystemSpec], SystemSpec] = lambda known: known,
) -> list[Problem]:
    """Return what is wrong with a system besides its form.

    Parameters
    ----------
    known : Remaining
        Its sound part.
    sources_of : callable
        Returns the sources of its components.
    changed : callable
        Returns a system with what is given beside the data.

    Returns
    -------
    list of Problem
        Nothing where too little is sound.
    """
    system = known.system()
    if system is None:
        return []
    sources = {**sources_of(system), **{name: NoFmu() for name in known.unnamed}}
    found = problems_with(changed(system), sources, known.timed, known.connected)
    return [known.numbered(problem) for problem in found]


def _is_in(loc: Sequence[Any], above: tuple[str, ...]) -> bool:
    """Tell whether the place of a fault is an entry of a list."""
    length = len(above)
    return tuple(loc[:length]) == above and len(loc) > length and isinstance(loc[length], int)

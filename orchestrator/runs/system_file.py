"""A system file: read with everything that is wrong with it, told by line and column."""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ..core.errors import InputRefused, Problem, in_order
from ..core.fmu.fmu_slave import FmuFile
from ..core.system.in_si import fmu_of, numbers_in
from ..core.system.names import matches, split_name
from ..core.system.parts import Connection
from ..core.system.reading import in_folder, system_in
from ..core.system.system import SystemSpec
from ..input_files.form import read_toml
from ..input_files.places import Key, Places
from .scenario import read_inputs, with_inputs_read, without_file

_BEHIND = re.compile(r"[:,] ")
"""Ends the name of what a problem is about: a component, a variable, a key, a connection."""


@dataclass(frozen=True)
class SystemFile:
    """The content of a system file, and where everything stands in it.

    Attributes
    ----------
    path : Path
        Of the file.
    content : mapping
        As it is written.
    places : Places
        Of its values.
    replaced : collection of str
        Names of values and keys that are given beside the file, and go before its own.
    """

    path: Path
    content: Mapping[str, Any]
    places: Places
    replaced: Collection[str] = ()

    @classmethod
    def read(cls, path: Path) -> "SystemFile":
        """Read a file.

        Parameters
        ----------
        path : Path
            Of the file.

        Raises
        ------
        InputRefused
            It cannot be read, or is not TOML.
        """
        return cls(path, *read_toml(path))

    def system(
        self, changed: Callable[[SystemSpec], SystemSpec] = lambda known: known
    ) -> SystemSpec:
        """Return the system of the file, its table of inputs read.

        Parameters
        ----------
        changed : callable
            Returns a system with what is given beside the file. It is called where the file is
            refused, to tell what is wrong with that too.

        Raises
        ------
        InputRefused
            Its form, its quantities or its table are wrong; with what its FMUs have against the
            rest, in the order of the file.
        """
        try:
            return with_inputs_read(system_in(self.content, self.path), self.path.parent)
        except InputRefused as refusal:
            problems = [*refusal.problems, *self._more_problems(changed)]
        raise InputRefused(self.placed(problems))

    def _more_problems(self, changed: Callable[[SystemSpec], SystemSpec]) -> list[Problem]:
        """Return what is wrong besides the form."""
        # the core's loop takes longer to import than most files to read
        from ..core.run import sources_of
        from ..core.system.remaining import Remaining, other_problems

        folder = self.path.resolve().parent
        data, _ = numbers_in(
            self.content, lambda _, entry: FmuFile(folder / fmu_of(entry), to_run=False)
        )
        more = other_problems(
            Remaining(data),
            lambda known: sources_of(in_folder(known, folder)),
            lambda known: changed(without_file(in_folder(known, folder))),
        )
        if isinstance(data.get("scenario"), dict):
            more += _table_problems(data["scenario"].get("inputs"), self.path.parent)
        return more

    # ------------------------------------------------------------------ where it stands

    def placed(self, problems: Sequence[Problem]) -> list[Problem]:
        """Return problems with line and column in the file, in its order.

        Parameters
        ----------
        problems : sequence of Problem
            With the system. The place of one of the form begins with the name of the file.
        """
        return in_order(map(self._placed, problems))

    def _placed(self, problem: Problem) -> Problem:
        where = problem.where.removeprefix(f"{self.path}: ")
        key = self._key(where)
        if key is None:
            return problem
        return Problem(f"{self.places.of(key)}: {where}", problem.what, problem.remedy)

    @cached_property
    def _not_of_file(self) -> frozenset[str]:
        """Names whose values are not those of the file, with those that share a value with one."""
        names = set(self.replaced)
        shared = self.content.get("shared")
        for key, entry in shared.items() if isinstance(shared, Mapping) else ():
            alike = {key, *_targets(entry)}
            names |= alike if alike & names else set()
        return frozenset(names)

    def _key(self, where: str) -> Key | None:
        """Return the key of what a problem is about; None where it is not in the file."""
        name = _BEHIND.split(where)[0]
        if name in self._not_of_file or name.partition(".")[0] in self._not_of_file:
            return None
        if where.startswith(("scenario.inputs ", "scenario.inputs: ")):
            return ("scenario", "inputs", where[len("scenario.inputs") :].lstrip(": "))
        ways = (self._of_connection, self._of_component, self._of_key)
        return next((key for way in ways if (key := way(name)) is not None), None)

    def _of_key(self, name: str) -> Key | None:
        """Return the key that a problem names with dots; of one that is missing, its table."""
        if name.partition(".")[0] not in (*self.content, *SystemSpec.model_fields):
            return None
        return tuple(_keys(self.content, name))

    def _of_connection(self, name: str) -> Key | None:
        listed = self.content.get("connections")
        for place, entry in enumerate(listed if isinstance(listed, list) else []):
            if name in _ends(entry)[:1]:
                return ("connections", place)
        return None

    def _of_component(self, name: str) -> Key | None:
        """Return the key of a component, of its value, or of what feeds its input."""
        components = self.content.get("components")
        if not isinstance(components, Mapping):
            return None
        owner, variable = split_name(name, components)
        if owner not in components:
            return None
        above: Key = ("components", owner)
        entry = components[owner] if isinstance(components[owner], Mapping) else {}
        if not variable:
            return (*above, "fmu")
        parameters = entry.get("parameters")
        for given in parameters if isinstance(parameters, Mapping) else ():
            if matches(given, variable):
                return (*above, "parameters", given)
        if variable in entry:
            return (*above, variable)
        return next(self._feeding(name), above)

    def _feeding(self, name: str) -> Iterator[Key]:
        """Yield the keys of what else gives a variable its value, the last connection first."""
        shared = self.content.get("shared")
        for key, entry in shared.items() if isinstance(shared, Mapping) else ():
            if any(matches(target, name) for target in _targets(entry)):
                yield ("shared", key, "value")
        listed = self.content.get("connections")
        connections = [*enumerate(listed)] if isinstance(listed, list) else []
        for place, entry in reversed(connections):
            if any(matches(end, name) for end in _ends(entry)[1:]):
                yield ("connections", place)


def _targets(entry: Any) -> list[str]:
    """Return the targets of a shared value; nothing if it has none."""
    targets = entry.get("targets") if isinstance(entry, Mapping) else None
    listed = targets if isinstance(targets, list) else []
    return [target for target in listed if isinstance(target, str)]


def _ends(entry: Any) -> list[str]:
    """Return a connection as it is told, its source and its target; nothing if it is none."""
    try:
        connection = Connection.model_validate(
            entry if isinstance(entry, str) else {k: entry[k] for k in ("source", "target")}
        )
    except (ValueError, KeyError, TypeError):
        return []
    return [str(connection), connection.source, connection.target]


def _keys(content: Any, name: str) -> Iterator[str | int]:
    """Yield the keys of a name with dots; keys may have dots themselves."""
    while name:
        here = [*content] if isinstance(content, Mapping) else []
        fitting = [key for key in here if name == key or name.startswith(f"{key}.")]
        key = max(fitting, key=len) if fitting else name.partition(".")[0]
        name = name[len(key) + 1 :]
        if isinstance(content, list) and key.isdigit():
            content = content[int(key)] if int(key) < len(content) else None
            yield int(key)
        else:
            content = content.get(key) if isinstance(content, Mapping) else None
            yield key


def _table_problems(inputs: Any, folder: Path) -> list[Problem]:
    """Return what is wrong with the file of a table of inputs."""
    if not isinstance(inputs, str):
        return []
    try:
        read_inputs(folder / inputs)
    except InputRefused as refusal:
        return refusal.problems
    return []

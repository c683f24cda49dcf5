"""Descriptions of the components of a system, and whether their FMUs can be in its processes."""

import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

from ..errors import InputRefused, Problem
from ..fmu.description import SIZE, Description
from ..fmu.fmu_slave import UnusableError, read_description
from ..fmu.slave import NUMBERS, STRING, Source
from .finding import Finder, few
from .names import nearest
from .system import ALL
from .values import value_for


@dataclass
class Describer:
    """Reads descriptions.

    Attributes
    ----------
    finder : Finder
        Takes descriptions, problems and warnings.
    sources : mapping of str to Source
        Of the components.
    """

    finder: Finder
    sources: Mapping[str, Source]

    def describe(self) -> None:
        """Read the descriptions of all components."""
        for name, source in self.sources.items():
            try:
                self.finder.descriptions[name] = self._description(name, source.model_description())
                self.finder.warnings += [
                    f"{name}: {text}" for text in self.finder.descriptions[name].warnings
                ]
                self.finder.warnings += _not_recorded(name, self.finder.descriptions[name])
            except InputRefused as refusal:
                self.finder.problems += [
                    Problem(name, f"{p.where}: {p.what}", p.remedy) for p in refusal.problems
                ]
            except UnusableError as error:
                self.finder.refuse(
                    name, f"{self.finder.system.components[name].fmu} {error}", error.remedy
                )
        self._check_instances()

    def _description(self, name: str, xml: bytes) -> Description:
        """Read the description of a component in the sizes that it is given."""
        known = read_description(xml)
        given = dict(self.finder.system.components[name].parameters)
        for shared in self.finder.system.shared.values():
            for target in shared.targets:
                component, parameter = self.finder.split(target)
                given |= {parameter: shared.value} if component == name else {}
        sizes = []
        for port in known.named(SIZE):
            with suppress(ValueError):  # it is refused with all other values
                if port.name in given:
                    sizes.append((port.name, int(value_for(port, given[port.name]))))
        return read_description(xml, tuple(sizes)) if sizes else known

    def _check_instances(self) -> None:
        """Refuse two instances of an FMU that may be in a process only once."""
        users: dict[str, list[str]] = {}
        for name, description in self.finder.descriptions.items():
            if description.once_per_process and name not in self.finder.system.isolated:
                users.setdefault(description.guid, []).append(name)
        for names in users.values():
            if len(names) > 1:
                self.finder.refuse(
                    ", ".join(names),
                    "use one FMU that can be instantiated only once in a process",
                    "isolate them, or export it under two names",
                )

    def check_isolation(self) -> None:
        """Refuse names that nothing has, and what cannot be in a process of its own."""
        for name in self.finder.system.isolate:
            if name != ALL and name not in self.finder.system.components:
                known = [*self.finder.system.components, ALL]
                self.finder.refuse(
                    "isolate", f"there is no component {name!r}", nearest(name, known)
                )
        isolated = self.finder.system.isolated
        for name in isolated:
            if not hasattr(self.sources[name], "path"):
                what = "is no FMU file, and only those run in processes of their own"
                self.finder.refuse(f"{name}: isolate", what, "leave it out, or take an FMU")
        if not isolated and self.finder.system.limits_calls:
            self.finder.warnings.append(
                "time_limit is for the calls of isolated FMUs, and none is isolated: it limits "
                "nothing; isolate some, or leave it out"
            )
        if isolated and sys.platform == "win32":
            what = "is for Linux and macOS: Windows has no such pipes"
            self.finder.refuse("isolate", what, "leave it out")


def _not_recorded(component: str, description: Description) -> list[str]:
    """Say which outputs of a component are left out of the results: neither numbers nor text."""
    kept = (*NUMBERS, STRING)
    others = [port for port in description.named("output") if port.kind not in kept]
    if not others:
        return []
    kinds = " and ".join(sorted({port.kind for port in others}))
    verb = "is" if len(others) == 1 else "are"
    return [
        f"{component}: {few(port.name for port in others)} {verb} {kinds}, which is not recorded"
    ]

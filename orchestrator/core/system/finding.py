"""Ports by the names that a system has for them; unknown ones are refused."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from ..errors import Problem
from ..fmu.description import Description
from ..fmu.slave import STRING
from .names import expand, nearest, select, split_name
from .plan import End
from .renaming import present_name, renaming_warning
from .system import SystemSpec


@dataclass
class Finder:
    """Finds ports by their names, and collects problems.

    Attributes
    ----------
    system : SystemSpec
        Has the names.
    descriptions : dict of str to Description
        Of the components whose FMUs could be read; names of others are passed over in silence.
    problems : list of Problem
        What is wrong, in the order in which it was found.
    warnings : list of str
        Sentences for the user.
    """

    system: SystemSpec
    descriptions: dict[str, Description] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def refuse(self, where: str, what: str, remedy: str = "") -> None:
        """Add a problem to those that are told when the whole system has been looked at."""
        self.problems.append(Problem(where or '""', what, remedy))  # a name of no letter

    def split(self, name: str) -> tuple[str, str]:
        """Return component and variable of a name."""
        return split_name(name, self.system.components)

    def ends(self, where: str, component: str, name: str) -> list[End]:
        """Return the ports that a name or an array shorthand stands for.

        None of them if any is unknown.
        """
        if component not in self.system.components:
            self.refuse(
                where,
                f"there is no component {component!r}",
                nearest(component, self.system.components),
            )
            return []
        if component not in self.descriptions:
            return []
        ports = self.descriptions[component].ports
        present = self._present(component, name)
        try:
            names = expand(present, ports)
            if present not in ports and (array := self.descriptions[component].arrays.get(present)):
                names = list(array.names)
        except ValueError as error:
            self.refuse(where, f"{component}.{name} {error}", "give the range that the FMU has")
            return []
        unknown = [n for n in names if n not in ports] if names else [name]
        if unknown:
            more = f" and {len(unknown) - 1} more" if len(unknown) > 1 else ""
            self.refuse(
                where,
                f"{component} has no variable {unknown[0]!r}{more}",
                nearest(unknown[0], ports),
            )
            return []
        return [End(component, ports[n]) for n in names]

    def shape_of(self, component: str, name: str) -> tuple[int, ...]:
        """Return the shape of the array that a name stands for; empty for anything else."""
        known = self.descriptions[component]
        present = self._present(component, name)
        is_array = present not in known.ports and present in known.arrays
        return known.arrays[present].shape if is_array else ()

    def of_causality(self, where: str, ends: list[End], causality: str) -> list[End]:
        """Return the ports if all are of one causality; else none of them."""
        wrong = [end for end in ends if end.port.causality != causality]
        if not wrong:
            return ends
        name, port = wrong[0]
        known = self.descriptions[name].named(causality)
        remedy = f"{causality}s are: {few(port.name for port in known)}"
        if port.causality == "parameter":
            remedy = (
                f"a parameter is fixed before the run: set it under components.{name}.parameters"
            )
        what = f"is of the causality {port.causality}, and an {causality} is needed"
        self.refuse(where, f"{wrong[0].name} {what}", remedy)
        return []

    def selected(self, key: str, patterns: Iterable[str]) -> list[End]:
        """Return the ports that patterns select.

        Outputs where a pattern leaves something open, else any variable.
        """
        every = (
            End(name, port)
            for name, known in self.descriptions.items()
            for port in known.ports.values()
        )
        ends = {end.name: end for end in every if end.port.is_number}
        outputs = [
            name
            for name, end in ends.items()
            if end.port.causality == "output" and not end.port.is_alias
        ]
        chosen: dict[str, End] = {}
        for given in patterns:
            pattern = self._present_pattern(given)
            names = [pattern] if pattern in ends and key == "record" else select(pattern, outputs)
            names = names or [name for name in self._elements(pattern) if name in outputs]
            if key == "watch" and self.texts_selected([given]):
                what = f"{pattern!r} is text, which has no extremes"
                self.refuse(key, what, "leave it out")
            elif (
                not names
                and not self.texts_selected([given])
                and self._is_readable(pattern)
                and pattern != "*"
            ):
                self.refuse(key, f"{pattern!r} selects no output", nearest(pattern, outputs))
            chosen |= {name: ends[name] for name in names}
        return list(chosen.values())

    def texts_selected(self, patterns: Iterable[str]) -> list[End]:
        """Return the texts that patterns select, as they select numbers."""
        texts = {
            f"{name}.{port.name}": End(name, port)
            for name, known in self.descriptions.items()
            for port in known.ports.values()
            if port.kind == STRING and not port.is_alias
        }
        outputs = [name for name, end in texts.items() if end.port.causality == "output"]
        chosen: dict[str, End] = {}
        for pattern in map(self._present_pattern, patterns):
            names = [pattern] if pattern in texts else select(pattern, outputs)
            chosen |= {name: texts[name] for name in names}
        return list(chosen.values())

    def _is_readable(self, pattern: str) -> bool:
        """Tell whether all descriptions are known that a pattern may select from."""
        is_whole = len(self.descriptions) == len(self.system.components)
        return is_whole or self.split(pattern)[0] in self.descriptions

    def _elements(self, name: str) -> list[str]:
        """Return the names of the elements of an array; nothing if it is none."""
        component, variable = self.split(name)
        known = self.descriptions.get(component)
        array = known.arrays.get(variable) if known else None
        return [f"{component}.{element}" for element in array.names] if array else []

    def _present(self, component: str, name: str) -> str:
        """Return the present name of a variable, and warn once of an older one."""
        present = present_name(self.descriptions[component], name)
        if present != name:
            text = renaming_warning(component, name, present)
            self.warnings += [] if text in self.warnings else [text]
        return present

    def _present_pattern(self, pattern: str) -> str:
        component, name = self.split(pattern)
        if component not in self.descriptions:
            return pattern
        return f"{component}.{self._present(component, name)}"


def few(names: Iterable[str]) -> str:
    """List some names, and say that there are more."""
    listed = list(names)
    if len(listed) > 8:
        listed[8:] = ["..."]
    return ", ".join(listed) or "none"

"""Values that components are given before the initialisation."""

from collections.abc import Mapping
from dataclasses import dataclass

from .fields import Value
from .finding import Finder, few
from .linking import Links
from .parts import ComponentSpec
from .plan import End, Starts, with_whole_arrays
from .renaming import present_name
from .values import start_value, value_for


@dataclass
class Starter:
    """Collects start values.

    Attributes
    ----------
    finder : Finder
        Finds their ports, and takes problems.
    """

    finder: Finder

    def starts(self, connected: set[str]) -> dict[str, Starts]:
        """Collect the values of each component, shared ones included."""
        given: dict[str, tuple[End, str, Value]] = {}
        for name, spec in self.finder.system.components.items():
            for key, value in self._parameters(name, spec).items():
                self._give(
                    given, f"{name}.{key}", f"components.{name}.parameters", value, connected
                )
        for key, shared in self.finder.system.shared.items():
            for target in shared.targets:
                self._give(given, target, f"shared.{key}", shared.value, connected)
        starts: dict[str, Starts] = {name: [] for name in self.finder.system.components}
        for end, _, value in given.values():
            try:
                starts[end.component].append((end.port, value_for(end.port, value)))
            except ValueError as error:
                self.finder.refuse(
                    end.name,
                    f"{value!r}: {error}",
                    f"set {_described(end)} to another value",
                )
        return starts

    def check_arrays(self, links: Links, starts: Mapping[str, Starts]) -> None:
        """Refuse arrays of FMI 3.0, which are set as a whole, if an element has no value."""
        given = [End(name, port) for name, listed in starts.items() for port, _ in listed]
        ends = [*given, *(target for _, target in links)]
        known = {end.name for end in ends}
        missing: dict[tuple[str, str], list[str]] = {}
        for end in with_whole_arrays(self.finder.descriptions, ends):
            if end.port.shape and end.name not in known and start_value(end.port) is None:
                array = (end.component, end.port.array)
                missing.setdefault(array, []).append(end.port.name)
        for array, names in missing.items():
            what = f"is set as a whole, and there are no values of {few(names)}"
            self.finder.refuse(".".join(array), what, "give all its elements, or none")

    def _parameters(self, name: str, spec: ComponentSpec) -> dict[str, Value]:
        """Return the values of a component.

        One under an older name takes the place of that under the present one.
        """
        if name not in self.finder.descriptions:
            return spec.parameters
        present = {
            key: present_name(self.finder.descriptions[name], key) for key in spec.parameters
        }
        replaced = {new for old, new in present.items() if new != old}
        return {
            key: value
            for key, value in spec.parameters.items()
            if key not in replaced or present[key] != key
        }

    def _give(
        self,
        given: dict[str, tuple[End, str, Value]],
        target: str,
        giver: str,
        value: Value,
        connected: set[str],
    ) -> None:
        for end in self.finder.ends(target, *self.finder.split(target)):
            if end.port.is_constant:
                what = "is a constant, fixed when the FMU was built, and cannot be set"
                remedy = "build the FMU anew with another one (`rockshed build`, sizes=...)"
                self.finder.refuse(end.name, what, remedy)
            elif not end.port.can_be_set:
                self.finder.refuse(
                    end.name,
                    f"is of the causality {end.port.causality} and cannot be set",
                    "set parameters, unconnected inputs and variables with a start value only",
                )
            elif end.name in connected:
                self.finder.refuse(
                    end.name, f"is set in {giver} and is connected", "remove one of both"
                )
            elif end.name in given:
                other = given[end.name][1]
                twice = f"twice in {giver}" if other == giver else f"in {other} and in {giver}"
                self.finder.refuse(end.name, f"is set {twice}", "remove one of both")
            else:
                given[end.name] = (end, giver, value)


def _described(end: End) -> str:
    """Return the name of a port with its description, where it has one."""
    return f"{end.name} ({end.port.description})" if end.port.description else end.name

"""From a system to its plan: everything checked against the FMUs, names replaced by places.

Nothing runs here. All problems of a system are found at once.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.roles import Role

from ..errors import InputRefused, Problem, counted
from ..fmu.description import SIZE, Description, Port, UnitDefinition
from ..fmu.fmu_slave import UnusableError, read_description
from ..fmu.slave import NUMBERS, REAL, STRING, Source
from .adaptive import adaptive_problems, make_schedules
from .extrapolation import Extrapolating, extrapolation_problems
from .iterated import iteration_problems, plan_iteration
from .joining import Joiner
from .limits import amount_problems, internal_step_problems
from .loops import algebraic_loops, told
from .names import expand, nearest, select, split_name
from .plan import BondPlaces, End, Plan, PlannedScenario, Starts, with_whole_arrays
from .renaming import present_name, renaming_warning
from .rollback import rollback_problems
from .scenario import ScenarioReader
from .system import ALL, ComponentSpec, Connection, PowerBond, SystemSpec, Value
from .timing import Timing, make_timing
from .units import is_force, is_joule, unit_text, units_agree
from .values import start_value, value_for


def make_plan(system: SystemSpec, sources: Mapping[str, Source]) -> Plan:
    """Check the whole system and resolve every name.

    Parameters
    ----------
    system : SystemSpec
        Checked in its form already.
    sources : mapping of str to Source
        Give the model descriptions of the components.

    Returns
    -------
    Plan

    Raises
    ------
    InputRefused
        Everything that is wrong with the system.
    """
    return _Planner(system, sources).plan()


_Links = list[tuple[End, End]]
"""Source and target of every single connection."""


class _Bond(NamedTuple):
    """A power bond by ports."""

    name: str
    force: list[End]
    position: list[End]
    given: list[End]
    seen: list[End]
    work: End | None
    sign: float


class _Parts(NamedTuple):
    """The parts of a system by ports; texts apart from numbers."""

    links: _Links
    texts: _Links
    starts: dict[str, Starts]
    bonds: list[_Bond]
    watched: list[End]
    recorded: list[End]
    recorded_texts: list[End]
    reference: float | End | None
    scenario: PlannedScenario


@dataclass
class _Planner:
    """Works through a system and collects problems.

    A part that depends on something missing is passed over in silence.
    """

    system: SystemSpec
    sources: Mapping[str, Source]
    problems: list[Problem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    descriptions: dict[str, Description] = field(default_factory=dict)
    linear: dict[str, tuple[float, float]] = field(default_factory=dict)

    def plan(self) -> Plan:
        """Go through the system part by part, then refuse it or return the plan."""
        self._describe()
        order = self._order()
        timing = make_timing(self.system, self.problems)
        parts = self._parts(timing)
        self._check_states()
        self._check_iteration(parts, timing)
        self._check_isolation()
        if timing is not None and min(timing.output_every, timing.state_every) > 0:
            columns = 1 + len(parts.recorded) + 3 * len(parts.bonds)
            self.problems += amount_problems(self.system, timing, columns)
        self.problems += internal_step_problems(self.system, parts.starts)
        self.problems += adaptive_problems(self.system, self.descriptions, parts.scenario)
        if self.problems or timing is None:
            raise InputRefused(self.problems)
        return self._with_loops(self._resolved(order, timing, parts), parts.links)

    def _with_loops(self, plan: Plan, links: _Links) -> Plan:
        """Return the plan with the algebraic loops, and a warning where they get a delay."""
        loops = algebraic_loops(self.descriptions, links, at_start=False)
        at_start = algebraic_loops(self.descriptions, links, at_start=True)
        warnings = list(plan.warnings)
        if loops and plan.iteration is None:
            warnings.append(
                f"algebraic loop: {told(loops)}: with the {self.system.master} master values go "
                'round with a delay of an exchange; master = "implicit" finds those that fit'
            )
        return replace(
            plan, warnings=tuple(warnings), loops=tuple(loops), loops_at_start=tuple(at_start)
        )

    def _parts(self, timing: Timing | None) -> _Parts:
        links = self._links()
        starts = self._starts({target.name for _, target in links})
        self._check_arrays(links, starts)
        bonds = [self._bond(name, bond, links) for name, bond in self.system.bonds.items()]
        self.problems += extrapolation_problems(
            self.system, self.descriptions, (target for _, target in links)
        )
        return _Parts(
            [link for link in links if link[0].port.is_number],
            [link for link in links if not link[0].port.is_number],
            starts,
            [bond for bond in bonds if bond],
            self._selected("watch", self.system.watch),
            self._selected("record", self.system.record),
            self._texts_selected(self.system.record),
            self._reference(),
            self._scenario(links, starts, timing),
        )

    def _scenario(
        self, links: _Links, starts: Mapping[str, Starts], timing: Timing | None
    ) -> PlannedScenario:
        def find(where: str, name: str) -> list[End]:
            return self._ends(where, *self._split(name))

        fed = {target.name: target for _, target in links}
        given = {f"{name}.{port.name}" for name, listed in starts.items() for port, _ in listed}
        reader = ScenarioReader(find, fed, given, timing, self.problems)
        return reader.read(self.system.scenario)

    def _resolved(self, order: tuple[str, ...], timing: Timing, parts: _Parts) -> Plan:
        """Replace ports by places on the buses."""
        at_bonds = [end for bond in parts.bonds for end in bond.force + bond.position]
        targets = [*(target for _, target in parts.links), *parts.scenario.inputs.values()]
        inputs = _sorted(order, with_whole_arrays(self.descriptions, targets))
        exchanged = [*(s for s, _ in parts.links), *parts.watched, *at_bonds, *parts.scenario.asked]
        outputs = _sorted(order, with_whole_arrays(self.descriptions, exchanged))
        place = {end.name: i for i, end in enumerate(outputs)}
        place_of_input = {end.name: i for i, end in enumerate(inputs)}
        feeds = {target.name: place[source.name] for source, target in parts.links}
        unfed = [end for end in inputs if end.name not in feeds]
        feeds |= {end.name: len(outputs) + i for i, end in enumerate(unfed)}
        source = [feeds[end.name] for end in inputs]
        extrapolating = Extrapolating(self.system, order, timing)
        schedules = make_schedules(self.system, order, timing, extrapolating.components)
        return Plan(
            system=self.system,
            order=order,
            descriptions=self.descriptions,
            timing=timing,
            schedule=schedules[0],
            iteration=plan_iteration(self.system, inputs, outputs, source),
            starts=parts.starts,
            inputs=inputs,
            outputs=outputs,
            source=np.array(source, np.int64),
            held=np.array([_held(end, parts.starts) for end in unfed], np.float64),
            linear=_at_places({**parts.scenario.ways, **self.linear}, place_of_input),
            bonds=tuple(_bond_places(bond, place, place_of_input) for bond in parts.bonds),
            recorded=tuple(parts.recorded),
            watched=np.array([place[end.name] for end in parts.watched], np.int64),
            reference=parts.reference,
            balances=tuple(self._of_role(order, Role.RESIDUAL)),
            kinetic=tuple(self._of_role(order, Role.KINETIC)),
            warnings=tuple(self.warnings),
            texts=tuple((target, source) for source, target in parts.texts),
            recorded_texts=tuple(parts.recorded_texts),
            scenario=parts.scenario,
            extrapolated=extrapolating.inputs(inputs, outputs, source),
            longer=schedules[1:],
        )

    def _split(self, name: str) -> tuple[str, str]:
        return split_name(name, self.system.components)

    def _refuse(self, where: str, what: str, remedy: str = "") -> None:
        self.problems.append(Problem(where, what, remedy))

    # ------------------------------------------------------------------ components

    def _describe(self) -> None:
        for name, source in self.sources.items():
            try:
                self.descriptions[name] = self._description(name, source.model_description())
                self.warnings += [f"{name}: {text}" for text in self.descriptions[name].warnings]
                self.warnings += _not_recorded(name, self.descriptions[name])
            except InputRefused as refusal:
                self.problems += [
                    Problem(name, f"{p.where}: {p.what}", p.remedy) for p in refusal.problems
                ]
            except UnusableError as error:
                self._refuse(name, f"{self.system.components[name].fmu} {error}", error.remedy)
        self._check_instances()

    def _description(self, name: str, xml: bytes) -> Description:
        """Read the description of a component in the sizes that it is given."""
        known = read_description(xml)
        given = dict(self.system.components[name].parameters)
        for shared in self.system.shared.values():
            for target in shared.targets:
                component, parameter = self._split(target)
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
        for name, description in self.descriptions.items():
            if description.once_per_process and name not in self.system.isolated:
                users.setdefault(description.guid, []).append(name)
        for names in users.values():
            if len(names) > 1:
                self._refuse(
                    ", ".join(names),
                    "use one FMU that can be instantiated only once in a process",
                    "isolate them, or export it under two names",
                )

    def _check_isolation(self) -> None:
        """Refuse names that nothing has, and what cannot be in a process of its own."""
        for name in self.system.isolate:
            if name != ALL and name not in self.system.components:
                known = [*self.system.components, ALL]
                self._refuse("isolate", f"there is no component {name!r}", nearest(name, known))
        isolated = self.system.isolated
        for name in isolated:
            if not hasattr(self.sources[name], "path"):
                what = "is no FMU file, and only those run in processes of their own"
                self._refuse(f"{name}: isolate", what, "leave it out, or take an FMU")
        if isolated and sys.platform == "win32":
            what = "is for Linux and macOS: Windows has no such pipes"
            self._refuse("isolate", what, "leave it out")

    def _order(self) -> tuple[str, ...]:
        known = self.system.components
        order = self.system.order or list(known)
        for name in dict.fromkeys(order):
            if name not in known:
                self._refuse("order", f"there is no component {name!r}", nearest(name, known))
            elif order.count(name) > 1:
                self._refuse(
                    "order", f"names {name} {order.count(name)} times", "name each component once"
                )
        if missing := [name for name in known if name not in order]:
            self._refuse("order", f"does not name {', '.join(missing)}", "name each component once")
        return tuple(order)

    def _check_states(self) -> None:
        wanted = [name for name, spec in self.system.components.items() if spec.record_states]
        if wanted and self.system.state_interval is None:
            self._refuse(
                "state_interval",
                f"is missing, and states of {', '.join(wanted)} are to be recorded",
                "give it, in s",
            )
        for name in wanted:
            if name in self.descriptions and not self.descriptions[name].serializes_state:
                self._refuse(
                    f"{name}.record_states", "the FMU cannot serialize its state", "leave it out"
                )

    def _check_iteration(self, parts: _Parts, timing: Timing | None) -> None:
        """Refuse what the implicit master cannot do, or what only it would understand."""
        self.problems += iteration_problems(self.system.iteration, parts.links)
        if self.system.master != "implicit":
            return
        self.problems += rollback_problems(self.descriptions, "the implicit master")
        if parts.texts or parts.recorded_texts:
            end = parts.texts[0][0] if parts.texts else parts.recorded_texts[0]
            what = "is text, which the implicit master cannot take back"
            self._refuse(end.name, what, "leave it out, or choose another master")
        specs = self.system.components.values()
        if self.system.extrapolation or any(spec.extrapolation for spec in specs):
            what = "is for the other masters: the implicit one has the values of the end"
            self._refuse("extrapolation", what, "leave it out, and choose iteration.input")
        if self.system.adaptive is not None:
            self._refuse("adaptive", "is for the other masters", "leave it out")
        slow = [n for n in timing.steps if timing.steps[n] > timing.exchange] if timing else []
        if slow and self.system.scenario:
            what = f"with the implicit master, while {', '.join(slow)} steps over several exchanges"
            self._refuse(
                "scenario", what, "choose another master, or no step beyond the exchange's"
            )

    # ------------------------------------------------------------------ names

    def _ends(self, where: str, component: str, name: str) -> list[End]:
        """Return the ports that a name or an array shorthand stands for.

        None of them if any is unknown.
        """
        if component not in self.system.components:
            self._refuse(
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
            self._refuse(where, f"{component}.{name} {error}", "give the range that the FMU has")
            return []
        unknown = [n for n in names if n not in ports] if names else [name]
        if unknown:
            more = f" and {len(unknown) - 1} more" if len(unknown) > 1 else ""
            self._refuse(
                where,
                f"{component} has no variable {unknown[0]!r}{more}",
                nearest(unknown[0], ports),
            )
            return []
        return [End(component, ports[n]) for n in names]

    def _array(self, component: str, name: str) -> tuple[int, ...]:
        """Return the shape of the array that a name stands for; empty for anything else."""
        known = self.descriptions[component]
        present = self._present(component, name)
        is_array = present not in known.ports and present in known.arrays
        return known.arrays[present].shape if is_array else ()

    def _present(self, component: str, name: str) -> str:
        """Return the present name of a variable, and warn once of an older one."""
        present = present_name(self.descriptions[component], name)
        if present != name:
            text = renaming_warning(component, name, present)
            self.warnings += [] if text in self.warnings else [text]
        return present

    def _of_causality(self, where: str, ends: list[End], causality: str) -> list[End]:
        wrong = [end for end in ends if end.port.causality != causality]
        if not wrong:
            return ends
        name, port = wrong[0]
        known = self.descriptions[name].named(causality)
        remedy = f"{causality}s are: {_few(port.name for port in known)}"
        if port.causality == "parameter":
            remedy = (
                f"a parameter is fixed before the run: set it under components.{name}.parameters"
            )
        what = f"is of the causality {port.causality}, and an {causality} is needed"
        self._refuse(where, f"{wrong[0].name} {what}", remedy)
        return []

    def _selected(self, key: str, patterns: Iterable[str]) -> list[End]:
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
            if key == "watch" and self._texts_selected([given]):
                what = f"{pattern!r} is text, which has no extremes"
                self._refuse(key, what, "leave it out")
            elif (
                not names
                and not self._texts_selected([given])
                and len(self.descriptions) == len(self.system.components)
                and pattern != "*"
            ):
                self._refuse(key, f"{pattern!r} selects no output", nearest(pattern, outputs))
            chosen |= {name: ends[name] for name in names}
        return list(chosen.values())

    def _elements(self, name: str) -> list[str]:
        """Return the names of the elements of an array; nothing if it is none."""
        component, variable = self._split(name)
        known = self.descriptions.get(component)
        array = known.arrays.get(variable) if known else None
        return [f"{component}.{element}" for element in array.names] if array else []

    def _texts_selected(self, patterns: Iterable[str]) -> list[End]:
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

    def _present_pattern(self, pattern: str) -> str:
        component, name = self._split(pattern)
        if component not in self.descriptions:
            return pattern
        return f"{component}.{self._present(component, name)}"

    # ------------------------------------------------------------------ connections

    def _links(self) -> _Links:
        links: _Links = []
        for connection in self.system.connections:
            parts = self._of_terminals(connection) if connection.terminals else [connection]
            for part in parts:
                links += self._expanded(part)
        drivers: dict[str, list[str]] = {}
        for source, target in links:
            drivers.setdefault(target.name, []).append(source.name)
        for name, sources in drivers.items():
            if len(sources) > 1:
                self._refuse(
                    name,
                    f"is driven {len(sources)} times: by {' and by '.join(sources)}",
                    "keep one of the connections",
                )
        return links

    def _of_terminals(self, connection: Connection) -> list[Connection]:
        """Return the connections that a connection of two terminals stands for."""
        ends = (self._split(connection.source), self._split(connection.target))
        try:
            return Joiner(self.descriptions, self.sources).connections(str(connection), *ends)
        except InputRefused as refusal:
            self.problems += refusal.problems
            return []

    def _expanded(self, connection: Connection) -> _Links:
        where = str(connection)
        sources = self._of_causality(
            where, self._ends(where, *self._split(connection.source)), "output"
        )
        targets = self._of_causality(
            where, self._ends(where, *self._split(connection.target)), "input"
        )
        if not sources or not targets:
            return []
        shapes = [
            self._array(*self._split(name)) for name in (connection.source, connection.target)
        ]
        if all(shapes) and shapes[0] != shapes[1]:
            texts = " with one of ".join(" x ".join(map(str, shape)) for shape in shapes)
            remedy = "connect arrays of one shape, or elements: x[1], x[2..4]"
            self._refuse(where, f"connects an array of {texts} elements", remedy)
            return []
        if len(sources) != len(targets):
            self._refuse(
                where,
                f"connects {counted(len(sources), 'output')} with {counted(len(targets), 'input')}",
                "give ranges of one length, [1..24], or build the FMUs with sizes that fit",
            )
            return []
        pairs = list(zip(sources, targets, strict=True))
        self._check_pairs(where, pairs, connection.is_linear)
        if connection.way != (1.0, 0.0):
            self.linear |= {target.name: connection.way for target in targets}
        return pairs

    def _check_pairs(self, where: str, pairs: _Links, is_linear: bool) -> None:
        """Refuse the first pair whose kinds or units do not fit.

        The elements of an array have them in common. Of a linear connection, units are not looked
        at.
        """
        for source, target in pairs:
            kind = source.port.kind
            if kind != target.port.kind or kind not in (*NUMBERS, STRING):
                self._refuse(
                    where,
                    f"{source.name} is {source.port.type} and {target.name} is {target.port.type}",
                    "connect ports of one type, Real, Integer, Boolean or String",
                )
                return
            if source.port.items and target.port.items not in ({}, source.port.items):
                names = [f"{end.name} is one of {_few(end.port.items)}" for end in (source, target)]
                self._refuse(where, " and ".join(names), "connect enumerations of the same items")
                return
            if is_linear and source.port.kind != REAL:
                what = f"has a factor or an offset, and {source.name} is {source.port.kind}"
                self._refuse(where, what, "leave them out: they are for Real")
                return
            if is_linear:
                continue
            agree = units_agree(source.port.unit, target.port.unit)
            if agree is False:
                self._refuse(
                    where,
                    f"{source.name} is in {unit_text(source.port.unit)}, {target.name} in "
                    f"{unit_text(target.port.unit)}",
                    "connect ports of one unit",
                )
                return
            if agree is None:
                ports = (source, target)
                unknown = next(e for e in ports if e.port.unit and e.port.unit.base is None)
                other = target if unknown is source else source
                self._refuse(
                    where,
                    f"the unit {unknown.port.unit_name} of {unknown.name} is not defined in its "
                    f"model description, and {other.name} is in {unit_text(other.port.unit)}",
                    "give the connection a factor, 1 if they are the same",
                )
                return

    # ------------------------------------------------------------------ values

    def _starts(self, connected: set[str]) -> dict[str, list[tuple[Port, float | str]]]:
        """Collect the values of each component, shared ones included."""
        given: dict[str, tuple[End, str, Value]] = {}
        for name, spec in self.system.components.items():
            for key, value in self._parameters(name, spec).items():
                self._give(
                    given, f"{name}.{key}", f"components.{name}.parameters", value, connected
                )
        for key, shared in self.system.shared.items():
            for target in shared.targets:
                self._give(given, target, f"shared.{key}", shared.value, connected)
        starts: dict[str, Starts] = {name: [] for name in self.system.components}
        for end, _, value in given.values():
            try:
                starts[end.component].append((end.port, value_for(end.port, value)))
            except ValueError as error:
                self._refuse(
                    end.name,
                    f"{value!r}: {error}",
                    f"set {_described(end)} to another value",
                )
        return starts

    def _check_arrays(self, links: _Links, starts: Mapping[str, Starts]) -> None:
        """Refuse arrays of FMI 3.0, which are set as a whole, if an element has no value."""
        given = [End(name, port) for name, listed in starts.items() for port, _ in listed]
        ends = [*given, *(target for _, target in links)]
        known = {end.name for end in ends}
        missing: dict[tuple[str, str], list[str]] = {}
        for end in with_whole_arrays(self.descriptions, ends):
            if end.port.shape and end.name not in known and start_value(end.port) is None:
                array = (end.component, end.port.array)
                missing.setdefault(array, []).append(end.port.name)
        for array, names in missing.items():
            what = f"is set as a whole, and there are no values of {_few(names)}"
            self._refuse(".".join(array), what, "give all its elements, or none")

    def _parameters(self, name: str, spec: ComponentSpec) -> dict[str, Value]:
        """Return the values of a component.

        One under an older name takes the place of that under the present one.
        """
        if name not in self.descriptions:
            return spec.parameters
        present = {key: present_name(self.descriptions[name], key) for key in spec.parameters}
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
        for end in self._ends(target, *self._split(target)):
            if end.port.is_constant:
                what = "is a constant, fixed when the FMU was built, and cannot be set"
                remedy = "build the FMU anew with another one (`rockshed build`, sizes=...)"
                self._refuse(end.name, what, remedy)
            elif not end.port.can_be_set:
                self._refuse(
                    end.name,
                    f"is of the causality {end.port.causality} and cannot be set",
                    "set parameters, unconnected inputs and variables with a start value only",
                )
            elif end.name in connected:
                self._refuse(end.name, f"is set in {giver} and is connected", "remove one of both")
            elif end.name in given:
                other = given[end.name][1]
                twice = f"twice in {giver}" if other == giver else f"in {other} and in {giver}"
                self._refuse(end.name, f"is set {twice}", "remove one of both")
            else:
                given[end.name] = (end, giver, value)

    # ------------------------------------------------------------------ energy

    def _bond(self, name: str, bond: PowerBond, links: _Links) -> _Bond | None:
        where = f"bonds.{name}"
        force = self._outputs(where, bond.giver, bond.force)
        position = self._outputs(where, bond.taker, bond.position)
        work = self._outputs(where, bond.giver, [bond.work] if bond.work else [])
        if not force or not position or (bond.work and not work):
            return None
        if len(force) != len(position):
            what = f"has {counted(len(force), 'force')} and {counted(len(position), 'position')}"
            self._refuse(where, what, "name one position for each force")
            return None
        fed = _fed_by(links, bond.taker)
        why = "the ledger takes the force that the taker was given"
        given = self._connected(where, force, fed, bond.taker, why)
        seen: list[End] = []
        if not work:
            why = (
                "the ledger takes the displacement that the giver was shown; or name the giver's "
                "work output"
            )
            fed = _fed_by(links, bond.giver)
            seen = self._connected(where, position, fed, bond.giver, why)
        self._check_energy_units(where, force, position, work)
        sign = -1.0 if bond.opposed else 1.0
        return _Bond(name, force, position, given, seen, work[0] if work else None, sign)

    def _outputs(self, where: str, component: str, names: Iterable[str]) -> list[End]:
        ends = [end for name in names for end in self._ends(where, component, name)]
        return self._of_causality(where, ends, "output")

    def _connected(
        self, where: str, sources: list[End], fed: Mapping[str, End], component: str, why: str
    ) -> list[End]:
        """Return the inputs of a component that the sources feed."""
        missing = [source.name for source in sources if source.name not in fed]
        if missing:
            self._refuse(where, f"{missing[0]} is connected to no input of {component}", why)
            return []
        return [fed[source.name] for source in sources]

    def _check_energy_units(
        self, where: str, force: list[End], position: list[End], work: list[End]
    ) -> None:
        for f, p in zip(force, position, strict=True):
            if is_force(f.port.unit) is False:
                self._refuse(
                    where,
                    f"{f.name} is in {f.port.unit_name}, and no force or torque",
                    "name the forces first, then the positions",
                )
                return
            if is_joule(f.port.unit, p.port.unit) is False:
                self._refuse(
                    where,
                    f"{f.name} in {f.port.unit_name} times {p.name} in {p.port.unit_name} is no "
                    "energy in J",
                    "name forces with positions and torques with angles, in SI units",
                )
                return
        if work and is_joule(work[0].port.unit, UnitDefinition("1", {})) is False:
            self._refuse(
                where, f"{work[0].name} is in {work[0].port.unit_name}", "name an output in J"
            )

    def _reference(self) -> float | End | None:
        alarm = self.system.energy_alarm
        if alarm.reference is None or isinstance(alarm.reference, float):
            return alarm.reference
        where = "energy_alarm.reference"
        ends = self._of_causality(where, self._ends(where, *self._split(alarm.reference)), "output")
        return ends[0] if ends else None

    def _of_role(self, order: Iterable[str], role: Role) -> Iterator[End]:
        """Yield the outputs that are declared with a role, or a kind of it."""
        for component in order:
            for port in self.descriptions[component].named("output"):
                if port.kind == REAL and role.includes(port.annotation.role):
                    yield End(component, port)


def _not_recorded(component: str, description: Description) -> list[str]:
    """Say which outputs of a component are left out of the results: neither numbers nor text."""
    kept = (*NUMBERS, STRING)
    others = [port for port in description.named("output") if port.kind not in kept]
    if not others:
        return []
    kinds = " and ".join(sorted({port.kind for port in others}))
    verb = "is" if len(others) == 1 else "are"
    return [
        f"{component}: {_few(port.name for port in others)} {verb} {kinds}, which is not recorded"
    ]


def _described(end: End) -> str:
    """Return the name of a port with its description, where it has one."""
    return f"{end.name} ({end.port.description})" if end.port.description else end.name


def _fed_by(links: _Links, component: str) -> dict[str, End]:
    """Return the inputs of a component by the outputs that feed them."""
    return {source.name: target for source, target in links if target.component == component}


def _sorted(order: tuple[str, ...], ends: Iterable[End]) -> tuple[End, ...]:
    """Return every port once, in the order of the buses."""
    unique = {end.name: end for end in ends}
    turns = {name: turn for turn, name in enumerate(order)}
    return tuple(
        sorted(
            unique.values(),
            key=lambda end: (
                turns[end.component],
                end.port.kind != REAL,
                end.port.kind,
                end.port.type,
                end.port.reference,
                end.port.array,
                end.port.element,
            ),
        )
    )


def _held(end: End, starts: Mapping[str, Starts]) -> float:
    """Return the value of an element of an input that nothing feeds: given, or its start value."""
    given = {port.name: value for port, value in starts[end.component]}
    return float(given.get(end.port.name, start_value(end.port) or 0.0))


def _at_places(
    ways: Mapping[str, tuple[float, float]], place: Mapping[str, int]
) -> dict[int, tuple[float, float]]:
    """Return factors and offsets of inputs by their places."""
    return {place[name]: way for name, way in ways.items() if name in place}


def _bond_places(
    bond: _Bond, place: Mapping[str, int], place_of_input: Mapping[str, int]
) -> BondPlaces:
    def places(table: Mapping[str, int], ends: list[End]) -> NDArray[np.int64]:
        return np.array([table[end.name] for end in ends], np.int64)

    seen = np.full(len(bond.force), -1, np.int64)
    if bond.seen:
        seen = places(place_of_input, bond.seen)
    return BondPlaces(
        name=bond.name,
        given=places(place_of_input, bond.given),
        seen=seen,
        force=places(place, bond.force),
        position=places(place, bond.position),
        work=bond.work,
        sign=bond.sign,
    )


def _few(names: Iterable[str]) -> str:
    """List some names, and say that there are more."""
    listed = list(names)
    if len(listed) > 8:
        listed[8:] = ["..."]
    return ", ".join(listed) or "none"

"""From a system to what the master carries out: everything checked against the FMUs, names replaced by places.

Nothing runs here. All problems of a system are found at once.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputRefused, Problem
from ..fmu.description import Description, Port, Unit
from ..fmu.fmu_slave import read_description
from ..fmu.slave import REAL, Source
from . import schedule
from .clock import to_seconds
from .names import expand, nearest, select
from .renaming import present_name, renaming_warning
from .schedule import Schedule
from .system import ComponentSpec, Connection, PowerBond, System, Value
from .timing import Timing, make_timing
from .values import value_for

_JOULE = {"kg": 1, "m": 2, "s": -2}

MOST_VALUES = 100_000_000
"""Values that the time series of a run may have: at its end they are in memory at once (0.8 GB), and about 2 GB as text."""
MOST_STATES = 20_000
"""Serialized states that a run may record."""
MOST_INTERNAL_STEPS = 100_000
"""Internal steps that a component may make in one communication step: it cannot be interrupted there, nor tell how far it is."""


class End(NamedTuple):
    """A port of a component."""

    component: str
    port: Port

    @property
    def name(self) -> str:
        """``component.port``, the name in the results."""
        return f"{self.component}.{self.port.name}"


@dataclass(frozen=True)
class Bond:
    """A power bond by places on the buses, one channel for each force.

    given, seen: places among the inputs: the force that the taker was given, the position that the giver was shown. Without a
        connection that shows it, ``seen`` is -1, and ``work`` is there.
    force, position: places among the outputs: the force that the giver computed, the position of the taker.
    work: output of the giver that counts the energy brought into it.
    sign: -1 where force and position count in opposite directions, else 1.
    """

    name: str
    given: NDArray[np.int64]
    seen: NDArray[np.int64]
    force: NDArray[np.int64]
    position: NDArray[np.int64]
    work: End | None
    sign: float = 1.0


@dataclass(frozen=True)
class Plan:
    """A system ready to run.

    inputs, outputs: the ports that take part in the exchange, in the order of the two buses: by component, kind, reference.
    source: place among the outputs of what feeds each input.
    starts: what is set before the initialisation.
    recorded: columns of the results. watched: places among the outputs.
    reference: the energy that the ledger compares with, as a number or a port; None without an alarm.
    """

    system: System
    order: tuple[str, ...]
    descriptions: Mapping[str, Description]
    timing: Timing
    schedule: Schedule
    starts: Mapping[str, list[tuple[Port, float | str]]]
    inputs: tuple[End, ...]
    outputs: tuple[End, ...]
    source: NDArray[np.int64]
    bonds: tuple[Bond, ...]
    recorded: tuple[End, ...]
    watched: NDArray[np.int64]
    reference: float | End | None
    warnings: tuple[str, ...] = ()


def make_plan(system: System, sources: Mapping[str, Source]) -> Plan:
    """Check the whole system and resolve every name.

    Raises:
        InputRefused: everything that is wrong with it.
    """
    return _Planner(system, sources).plan()


@dataclass
class _Planner:
    """Works through a system and collects problems; a part that depends on something missing is passed over in silence."""

    system: System
    sources: Mapping[str, Source]
    problems: list[Problem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    descriptions: dict[str, Description] = field(default_factory=dict)

    def plan(self) -> Plan:
        """Go through the system part by part, then refuse it or return the plan."""
        self._describe()
        order = self._order()
        timing = make_timing(self.system, self.problems)
        links = self._links()
        starts = self._starts({target.name for _, target in links})
        bonds = {
            name: ends
            for name, bond in self.system.bonds.items()
            if (ends := self._bond_ends(name, bond, links))
        }
        watched = self._selected("watch", self.system.watch)
        recorded = self._selected("record", self.system.record)
        reference = self._reference()
        self._check_states()
        if (
            timing is not None and min(timing.output_every, timing.state_every) > 0
        ):  # else refused already
            self._check_amount(timing, 1 + len(recorded) + 3 * len(bonds))
        for name, values in starts.items():
            self._check_internal_step(name, values)
        if self.problems or timing is None:
            raise InputRefused(self.problems)
        inputs = self._sorted(order, (target for _, target in links))
        outputs = self._sorted(
            order,
            [s for s, _ in links]
            + watched
            + [e for b in bonds.values() for e in b.force + b.position],
        )
        place = {end.name: i for i, end in enumerate(outputs)}
        feeds = {target.name: place[source.name] for source, target in links}
        return Plan(
            self.system,
            order,
            self.descriptions,
            timing,
            schedule.plan(order, timing.steps, timing.exchange, self.system.master),
            starts,
            inputs,
            outputs,
            np.array([feeds[end.name] for end in inputs], np.int64),
            tuple(
                _bond(name, ends, place, {end.name: i for i, end in enumerate(inputs)})
                for name, ends in bonds.items()
            ),
            tuple(recorded),
            np.array([place[end.name] for end in watched], np.int64),
            reference,
            tuple(self.warnings),
        )

    def _refuse(self, where: str, what: str, remedy: str = "") -> None:
        self.problems.append(Problem(where, what, remedy))

    # ------------------------------------------------------------------ components

    def _describe(self) -> None:
        for name, source in self.sources.items():
            try:
                self.descriptions[name] = read_description(source.model_description())
                self.warnings += [f"{name}: {text}" for text in self.descriptions[name].warnings]
            except InputRefused as refusal:
                self.problems += [
                    Problem(name, f"{p.where}: {p.what}", p.remedy) for p in refusal.problems
                ]
            except ValueError as error:
                self._refuse(
                    name,
                    f"{self.system.components[name].fmu} {error}",
                    "use an FMU of it for FMI 2.0",
                )
        self._check_instances()

    def _check_instances(self) -> None:
        """Some FMUs may be in a process only once."""
        users: dict[str, list[str]] = {}
        for name, description in self.descriptions.items():
            if description.once_per_process:
                users.setdefault(description.guid, []).append(name)
        for names in users.values():
            if len(names) > 1:
                self._refuse(
                    ", ".join(names),
                    "use one FMU that can be instantiated only once in a process",
                    "export it under two names",
                )

    def _order(self) -> tuple[str, ...]:
        order, known = self.system.order or list(self.system.components), self.system.components
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

    def _check_internal_step(self, name: str, starts: Iterable[tuple[Port, float | str]]) -> None:
        step = self.system.step(name)
        for port, value in starts:
            if (
                port.name == "internal_step"
                and isinstance(value, float)
                and 0.0 < value * MOST_INTERNAL_STEPS < step
            ):
                self._refuse(
                    f"{name}.internal_step",
                    f"steps of {value:g} s are {step / value:.2g} in each communication step of "
                    f"{step:g} s, and at most {MOST_INTERNAL_STEPS:,} can be made",
                    f"raise it to {step / MOST_INTERNAL_STEPS:g} s or more",
                )

    def _check_amount(self, timing: Timing, columns: int) -> None:
        """Refuse what would fill memory or disk hours later."""
        rows = timing.exchanges // timing.output_every + 1
        if rows * columns > MOST_VALUES:
            self._refuse(
                "output_interval",
                f"{rows:,} rows of {columns:,} columns are {rows * columns:.2g} values "
                f"({8e-9 * rows * columns:.2g} GB), and at most {MOST_VALUES:.0e} can be kept",
                f"{_longer(timing, MOST_VALUES // columns)} or more will do; or shorten stop_time, or record less",
            )
        framed = sum(spec.record_states for spec in self.system.components.values())
        states = (timing.exchanges // timing.state_every + 1) * framed
        if states > MOST_STATES:
            self._refuse(
                "state_interval",
                f"{states:,} states would be recorded, and at most {MOST_STATES:,} can be kept",
                f"{_longer(timing, MOST_STATES // framed)} or more will do; or shorten stop_time",
            )

    # ------------------------------------------------------------------ names

    def _ends(self, where: str, component: str, name: str) -> list[End]:
        """The ports that a name or an array shorthand stands for; none of them if any is unknown."""
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
        names = expand(self._present(component, name), ports)
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

    def _present(self, component: str, name: str) -> str:
        """Return the present name of a variable, and warn once of an older one."""
        present = present_name(self.descriptions[component], name)
        if present != name:
            text = renaming_warning(component, name, present)
            self.warnings += [] if text in self.warnings else [text]
        return present

    def _of_causality(self, where: str, ends: list[End], causality: str) -> list[End]:
        wrong = [end for end in ends if end.port.causality != causality]
        if wrong:
            end = wrong[0]
            remedy = (
                f"a parameter is fixed before the run: set it under components.{end.component}.parameters"
                if end.port.causality == "parameter"
                else f"{causality}s are: {_few(port.name for port in self.descriptions[end.component].named(causality))}"
            )
            self._refuse(
                where,
                f"{end.name} is of the causality {end.port.causality}, and an {causality} is needed",
                remedy,
            )
        return [] if wrong else ends

    def _selected(self, key: str, patterns: Iterable[str]) -> list[End]:
        """Ports that patterns select: outputs where a pattern leaves something open, else any variable."""
        every = (
            End(name, port)
            for name, known in self.descriptions.items()
            for port in known.ports.values()
        )
        ends = {end.name: end for end in every if end.port.is_number}
        outputs = [name for name, end in ends.items() if end.port.causality == "output"]
        chosen: dict[str, End] = {}
        for given in patterns:
            pattern = self._present_pattern(given)
            names = [pattern] if pattern in ends and key == "record" else select(pattern, outputs)
            if (
                not names
                and len(self.descriptions) == len(self.system.components)
                and pattern != "*"
            ):
                self._refuse(key, f"{pattern!r} selects no output", nearest(pattern, outputs))
            chosen |= {name: ends[name] for name in names}
        return list(chosen.values())

    def _present_pattern(self, pattern: str) -> str:
        component, name = _split(pattern)
        if component not in self.descriptions:
            return pattern
        return f"{component}.{self._present(component, name)}"

    def _sorted(self, order: tuple[str, ...], ends: Iterable[End]) -> tuple[End, ...]:
        unique = {end.name: end for end in ends}
        return tuple(
            sorted(
                unique.values(),
                key=lambda e: (
                    order.index(e.component),
                    e.port.kind != REAL,
                    e.port.kind,
                    e.port.reference,
                ),
            )
        )

    # ------------------------------------------------------------------ connections

    def _links(self) -> list[tuple[End, End]]:
        """Source and target of every single connection."""
        links: list[tuple[End, End]] = []
        for connection in self.system.connections:
            links += self._expanded(connection)
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

    def _expanded(self, connection: Connection) -> list[tuple[End, End]]:
        where = f"{connection.source} -> {connection.target}"
        sources = self._of_causality(where, self._ends(where, *_split(connection.source)), "output")
        targets = self._of_causality(where, self._ends(where, *_split(connection.target)), "input")
        if not sources or not targets:
            return []
        if len(sources) != len(targets):
            self._refuse(
                where,
                f"connects {len(sources)} outputs with {len(targets)} inputs",
                "give ranges of one length, [1..24], or build the FMUs with sizes that fit",
            )
            return []
        pairs = list(zip(sources, targets, strict=True))
        self._check_pairs(where, pairs)
        return pairs

    def _check_pairs(self, where: str, pairs: list[tuple[End, End]]) -> None:
        """Kind and unit of the first pair that does not fit; the elements of an array have them in common."""
        for source, target in pairs:
            if source.port.kind != target.port.kind or not source.port.is_number:
                self._refuse(
                    where,
                    f"{source.name} is {source.port.kind} and {target.name} is {target.port.kind}",
                    "connect ports of one type, Real, Integer or Boolean",
                )
                return
            agree = _units_agree(source.port.unit, target.port.unit)
            if agree is False:
                self._refuse(
                    where,
                    f"{source.name} is in {_unit_text(source.port.unit)}, {target.name} in "
                    f"{_unit_text(target.port.unit)}",
                    "connect ports of one unit",
                )
                return
            if agree is None:
                self.warnings.append(
                    f"{where}: units {source.port.unit_name} and {target.port.unit_name} are not defined in the "
                    "model descriptions and are taken to be the same"
                )
                return

    # ------------------------------------------------------------------ values

    def _starts(self, connected: set[str]) -> dict[str, list[tuple[Port, float | str]]]:
        """What to set in each component, shared values included."""
        given: dict[str, tuple[End, str, Value]] = {}
        for name, spec in self.system.components.items():
            for key, value in self._parameters(name, spec).items():
                self._give(
                    given, f"{name}.{key}", f"components.{name}.parameters", value, connected
                )
        for key, shared in self.system.shared.items():
            for target in shared.targets:
                self._give(given, target, f"shared.{key}", shared.value, connected)
        starts: dict[str, list[tuple[Port, float | str]]] = {
            name: [] for name in self.system.components
        }
        for end, _, value in given.values():
            try:
                starts[end.component].append((end.port, value_for(end.port, value)))
            except ValueError as error:
                self._refuse(
                    end.name,
                    f"{value!r}: {error}",
                    f"set {end.name} ({end.port.description}) to another value",
                )
        return starts

    def _parameters(self, name: str, spec: ComponentSpec) -> dict[str, Value]:
        """Return the values of a component; one under an older name takes the place of that under the present one."""
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
        for end in self._ends(target, *_split(target)):
            if end.port.causality not in ("parameter", "input"):
                self._refuse(
                    end.name,
                    f"is of the causality {end.port.causality} and cannot be set",
                    "set parameters and unconnected inputs only",
                )
            elif end.name in connected:
                self._refuse(end.name, f"is set in {giver} and is connected", "remove one of both")
            elif end.name in given:
                self._refuse(
                    end.name, f"is set in {given[end.name][1]} and in {giver}", "remove one of both"
                )
            else:
                given[end.name] = (end, giver, value)

    # ------------------------------------------------------------------ energy

    def _bond_ends(
        self, name: str, bond: PowerBond, links: list[tuple[End, End]]
    ) -> "_BondEnds | None":
        where = f"bonds.{name}"
        force = self._of_causality(
            where, [e for f in bond.force for e in self._ends(where, bond.giver, f)], "output"
        )
        position = self._of_causality(
            where, [e for p in bond.position for e in self._ends(where, bond.taker, p)], "output"
        )
        work = self._of_causality(
            where, self._ends(where, bond.giver, bond.work) if bond.work else [], "output"
        )
        if not force or not position or (bond.work and not work):
            return None
        if len(force) != len(position):
            self._refuse(
                where,
                f"has {len(force)} forces and {len(position)} positions",
                "name one position for each force",
            )
            return None
        given = self._connected(
            where, links, force, bond.taker, "the ledger takes the force that the taker was given"
        )
        seen = (
            []
            if work
            else self._connected(
                where,
                links,
                position,
                bond.giver,
                "the ledger takes the displacement that the "
                "giver was shown; or name the giver's work output",
            )
        )
        self._check_energy_units(where, force, position, work)
        return _BondEnds(
            force, position, given, seen, work[0] if work else None, -1.0 if bond.opposed else 1.0
        )

    def _connected(
        self, where: str, links: list[tuple[End, End]], sources: list[End], component: str, why: str
    ) -> list[End]:
        """The inputs of ``component`` that the sources feed."""
        fed = {source.name: target for source, target in links if target.component == component}
        missing = [source.name for source in sources if source.name not in fed]
        if missing:
            self._refuse(where, f"{missing[0]} is connected to no input of {component}", why)
        return [] if missing else [fed[source.name] for source in sources]

    def _check_energy_units(
        self, where: str, force: list[End], position: list[End], work: list[End]
    ) -> None:
        for f, p in zip(force, position, strict=True):
            if _is_joule(f.port.unit, p.port.unit) is False:
                self._refuse(
                    where,
                    f"{f.name} in {f.port.unit_name} times {p.name} in {p.port.unit_name} is no energy in J",
                    "name forces with positions and torques with angles, in SI units",
                )
                return
        if work and _is_joule(work[0].port.unit, Unit("1", {})) is False:
            self._refuse(
                where, f"{work[0].name} is in {work[0].port.unit_name}", "name an output in J"
            )

    def _reference(self) -> float | End | None:
        alarm = self.system.energy_alarm
        if alarm is None or isinstance(alarm.reference, float):
            return None if alarm is None else float(alarm.reference)
        where = "energy_alarm.reference"
        ends = self._of_causality(where, self._ends(where, *_split(alarm.reference)), "output")
        return ends[0] if ends else None


class _BondEnds(NamedTuple):
    force: list[End]
    position: list[End]
    given: list[End]
    seen: list[End]
    work: End | None
    sign: float


def _longer(timing: Timing, most: int) -> str:
    """The shortest interval of 1, 2 or 5 times a power of ten exchanges that gives at most so many rows or states."""
    least = timing.exchanges / max(1, most - 1)
    power = 10 ** math.floor(math.log10(max(1.0, least)))
    every = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least)
    return f"{to_seconds(every * timing.exchange):g} s"


def _bond(name: str, ends: _BondEnds, output: Mapping[str, int], given: Mapping[str, int]) -> Bond:
    def places(table: Mapping[str, int], named: list[End]) -> NDArray[np.int64]:
        return np.array([table[end.name] for end in named], np.int64)

    seen = places(given, ends.seen) if ends.seen else np.full(len(ends.force), -1, np.int64)
    return Bond(
        name,
        places(given, ends.given),
        seen,
        places(output, ends.force),
        places(output, ends.position),
        ends.work,
        ends.sign,
    )


def _split(text: str) -> tuple[str, str]:
    component, _, name = text.partition(".")
    return component, name


def _few(names: Iterable[str]) -> str:
    listed = list(names)
    return ", ".join(listed[:8]) + (", ..." if len(listed) > 8 else "") if listed else "none"


def _units_agree(one: Unit | None, other: Unit | None) -> bool | None:
    """Whether values can pass unchanged; a port without a unit goes with everything."""
    return True if one is None or other is None else one.agrees_with(other)


def _unit_text(unit: Unit | None) -> str:
    if unit is None or unit.base is None:
        return unit.name if unit else "1"
    base = ".".join(symbol + (str(n) if n != 1 else "") for symbol, n in unit.base.items()) or "1"
    return f"{unit.name} ({unit.factor:g} {base}" + (f" + {unit.offset:g})" if unit.offset else ")")


def _is_joule(one: Unit | None, other: Unit | None) -> bool | None:
    """Whether the product of two units is the joule; None where that cannot be known. An angle counts as a number."""
    if one is None or other is None or one.base is None or other.base is None:
        return None
    exponents = {
        s: one.base.get(s, 0) + other.base.get(s, 0) for s in {*one.base, *other.base} - {"rad"}
    }
    return {s: n for s, n in exponents.items() if n} == _JOULE and one.factor * other.factor == 1.0

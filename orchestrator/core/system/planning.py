"""From a system to its plan: everything checked against the FMUs, names replaced by places.

Nothing runs here. All problems of a system are found at once.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rockshed.components.common.roles import Role

from ..errors import InputRefused, Problem
from ..fmu.slave import REAL, Source
from .adaptive import adaptive_problems, make_schedules
from .bonding import BondEnds, Bonder, bond_places
from .describing import Describer
from .extrapolation import Extrapolating, extrapolation_problems
from .finding import Finder
from .imposing import Imposed, imposed_ends, imposed_places
from .iterated import iteration_problems, plan_iteration, window_problems
from .iteration import Iteration
from .limits import amount_problems, internal_step_problems
from .linking import Linker, Links
from .loops import algebraic_loops, told
from .names import nearest
from .plan import End, Plan, PlannedScenario, Starts, with_whole_arrays
from .rollback import rollback_problems
from .staging import ScenarioReader
from .starting import Starter
from .system import SystemSpec
from .timing import Timing, make_timing
from .values import start_value


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
    return _Planner(system, sources, Finder(system)).plan()


def problems_with(
    system: SystemSpec, sources: Mapping[str, Source], timed: bool = True, connected: bool = True
) -> list[Problem]:
    """Return everything that is wrong with a system.

    Parameters
    ----------
    system : SystemSpec
        Checked in its form already.
    sources : mapping of str to Source
        Give the model descriptions of the components.
    timed : bool
        Whether its times are looked at.
    connected : bool
        Whether it has all its connections; else nothing is refused because one is missing.

    Returns
    -------
    list of Problem
        Empty if it can be run.
    """
    try:
        _Planner(system, sources, Finder(system), timed, connected).plan()
    except InputRefused as refusal:
        return refusal.problems
    return []


class _Parts(NamedTuple):
    """The parts of a system by ports; texts apart from numbers."""

    links: Links
    linear: Mapping[str, tuple[float, float]]
    texts: Links
    starts: dict[str, Starts]
    bonds: list[BondEnds]
    watched: list[End]
    recorded: list[End]
    recorded_texts: list[End]
    reference: float | End | None
    scenario: PlannedScenario
    imposed: list[Imposed]


@dataclass
class _Planner:
    """Works through a system and collects problems.

    A part that depends on something missing is passed over in silence.
    """

    system: SystemSpec
    sources: Mapping[str, Source]
    finder: Finder
    timed: bool = True
    connected: bool = True

    def plan(self) -> Plan:
        """Go through the system part by part, then refuse it or return the plan."""
        describer = Describer(self.finder, self.sources)
        describer.describe()
        order = self._order()
        timing = make_timing(self.system, self.finder.problems) if self.timed else None
        parts = self._parts(timing)
        self._check_states()
        self._check_iteration(parts, timing)
        describer.check_isolation()
        if timing is not None and min(timing.output_every, timing.state_every) > 0:
            columns = 1 + len(parts.recorded) + 3 * len(parts.bonds)
            self.finder.problems += amount_problems(self.system, timing, columns)
        if self.timed:
            self.finder.problems += internal_step_problems(self.system, parts.starts)
            self.finder.problems += adaptive_problems(
                self.system, self.finder.descriptions, parts.scenario
            )
        is_whole = len(self.finder.descriptions) == len(self.system.components)
        if self.finder.problems or timing is None or not is_whole:
            raise InputRefused(self.finder.problems)
        return self._with_loops(self._resolved(order, timing, parts), parts.links)

    def _with_loops(self, plan: Plan, links: Links) -> Plan:
        """Return the plan with the algebraic loops, and a warning where they get a delay."""
        loops = algebraic_loops(self.finder.descriptions, links, at_start=False)
        at_start = algebraic_loops(self.finder.descriptions, links, at_start=True)
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
        linker = Linker(self.finder, self.sources)
        told = len(self.finder.problems)
        links = linker.links()
        self.connected = self.connected and len(self.finder.problems) == told
        starter = Starter(self.finder)
        fed = {target.name for _, target in links}
        starts = starter.starts(fed)
        starter.check_arrays(links, starts)
        bonder = Bonder(self.finder, self.connected)
        bonds = [bonder.bond(name, bond, links) for name, bond in self.system.bonds.items()]
        if self.connected:
            self.finder.problems += extrapolation_problems(
                self.system, self.finder.descriptions, (target for _, target in links)
            )
        scenario = self._scenario(links, starts, timing)
        return _Parts(
            [link for link in links if link[0].port.is_number],
            linker.linear,
            [link for link in links if not link[0].port.is_number],
            starts,
            [bond for bond in bonds if bond],
            self.finder.selected("watch", self.system.watch),
            self.finder.selected("record", self.system.record),
            self.finder.texts_selected(self.system.record),
            bonder.reference(),
            scenario,
            imposed_ends(self.finder.descriptions, scenario.inputs.values(), fed),
        )

    def _scenario(
        self, links: Links, starts: Mapping[str, Starts], timing: Timing | None
    ) -> PlannedScenario:
        def find(where: str, name: str) -> list[End]:
            return self.finder.ends(where, *self.finder.split(name))

        fed = {target.name: target for _, target in links}
        given = {f"{name}.{port.name}" for name, listed in starts.items() for port, _ in listed}
        reader = ScenarioReader(find, fed, given, timing, self.connected, self.finder.problems)
        return reader.read(self.system.scenario)

    def _resolved(self, order: tuple[str, ...], timing: Timing, parts: _Parts) -> Plan:
        """Replace ports by places on the buses."""
        targets = [*(target for _, target in parts.links), *parts.scenario.inputs.values()]
        inputs = _sorted(order, with_whole_arrays(self.finder.descriptions, targets))
        outputs = _sorted(order, with_whole_arrays(self.finder.descriptions, _exchanged(parts)))
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
            descriptions=self.finder.descriptions,
            timing=timing,
            schedule=schedules[0],
            iteration=plan_iteration(self.system, inputs, outputs, source),
            starts=parts.starts,
            inputs=inputs,
            outputs=outputs,
            source=np.array(source, np.int64),
            held=np.array([_held(end, parts.starts) for end in unfed], np.float64),
            linear=_at_places({**parts.scenario.ways, **parts.linear}, place_of_input),
            bonds=tuple(bond_places(bond, place, place_of_input) for bond in parts.bonds),
            recorded=tuple(parts.recorded),
            watched=np.array([place[end.name] for end in parts.watched], np.int64),
            reference=parts.reference,
            balances=tuple(self._of_role(order, Role.RESIDUAL)),
            kinetic=tuple(self._of_role(order, Role.KINETIC)),
            warnings=tuple(self.finder.warnings),
            texts=tuple((target, source) for source, target in parts.texts),
            recorded_texts=tuple(parts.recorded_texts),
            scenario=parts.scenario,
            imposed=imposed_places(parts.imposed, place, place_of_input),
            extrapolated=extrapolating.inputs(inputs, outputs, source),
            longer=schedules[1:],
        )

    def _order(self) -> tuple[str, ...]:
        known = self.system.components
        order = self.system.order or list(known)
        for name in dict.fromkeys(order):
            if name not in known:
                self.finder.refuse("order", f"there is no component {name!r}", nearest(name, known))
            elif order.count(name) > 1:
                self.finder.refuse(
                    "order", f"names {name} {order.count(name)} times", "name each component once"
                )
        if missing := [name for name in known if name not in order]:
            self.finder.refuse(
                "order", f"does not name {', '.join(missing)}", "name each component once"
            )
        return tuple(order)

    def _check_states(self) -> None:
        wanted = [name for name, spec in self.system.components.items() if spec.record_states]
        if wanted and self.system.state_interval is None:
            self.finder.refuse(
                "state_interval",
                f"is missing, and states of {', '.join(wanted)} are to be recorded",
                "give it, in s",
            )
        for name in wanted:
            if (
                name in self.finder.descriptions
                and not self.finder.descriptions[name].serializes_state
            ):
                self.finder.refuse(
                    f"{name}.record_states", "the FMU cannot serialize its state", "leave it out"
                )

    def _check_iteration(self, parts: _Parts, timing: Timing | None) -> None:
        """Refuse what the implicit master cannot do, or what only it would understand."""
        if self.connected:
            self.finder.problems += iteration_problems(self.system.iteration, parts.links)
        if self.system.master != "implicit":
            if self.system.iteration != Iteration():
                self.finder.warnings.append(
                    f"[iteration] does nothing with the {self.system.master} master; "
                    'it is for master = "implicit"'
                )
            return
        self.finder.problems += rollback_problems(self.finder.descriptions, "the implicit master")
        if parts.texts or parts.recorded_texts:
            end = parts.texts[0][0] if parts.texts else parts.recorded_texts[0]
            what = "is text, which the implicit master cannot take back"
            self.finder.refuse(end.name, what, "leave it out, or choose another master")
        specs = self.system.components.values()
        if self.system.extrapolation or any(spec.extrapolation for spec in specs):
            what = "is for the other masters: the implicit one has the values of the end"
            self.finder.refuse("extrapolation", what, "leave it out, and choose iteration.input")
        if self.system.adaptive is not None:
            self.finder.refuse("adaptive", "is for the other masters", "leave it out")
        if timing is not None:
            self.finder.problems += window_problems(self.system, timing)

    def _of_role(self, order: Iterable[str], role: Role) -> Iterator[End]:
        """Yield the outputs that are declared with a role, or a kind of it."""
        for component in order:
            for port in self.finder.descriptions[component].named("output"):
                if port.kind == REAL and role.includes(port.annotation.role):
                    yield End(component, port)


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


def _exchanged(parts: _Parts) -> Iterator[End]:
    """Yield the outputs that an exchange has to read."""
    yield from (source for source, _ in parts.links)
    yield from parts.watched
    yield from (end for bond in parts.bonds for end in bond.force + bond.position)
    yield from parts.scenario.asked
    yield from (pair.shown for pair in parts.imposed)


def _held(end: End, starts: Mapping[str, Starts]) -> float:
    """Return the value of an element of an input that nothing feeds: given, or its start value."""
    given = {port.name: value for port, value in starts[end.component]}
    return float(given.get(end.port.name, start_value(end.port) or 0.0))


def _at_places(
    ways: Mapping[str, tuple[float, float]], place: Mapping[str, int]
) -> dict[int, tuple[float, float]]:
    """Return factors and offsets of inputs by their places."""
    return {place[name]: way for name, way in ways.items() if name in place}

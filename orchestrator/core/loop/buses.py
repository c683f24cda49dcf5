"""The values that a run carries from exchange to exchange."""

from functools import cached_property

import numpy as np

from ..fmu.slave import OK, Slave, worst
from ..fmu.types import LARGEST_WHOLE, MORE_BITS, TYPES
from ..system.plan import End, Plan
from ..system.schedule import Action, Operation
from .blocks import Block, make_blocks
from .snapshots import Snapshots
from .tables import (
    CHANNEL,
    CONDITION,
    DISCRETE,
    EXTRAPOLATED,
    GIVER,
    LINEAR,
    POSTED,
    SIGNS,
    TAKER,
    WATCHED,
    IntegerTable,
    Records,
)
from .texts import Texts

_MOST_EXCHANGES = 1000
"""Exchanges of a course that are computed at once."""
_MOST_NUMBERS = 1_000_000
"""Inputs times exchanges of a course, at most."""


class Buses:
    """Both buses, the works of the bonds, the watched outputs and the snapshots of a run.

    Parameters
    ----------
    plan : Plan
        Says which ports lie where on the buses.
    journal : array of int64, shape (2,), optional
        Exchange and operation under way, see :mod:`rockshed.core.loop.journal`.

    Attributes
    ----------
    inputs, outputs : array of float
        Newest values of all connected inputs and of all exchanged outputs; behind these, the values
        of the elements of inputs that nothing feeds, and with the implicit master the values that
        inputs have in a step.
    setters, getters : dict of str to list of Block
        Calls that move a component's values.
    channels : array of CHANNEL
        Work of each force of a bond.
    watched : array of WATCHED
        Extremes and integral of each watched output.
    texts : Texts
        Those that are passed on or recorded.
    linear : array of LINEAR
        Inputs that get other values than their sources have, by rising place; a scenario changes
        them.
    fired : array of int
        Number of exchanges after which each condition of the scenario was true; -1 before.
    conditions : array of CONDITION
        Those conditions, for the loop.
    course : array of float, shape (exchanges, inputs, 2)
        Factor and offset of the inputs of the scenario that change all the time.
    course_rows : array of int64, shape (inputs,)
        Their rows in ``linear``.
    course_span : array of int64, shape (2,)
        The first exchange in the course, and how many it has.
    extrapolated : array of EXTRAPOLATED
        Inputs that follow polynomials, by rising place.
    discrete : array of DISCRETE
        Outputs whose changes begin polynomials anew, by rising place.
    jumps : array of int64
        Events of each component, in the order of turns.
    posted : array of POSTED
        Sides of channels that are posted after each step, component by component.
    """

    def __init__(self, plan: Plan, journal: IntegerTable | None = None) -> None:
        self.plan = plan
        self.inputs = np.zeros(len(plan.inputs))
        own = np.zeros(0 if plan.iteration is None else len(plan.inputs))
        self.outputs = np.concatenate((np.zeros(len(plan.outputs)), plan.held, own))
        self.setters = make_blocks(plan.inputs)
        self.getters = make_blocks(plan.outputs)
        self.channels = _channels(plan)
        self.watched = _watched(plan)
        self.linear = _linear(plan)
        self.fired = np.full(len(plan.scenario.conditions), -1, np.int64)
        self.conditions = _conditions(plan)
        places = [plan.place_of_input[name] for name in plan.scenario.restless]
        self.course_rows = np.searchsorted(self.linear["place"], places).astype(np.int64)
        number = min(_MOST_EXCHANGES, _MOST_NUMBERS // max(1, len(places)))
        self.course = np.full((number if places else 0, len(places), 2), np.nan)
        self.course_span = np.zeros(2, np.int64)
        self.extrapolated = _extrapolated(plan)
        self.discrete = _discrete(plan)
        self.jumps = np.zeros(len(plan.order), np.int64)
        self.posted = _posted(plan)
        self.snapshots = Snapshots(plan)
        self.journal = np.full(2, -1, np.int64) if journal is None else journal
        self.texts = Texts(plan, self.journal)

    @cached_property
    def needs(self) -> dict[str, set[int]]:
        """Places of the outputs that feed each component's inputs."""
        return {
            name: {
                int(place)
                for block in self.setters.get(name, [])
                for place in self.plan.source[block.places]
                if place < len(self.plan.outputs)
            }
            for name in self.plan.order
        }

    @cached_property
    def shows(self) -> dict[str, set[int]]:
        """Places of each component's outputs."""
        return {
            name: {
                place
                for block in self.getters.get(name, [])
                for place in range(block.places.start, block.places.stop)
            }
            for name in self.plan.order
        }

    @cached_property
    def operations(self) -> list[Operation]:
        """Operations of a period, of longer exchanges, and those that read what is recorded."""
        schedules = (self.plan.schedule, *self.plan.longer)
        return [
            *(
                operation
                for schedule in schedules
                for exchange in schedule.operations
                for operation in exchange
            ),
            *(Operation(Action.RECORD, name) for name in self.snapshots.blocks),
        ]

    def give(self, slave: Slave) -> int:
        """Set all connected inputs of a slave to the newest values; return the worst status."""
        status = OK
        for block in self.setters.get(slave.name, []):
            self.inputs[block.places] = self.outputs[self.plan.source[block.places]]
            values = self.inputs[block.places]
            ways = self.linear[self.linear_of(block)]
            at = ways["place"] - block.begin
            values[at] = ways["factor"] * values[at] + ways["offset"]
            status = worst(status, slave.set(block.references, values, block.type))
        return worst(status, self.texts.give(slave))

    def linear_of(self, block: Block) -> slice:
        """Return which rows of the table of linear inputs belong to a block of inputs."""
        places = self.linear["place"]
        return _within(places, block)

    def extrapolated_of(self, block: Block) -> slice:
        """Return which rows of the table of extrapolated inputs belong to a block of inputs."""
        return _within(self.extrapolated["place"], block)

    def discrete_of(self, component: str) -> slice:
        """Return which rows of the table of discrete outputs belong to a component."""
        blocks = self.getters.get(component, [])
        rows = [_within(self.discrete["place"], block) for block in blocks]
        return slice(rows[0].start, rows[-1].stop) if rows else slice(0, 0)

    def posted_of(self, component: str) -> slice:
        """Return which rows of the table of posted sides belong to a component."""
        owners = [owner for owner, _, _ in _sides(self.plan)]
        first = owners.index(component) if component in owners else 0
        return slice(first, first + owners.count(component))

    def take(self, slave: Slave) -> int:
        """Get all exchanged outputs of a slave; return the worst status."""
        status = OK
        for block in self.getters.get(slave.name, []):
            values = self.outputs[block.places]
            status = worst(status, slave.get(block.references, values, block.type))
        return worst(status, self.texts.take(slave))

    def clear(self) -> None:
        """Forget all values that came from outputs."""
        self.inputs[:] = 0.0
        self.outputs[: len(self.plan.outputs)] = 0.0

    def unfit(self, component: str, action: Action) -> tuple[End, float] | None:
        """Return the first port that cannot hold its value, or whose value the bus cannot hold.

        Parameters
        ----------
        component : str
            Owner of the port.
        action : Action
            SET or EXTRAPOLATE for inputs, GET for outputs.
        """
        is_set = action in (Action.SET, Action.EXTRAPOLATE)
        ends = self.plan.inputs if is_set else self.plan.outputs
        values = self.inputs if is_set else self.outputs
        for end, value in zip(ends, values):
            held = TYPES[end.port.type]
            if end.component == component and not held.low <= value <= held.high:
                return end, float(value)
        return None

    def not_finite(self, component: str) -> End | None:
        """Return the first exchanged output of a component that is no finite number."""
        blocks = self.getters.get(component)
        if not blocks:
            return None
        begin = blocks[0].places.start
        values = self.outputs[begin : blocks[-1].places.stop]
        lost = np.flatnonzero(~np.isfinite(values))
        return self.plan.outputs[begin + lost[0]] if lost.size else None

    def open_accounts(self) -> None:
        """Count works, extremes and integrals from the present values on."""
        channels = self.channels
        shown = channels["seen"] >= 0
        channels["last_seen"][shown] = self.inputs[channels["seen"][shown]]
        channels["last_force"] = self.outputs[channels["force"]]
        channels["last_position"] = self.outputs[channels["position"]]
        for name in ("low", "high", "last"):
            self.watched[name] = self.outputs[self.watched["place"]]
        self.discrete["last"] = self.outputs[self.discrete["place"]]
        self._begin_polynomials()

    def _begin_polynomials(self) -> None:
        """Let every polynomial begin with the value that its source has at the start."""
        table = self.extrapolated
        values = self.outputs[self.plan.source[table["place"]]]
        _, rows, ways = np.intersect1d(table["place"], self.linear["place"], return_indices=True)
        linear = self.linear[ways]
        values[rows] = linear["factor"] * values[rows] + linear["offset"]
        table["value"] = values
        table["newest"] = self.plan.timing.start
        table["known"] = 1


def unfit_text(end: End, value: float) -> str:
    """Return why a value cannot be that of a port, or cannot be on the bus.

    Parameters
    ----------
    end : End
        The port.
    value : float
        What :meth:`Buses.unfit` has found.
    """
    held = TYPES[end.port.type]
    if held.is_whole and abs(value) > LARGEST_WHOLE:
        return f"{end.name} = {value:.17g}, {MORE_BITS}"
    return f"{end.name} is of the type {end.port.type}, which cannot hold {value:.17g}"


def _channels(plan: Plan) -> Records:
    channels = np.zeros(sum(bond.force.size for bond in plan.channels), CHANNEL)
    if plan.channels:
        for name in ("given", "seen", "force", "position"):
            channels[name] = np.concatenate([getattr(bond, name) for bond in plan.channels])
    return channels


def _linear(plan: Plan) -> Records:
    ways = {
        place: plan.scenario.at_start.get(plan.inputs[place].name, way)
        for place, way in plan.linear.items()
    }
    rows = [(place, *ways[place]) for place in sorted(ways)]
    return np.array(rows, LINEAR)


def _conditions(plan: Plan) -> Records:
    """Return the table of conditions, none of which has been true."""
    places = {end.name: place for place, end in enumerate(plan.outputs)}
    conditions = [switch.condition for switch in plan.scenario.conditions if switch.condition]
    rows = [(places[c.end.name], SIGNS.index(c.sign), 1, c.number) for c in conditions]
    return np.array(rows, CONDITION)


def _within(places: IntegerTable, block: Block) -> slice:
    """Return which of the rising places lie in a block."""
    first, end = np.searchsorted(places, [block.places.start, block.places.stop])
    return slice(int(first), int(end))


def _extrapolated(plan: Plan) -> Records:
    table = np.zeros(len(plan.extrapolated), EXTRAPOLATED)
    for row, entry in zip(table, plan.extrapolated, strict=True):
        for name in ("place", "order", "ahead", "every"):
            row[name] = getattr(entry, name)
        row["owner"] = plan.order.index(entry.owner)
    return table


def _discrete(plan: Plan) -> Records:
    """Return the table of outputs whose changes are events; empty where nobody asks for them."""
    owners = set(plan.order if plan.longer else (entry.owner for entry in plan.extrapolated))
    places = [
        place
        for place, end in enumerate(plan.outputs)
        if end.component in owners and end.port.is_held
    ]
    return np.array([(place, 0.0) for place in places], DISCRETE)


def _posted(plan: Plan) -> Records:
    return np.array([(channel, side) for _, channel, side in _sides(plan)], POSTED)


def _sides(plan: Plan) -> list[tuple[str, int, int]]:
    """Return component, channel and side of all that is posted after each step."""
    found = []
    channel = 0
    for name, bond in plan.system.bonds.items():
        number = next(places.force.size for places in plan.bonds if places.name == name)
        channels = range(channel, channel + number)
        channel += number
        found += [(bond.taker, place, TAKER) for place in channels]
        if bond.work is None:
            found += [(bond.giver, place, GIVER) for place in channels]
    extrapolating = {plan.inputs[entry.place].component for entry in plan.extrapolated}
    return sorted(side for side in found if side[0] in extrapolating)


def _watched(plan: Plan) -> Records:
    watched = np.zeros(plan.watched.size, WATCHED)
    watched["place"] = plan.watched
    return watched

"""A system ready to run: names replaced by places, times by ticks."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..fmu.description import Description, Port
from .iteration import InputMoment
from .schedule import Schedule
from .signals import Signals
from .system import SystemSpec
from .timing import Timing

Starts = list[tuple[Port, float | str]]
"""Ports of a component that are set before the initialisation, and their values."""


class End(NamedTuple):
    """A port of a component."""

    component: str
    port: Port

    @property
    def name(self) -> str:
        """``component.port``, the name in the results."""
        return f"{self.component}.{self.port.name}"


def with_whole_arrays(descriptions: Mapping[str, Description], ends: Iterable[End]) -> list[End]:
    """Return every port once, and of each array of FMI 3.0 all elements.

    Parameters
    ----------
    descriptions : mapping of str to Description
        Of the components.
    ends : iterable of End
        Ports.
    """
    found: dict[tuple[str, str], list[End]] = {}
    for end in ends:
        key = (end.component, end.port.array)
        if key not in found:
            elements = descriptions[end.component].elements_of(end.port)
            found[key] = [End(end.component, element) for element in elements]
    return [end for listed in found.values() for end in listed]


@dataclass(frozen=True)
class BondPlaces:
    """A power bond by places on the buses, one channel for each force.

    Attributes
    ----------
    name : str
        Of the bond in the system.
    given, seen : array of int, shape (channels,)
        Places among the inputs: the force that is set in the taker, the position that is shown to
        the giver. Without a connection that shows it, ``seen`` is -1, and ``work`` is there. One of
        both is -1 where a scenario imposes the other.
    force, position : array of int, shape (channels,)
        Places among the outputs: the force that the giver computes, the position of the taker.
    work : End or None
        Output of the giver that counts the energy brought into it (J).
    sign : float
        -1 where force and position count in opposite directions, else 1.
    """

    name: str
    given: NDArray[np.int64]
    seen: NDArray[np.int64]
    force: NDArray[np.int64]
    position: NDArray[np.int64]
    work: End | None
    sign: float = 1.0


class Condition(NamedTuple):
    """A comparison of an output with a number: ``rock.position.y < 1.0``."""

    end: End
    sign: str
    number: float
    text: str

    def holds(self, value: float) -> bool:
        """Tell whether it is true of a value of the output."""
        return {
            "<": value < self.number,
            "<=": value <= self.number,
            ">": value > self.number,
            ">=": value >= self.number,
        }[self.sign]


class Switch(NamedTuple):
    """A value that a port takes during a run, after so many exchanges or on a condition."""

    end: End
    value: float
    exchange: int | None
    condition: Condition | None


class PlannedFault(NamedTuple):
    """A fault of the connection to an input, from an exchange on until before another one.

    instead: value (unit of the input) of a connection that is cut. deviation, seed: of noise.
    """

    end: End
    kind: str
    begin: int
    stop: int
    instead: float
    deviation: float
    seed: int


class Extrapolated(NamedTuple):
    """An input that follows a polynomial between exchanges.

    Attributes
    ----------
    place : int
        On the bus of inputs.
    order : int
        Of the polynomial, 1 or 2.
    ahead, every : int
        What feeds it shows its values at the multiples of ``every``, and is then ``ahead`` of the
        beginning of the exchange (ticks).
    owner : str
        Component that feeds it, whose events begin the polynomial anew.
    """

    place: int
    order: int
    ahead: int
    every: int
    owner: str


NO_SIGNALS = Signals(np.empty(0), {})
"""A table of no inputs."""


@dataclass(frozen=True)
class PlannedScenario:
    """A scenario by ports and exchanges.

    Attributes
    ----------
    signals : Signals
        Inputs over time.
    driven : tuple of End
        Inputs that follow a column of their name.
    switches : tuple of Switch
        Values that change.
    faults : tuple of PlannedFault
        Of connections.
    at_start : mapping of str to (float, float)
        Factor and offset of inputs by name that differ from those of their connections already in
        the initialisation.
    """

    signals: Signals = NO_SIGNALS
    driven: tuple[End, ...] = ()
    switches: tuple[Switch, ...] = ()
    faults: tuple[PlannedFault, ...] = ()
    at_start: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.driven or self.switches or self.faults)

    @property
    def inputs(self) -> dict[str, End]:
        """Inputs that it acts on."""
        ends = [*self.driven, *(s.end for s in self.switches), *(f.end for f in self.faults)]
        return {end.name: end for end in ends if end.port.causality == "input"}

    @property
    def ways(self) -> dict[str, tuple[float, float]]:
        """Factor and offset of these inputs where their connections give none."""
        return dict.fromkeys(self.inputs, (1.0, 0.0))

    @property
    def noisy(self) -> list[PlannedFault]:
        """Faults that add noise to what a connection delivers, in the order of the scenario."""
        return [fault for fault in self.faults if fault.kind == "noise"]

    @property
    def restless(self) -> list[str]:
        """Names of the inputs that may change at every exchange."""
        return list(dict.fromkeys(e.name for e in (*self.driven, *(f.end for f in self.noisy))))

    @property
    def asked(self) -> list[End]:
        """Outputs that conditions ask for."""
        return [switch.condition.end for switch in self.switches if switch.condition is not None]

    @property
    def conditions(self) -> list[Switch]:
        """Values that wait for a condition."""
        return [switch for switch in self.switches if switch.condition is not None]


@dataclass(frozen=True)
class PlannedIteration:
    """Moments and tolerances of all inputs, by place, for the implicit master.

    Attributes
    ----------
    moments : tuple of str
        InputMoment of the values that it gets for a step.
    tolerances : array of float
        Relative tolerance of its source.
    absolutes : array of float
        Difference of its source that is tolerated besides, in its unit.
    """

    moments: tuple[InputMoment, ...]
    tolerances: NDArray[np.float64]
    absolutes: NDArray[np.float64]


@dataclass(frozen=True)
class Plan:
    """A system ready to run.

    Attributes
    ----------
    system : SystemSpec
        As it was checked.
    order : tuple of str
        Components in the order of their turns.
    descriptions : mapping of str to Description
        Of the components' FMUs.
    timing : Timing
        Times in ticks.
    schedule : Schedule
        Order of exchanges and steps.
    starts : mapping of str to Starts
        Values of each component that are set before the initialisation.
    inputs, outputs : tuple of End
        Ports that take part in the exchange, in the order of the two buses: by component, type,
        reference. Of an array of FMI 3.0, which is moved as a whole, all elements.
    source : array of int, shape (inputs,)
        Place among the outputs that feeds each input; one behind them leads to ``held``.
    held : array of float
        Values of the elements of inputs that nothing feeds.
    bonds : tuple of BondPlaces
        Power bonds.
    recorded : tuple of End
        Columns of the results.
    watched : array of int
        Places among the outputs.
    reference : float, End or None
        Energy E0 (J) that the ledger compares with; None where it is to find one.
    balances : tuple of End
        Outputs that give the error of a component's own balance of energy.
    kinetic : tuple of End
        Outputs that give a kinetic energy.
    warnings : tuple of str
        For the user.
    texts : tuple of (End, End)
        Inputs and outputs of the kind String that are connected.
    recorded_texts : tuple of End
        Variables of the kind String that are recorded.
    linear : mapping of int to (float, float)
        Factor and offset of the inputs, by place, that get other values than their sources have,
        at the start.
    scenario : PlannedScenario
        What changes during the run; all its inputs are in ``linear``.
    imposed : BondPlaces or None
        Channels in which the scenario does work; None where it does none that can be counted.
    extrapolated : tuple of Extrapolated
        Inputs that do not hold between exchanges, by rising place.
    longer : tuple of Schedule
        Of exchanges of 2, 4, 8, ... exchange steps, where the system is adaptive.
    loops, loops_at_start : tuple of str
        Algebraic loops of the run and of its initialisation, as chains of ports.
    iteration : PlannedIteration or None
        For the implicit master; None with another one.
    """

    system: SystemSpec
    order: tuple[str, ...]
    descriptions: Mapping[str, Description]
    timing: Timing
    schedule: Schedule
    starts: Mapping[str, Starts]
    inputs: tuple[End, ...]
    outputs: tuple[End, ...]
    source: NDArray[np.int64]
    held: NDArray[np.float64]
    bonds: tuple[BondPlaces, ...]
    recorded: tuple[End, ...]
    watched: NDArray[np.int64]
    reference: float | End | None
    balances: tuple[End, ...]
    kinetic: tuple[End, ...]
    warnings: tuple[str, ...] = ()
    linear: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    texts: tuple[tuple[End, End], ...] = ()
    recorded_texts: tuple[End, ...] = ()
    scenario: PlannedScenario = PlannedScenario()
    imposed: BondPlaces | None = None
    extrapolated: tuple[Extrapolated, ...] = ()
    longer: tuple[Schedule, ...] = ()
    iteration: PlannedIteration | None = None
    loops: tuple[str, ...] = ()
    loops_at_start: tuple[str, ...] = ()

    @cached_property
    def place_of_input(self) -> Mapping[str, int]:
        """Places of the inputs by their names."""
        return {end.name: place for place, end in enumerate(self.inputs)}

    @property
    def channels(self) -> tuple[BondPlaces, ...]:
        """Everything that has channels of work: the power bonds, then what a scenario imposes."""
        return self.bonds if self.imposed is None else (*self.bonds, self.imposed)

    @property
    def fed(self) -> Iterator[tuple[int, End, End]]:
        """Yield place and port of each input that is fed, and the output that feeds it.

        The place of a text, which lies on no bus, is -1.
        """
        for place, (target, source) in enumerate(zip(self.inputs, self.source, strict=True)):
            if source < len(self.outputs):
                yield place, target, self.outputs[source]
        for target, feeding in self.texts:
            yield -1, target, feeding

    def tolerance(self, component: str) -> float | None:
        """Return the relative tolerance that the solver of a component is told.

        Parameters
        ----------
        component : str
            Its own value comes before that of the system and the one that its FMU proposes.

        Returns
        -------
        float or None
            None where nobody gives one.
        """
        own = self.system.components[component].tolerance
        return own or self.system.tolerance or self.descriptions[component].tolerance

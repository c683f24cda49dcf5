"""Scenarios: inputs over time, values that change, faults of connections, checked against FMUs.

All of them act through one thing, the factor and the offset with which an input gets the value of
its source at an exchange (:attr:`rockshed.core.system.plan.Plan.linear`).
"""

import re
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import InputRefused, Problem
from ..fmu.description import Port
from ..fmu.slave import REAL
from .plan import NO_SIGNALS, Condition, End, PlannedFault, PlannedScenario, Switch
from .scenario import ConnectionFault, Scenario, ValueSet
from .signals import TIME, Signals, signals_of
from .timing import Timing, exchanges_in
from .values import start_value, value_for

Find = Callable[[str, str], list[End]]
"""Called with the place of a problem and the name of a port; returns its ends, or none."""

_CONDITION = re.compile(r"\s*(?P<port>[^<>=\s]+)\s*(?P<sign><=|>=|<|>)\s*(?P<number>[^<>=\s]+)\s*")
_FEEDS = "is fed by a connection"
_INSTEAD = "scenario.fault acts on what a connection delivers"


@dataclass
class ScenarioReader:
    """Finds the ports and exchanges of a scenario, and collects problems.

    Attributes
    ----------
    find : callable
        Finds ports by name.
    fed : mapping of str to End
        Inputs by name that connections feed.
    given : container of str
        Variables that have a value among the parameters.
    timing : Timing or None
        Of the run; None where its times do not fit.
    connected : bool
        Whether all connections are known; else none is missed.
    problems : list of Problem
        Gets what is wrong.
    """

    find: Find
    fed: Mapping[str, End]
    given: Container[str]
    timing: Timing | None
    connected: bool = True
    problems: list[Problem] = field(default_factory=list)

    def read(self, scenario: Scenario) -> PlannedScenario:
        """Return a scenario by ports and exchanges.

        Parameters
        ----------
        scenario : Scenario
            As data.

        Returns
        -------
        PlannedScenario
            What of it is in order.
        """
        signals, driven = self._inputs(scenario)
        switches = [
            switch
            for number, entry in enumerate(scenario.set)
            for switch in self._switches(f"scenario.set.{number}", entry)
        ]
        faults = [
            fault
            for number, entry in enumerate(scenario.fault)
            for fault in self._faults(f"scenario.fault.{number}", entry)
        ]
        self._refuse_twice(driven, switches)
        self._refuse_overlaps(faults)
        at_start = self._at_start(signals, driven, switches, faults)
        return PlannedScenario(signals, tuple(driven), tuple(switches), tuple(faults), at_start)

    def _at_start(
        self,
        signals: Signals,
        driven: Sequence[End],
        switches: Sequence[Switch],
        faults: Sequence[PlannedFault],
    ) -> dict[str, tuple[float, float]]:
        """Return factor and offset of the inputs that have another value from the start on."""
        begin = 0.0 if self.timing is None else self.timing.seconds(0)
        values = {end.name: signals.at(begin, end.name, end.port.is_held) for end in driven}
        for switch in switches:
            if switch.exchange == 0 and switch.end.port.causality == "input":
                values[switch.end.name] = switch.value
        values |= {f.end.name: f.instead for f in faults if f.begin == 0 and f.kind == "cut"}
        return {name: (0.0, value) for name, value in values.items()}

    def _refuse(self, where: str, what: str, remedy: str) -> None:
        self.problems.append(Problem(where, what, remedy))

    # ------------------------------------------------------------------ inputs over time

    def _inputs(self, scenario: Scenario) -> tuple[Signals, list[End]]:
        where = "scenario.inputs"
        if scenario.inputs is None:
            return NO_SIGNALS, []
        if isinstance(scenario.inputs, str):
            what = "is the path of a table that nobody has read"
            self._refuse(where, what, "System.load and System.scenario read it; or give columns")
            return NO_SIGNALS, []
        try:
            signals = signals_of(scenario.inputs, where)
        except InputRefused as refusal:
            self.problems += refusal.problems
            return NO_SIGNALS, []
        ends = [end for name in signals.columns for end in self._driven(where, name, signals)]
        return signals, ends

    def _driven(self, where: str, name: str, signals: Signals) -> Iterator[End]:
        """Yield the input of a column, if it can follow that."""
        if name == TIME:
            return
        ends = self.find(where, name)
        if not ends:
            return
        end = ends[0]
        if len(ends) > 1 or end.name != name:
            self._refuse(where, f"{name} is no name of one input", "name one input a column")
        elif end.port.causality != "input" or not end.port.is_number:
            what = f"{name} is no input of numbers, but {end.port.kind} {end.port.causality}"
            self._refuse(where, what, "leave the column out")
        elif name in self.fed:
            self._refuse(where, f"{name} {_FEEDS}", f"remove one of both; {_INSTEAD}")
        elif name in self.given:
            what = f"{name} has a value among the parameters too"
            self._refuse(where, what, "remove one of both")
        else:
            for value in np.unique(signals.columns[name]):
                if not self._fits(f"{where}: {name}", end.port, float(value)):
                    return
            yield end

    def _fits(self, where: str, port: Port, value: float) -> bool:
        is_whole = port.kind != REAL and value == int(value)
        try:
            value_for(port, int(value) if is_whole else value)
        except ValueError as error:
            self._refuse(where, f"{value:g}: {error}", "correct the column")
            return False
        return True

    # ------------------------------------------------------------------ values that change

    def _switches(self, where: str, entry: ValueSet) -> Iterator[Switch]:
        ends = self.find(f"{where}.port", entry.port)
        moment = self._exchange(f"{where}.at", entry.at) if entry.at is not None else None
        condition = self._condition(f"{where}.when", entry.when) if entry.when else None
        for end in ends:
            if reason := self._why_not(end):
                remedy = "set inputs that nothing feeds, or tunable parameters; " + _INSTEAD
                self._refuse(f"{where}.port", f"{end.name} {reason}", remedy)
                return
            try:
                value = value_for(end.port, entry.value)
            except ValueError as error:
                self._refuse(f"{where}.value", f"{entry.value!r}: {error}", f"for {end.name}")
                return
            if moment is not None or condition is not None:
                yield Switch(end, float(value), moment, condition)

    def _why_not(self, end: End) -> str:
        """Return why a variable cannot be set during a run; empty where it can."""
        port = end.port
        if not port.is_number:
            return f"is {port.kind}, and numbers alone are set during a run"
        if port.causality == "input":
            return _FEEDS if end.name in self.fed else ""
        if port.causality != "parameter":
            return f"is no parameter and no input, but {port.causality}"
        if port.shape:
            return "is an element of an array of FMI 3.0, which is set as a whole"
        return "" if port.is_tunable else "is a fixed parameter: FMI sets it before the start alone"

    def _condition(self, where: str, text: str) -> Condition | None:
        found = _CONDITION.fullmatch(text)
        number = None
        if found:
            try:
                number = float(found["number"])
            except ValueError:
                number = None
        if found is None or number is None or not np.isfinite(number):
            what = f"{text!r} is no comparison of an output with a number"
            self._refuse(where, what, 'write "component.output < 1.0", with <, <=, > or >=')
            return None
        ends = self.find(where, found["port"])
        if not ends:
            return None
        if len(ends) > 1 or ends[0].port.causality != "output" or not ends[0].port.is_number:
            self._refuse(where, f"{found['port']} is no output that is a number", "name one")
            return None
        return Condition(ends[0], found["sign"], number, text)

    def _refuse_twice(self, driven: Sequence[End], switches: Sequence[Switch]) -> None:
        """Refuse two values for one port at one time, and values of a port that has a column."""
        columns = {end.name for end in driven}
        seen: set[tuple[str, int]] = set()
        for switch in switches:
            name = switch.end.name
            if name in columns:
                self._refuse("scenario.set", f"{name} has a column too", "remove one of both")
            if switch.exchange is not None and (name, switch.exchange) in seen:
                self._refuse("scenario.set", f"{name} is set twice at one time", "remove one")
            seen |= set() if switch.exchange is None else {(name, switch.exchange)}

    # ------------------------------------------------------------------ faults

    def _faults(self, where: str, entry: ConnectionFault) -> Iterator[PlannedFault]:
        begin = self._exchange(f"{where}.from", entry.begin)
        end_ = None if entry.end is None else self._exchange(f"{where}.to", entry.end, is_end=True)
        if end_ is None and self.timing is not None:
            end_ = self.timing.exchanges
        for end in self.find(f"{where}.port", entry.port):
            is_missed = end.name not in self.fed and self.connected
            if is_missed or not end.port.is_number:
                what = f"{end.name} is no input that a connection feeds with numbers"
                self._refuse(f"{where}.port", what, "name the target of a connection")
                return
            if entry.kind == "noise" and end.port.kind != REAL:
                what = f"{end.name} is {end.port.kind}, and noise is for Real"
                self._refuse(f"{where}.kind", what, "choose frozen or cut")
                return
            if begin is not None and end_ is not None:
                instead = float(start_value(end.port) or 0.0)
                noise = (entry.deviation or 0.0, entry.seed)
                yield PlannedFault(end, entry.kind, begin, end_, instead, *noise)

    def _refuse_overlaps(self, faults: Sequence[PlannedFault]) -> None:
        until: dict[str, int] = {}
        for fault in sorted(faults, key=lambda fault: fault.begin):
            name = fault.end.name
            if fault.begin < until.get(name, 0):
                what = f"{name} has two faults at one time"
                self._refuse("scenario.fault", what, "let one end before the other begins")
            until[name] = max(fault.stop, until.get(name, 0))

    # ------------------------------------------------------------------ times

    def _exchange(self, where: str, at: float, is_end: bool = False) -> int | None:
        """Return the number of exchanges before a time (s); None where there is none then."""
        timing = self.timing
        if timing is None:
            return None  # told already
        number = exchanges_in(timing, at - timing.seconds(0))
        step = timing.lasts(timing.exchange)
        if number is None:
            near = int((at - timing.seconds(0)) // step)
            times = " or ".join(f"{timing.seconds(n):.12g} s" for n in (near, near + 1))
            what = f"{at:g} s is no time of an exchange, which are {step:g} s apart"
            self._refuse(where, what, f"nearest are {times}")
            return None
        if not 0 <= number < timing.exchanges + is_end:
            begin, stop = timing.seconds(0), timing.seconds(timing.exchanges)
            what = f"{at:g} s does not lie in the run, from {begin:g} s until before {stop:g} s"
            self._refuse(where, what, "give a time within it")
            return None
        return number

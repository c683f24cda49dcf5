"""Scenarios during a run: what an input gets in the place of its source's value.

Factor and offset of an input are changed (:attr:`~.buses.Buses.linear`), with which every input
gets the value of its source. What changes at every exchange is computed for many of them, and the
loop takes it from there; all else is done between two exchanges.
"""

import math
from collections.abc import Iterator, Mapping
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from ..fmu.slave import Slave
from ..system.plan import Plan, PlannedFault, Switch
from .buses import Buses
from .changes import set_between_steps

_OF_A_COUNT = 4
"""Random numbers that Philox gives for one count."""


class Course:
    """Lets a scenario take its course; a keeper of the master.

    Nothing is remembered outside the buses, which go into checkpoints.

    Parameters
    ----------
    buses : Buses
        Whose linear inputs it changes.
    slaves : mapping of str to Slave
        By component.

    Attributes
    ----------
    asks_always : bool
        Whether it looks after each exchange, as these neither end for conditions nor follow courses
        by themselves.
    """

    asks_always = False

    def __init__(self, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        self._buses = buses
        self._slaves = slaves
        self._plan: Plan = buses.plan
        self._scenario = buses.plan.scenario
        places = {end.name: place for place, end in enumerate(self._plan.inputs)}
        rows = {int(place): row for row, place in enumerate(buses.linear["place"])}
        self._places = {name: places[name] for name in self._scenario.inputs}
        self._rows = {name: rows[place] for name, place in self._places.items()}
        self._span = (0, 0)
        self._shown = {end.name: place for place, end in enumerate(self._plan.outputs)}

    # ------------------------------------------------------------------ when

    def next(self, exchange: int) -> int:
        """Return the number of exchanges, more than these, after which something is due.

        Until then, the loop has what it needs of the course of inputs.
        """
        buses = self._buses
        buses.conditions["waits"] = waits = buses.fired < 0
        has_course = buses.course_rows.size > 0
        if has_course:
            self._compute_course(exchange)
        if self.asks_always and (has_course or waits.any()):
            self._follow(exchange)
            return exchange + 1
        later = [moment for moment in self._moments() if moment > exchange]
        if has_course:
            buses.course_span[:] = self._span
            later.append(sum(self._span))
        return min(later, default=self._plan.timing.exchanges)

    def _moments(self) -> Iterator[int]:
        yield from (s.exchange for s in self._scenario.switches if s.exchange is not None)
        for fault in self._scenario.faults:
            yield from (fault.begin, fault.stop)

    def _compute_course(self, first: int) -> None:
        """Compute what inputs get at many exchanges from one on, if that has not been done."""
        course = self._buses.course
        if self._span[0] <= first < sum(self._span):
            return
        timing = self._plan.timing
        end = min(first + len(course), timing.exchanges)
        times = timing.moments(range(first, end))
        columns = {name: column for column, name in enumerate(self._scenario.restless)}
        course[:] = np.nan
        for driven in self._scenario.driven:
            values = self._scenario.signals.over(times, driven.name, driven.port.is_held)
            course[: times.size, columns[driven.name], 0] = 0.0
            course[: times.size, columns[driven.name], 1] = values
        for fault in self._scenario.noisy:
            begin, stop = max(first, fault.begin), min(end, fault.stop)
            if begin < stop:
                factor, offset = self._way(fault.end.name)
                rows = course[begin - first : stop - first, columns[fault.end.name]]
                rows[:, 0] = factor
                rows[:, 1] = offset + fault.deviation * noises(fault, begin, stop - begin)
        self._span = (first, end - first)

    def _follow(self, exchange: int) -> None:
        """Change the inputs of the course for one exchange, in the place of the loop."""
        if not self._buses.course_rows.size:
            return
        ways = self._buses.course[exchange - self._span[0]]
        changed = ~np.isnan(ways[:, 0])
        rows = self._buses.course_rows[changed]
        self._buses.linear["factor"][rows] = ways[changed, 0]
        self._buses.linear["offset"][rows] = ways[changed, 1]

    # ------------------------------------------------------------------ what

    def look(self, exchange: int) -> None:
        """Do what is due after this number of exchanges.

        Raises
        ------
        RunFailed
            A component refuses a value.
        """
        time = self._plan.timing.seconds(exchange)
        for switch in self._scenario.switches:
            if switch.exchange == exchange:
                self._set(switch, time)
        self._ask(exchange, time)
        faults = self._scenario.faults
        for fault in faults:
            if fault.stop == exchange:  # another one of this input may begin
                self._deliver(fault.end.name, *self._way(fault.end.name))
        for fault in faults:
            if fault.begin <= exchange < fault.stop:
                self._disturb(fault, exchange)

    def _ask(self, exchange: int, time: float) -> None:
        """Set the values whose conditions have become true."""
        for number, switch in enumerate(self._scenario.conditions):
            condition = switch.condition
            if condition is None or self._buses.fired[number] >= 0:
                continue
            if condition.holds(float(self._buses.outputs[self._shown[condition.end.name]])):
                self._buses.fired[number] = exchange
                self._set(switch, time)

    def _set(self, switch: Switch, time: float) -> None:
        if switch.end.name in self._rows:
            self._deliver(switch.end.name, 0.0, switch.value)
        else:
            slave = self._slaves[switch.end.component]
            set_between_steps(slave, switch.end, switch.value, time)

    def _disturb(self, fault: PlannedFault, exchange: int) -> None:
        name = fault.end.name
        factor, offset = self._way(name)
        if fault.kind == "cut":
            self._deliver(name, 0.0, fault.instead)
        elif fault.kind == "frozen" and fault.begin == exchange:
            source = float(self._buses.outputs[self._plan.source[self._places[name]]])
            self._deliver(name, 0.0, factor * source + offset)

    def _way(self, name: str) -> tuple[float, float]:
        """Return factor and offset of the connection itself."""
        return self._plan.linear[self._places[name]]

    def _deliver(self, name: str, factor: float, offset: float) -> None:
        """Let an input get factor times its source plus offset from the next exchange on.

        If it is extrapolated, its polynomial begins anew.
        """
        row = self._buses.linear[self._rows[name]]
        row["factor"] = factor
        row["offset"] = offset
        polynomials = self._buses.extrapolated
        polynomials["known"][polynomials["place"] == self._places[name]] = 0

    # ------------------------------------------------------------------ told

    @property
    def events(self) -> list[dict[str, object]]:
        """Values that were set on a condition, with the time (s) of each."""
        return [
            {
                "port": switch.end.name,
                "value": switch.value,
                "when": switch.condition.text if switch.condition else "",
                "at": self._plan.timing.seconds(int(exchange)),
            }
            for switch, exchange in zip(self._scenario.conditions, self._buses.fired)
            if exchange >= 0
        ]

    @property
    def warnings(self) -> list[str]:
        """Conditions that have never been true."""
        return [
            f"scenario: {switch.condition.text} was never true, and {switch.end.name} was not set"
            for switch, exchange in zip(self._scenario.conditions, self._buses.fired)
            if exchange < 0 and switch.condition
        ]


def noises(fault: PlannedFault, first: int, count: int) -> NDArray[np.float64]:
    """Return numbers of the standard normal distribution, one for each exchange.

    They follow from the seed, the name of the input and the exchange alone: a run that goes on, and
    one with another fault beside this one, have the same numbers. Philox counts [1]_, and two of
    its numbers make one that is normally distributed [2]_.

    Parameters
    ----------
    fault : PlannedFault
        Whose seed and input count.
    first, count : int
        Number of exchanges before the first one, and how many there are.

    Returns
    -------
    array of float, shape (count,)
        Mean 0, standard deviation 1.

    References
    ----------
    .. [1] Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC 2011.
    .. [2] Box and Muller, A note on the generation of random normal deviates, 1958.
    """
    key = np.array([fault.seed, crc32(fault.end.name.encode())], np.uint64)
    drawn = np.random.Philox(key=key, counter=first).random_raw(_OF_A_COUNT * count)
    pairs = drawn.reshape(count, _OF_A_COUNT)[:, :2].tolist()
    return np.array([_normal(one, other) for one, other in pairs])


def _normal(one: int, other: int) -> float:
    """Return a normally distributed number of two random ones with 64 bits.

    The functions are those for single numbers: those for arrays have other bits on some processors.
    """
    uniform = ((one >> 11) + 1) * 2.0**-53  # above 0, at most 1
    angle = 2.0 * math.pi * (other >> 11) * 2.0**-53
    return math.sqrt(-2.0 * math.log(uniform)) * math.cos(angle)

"""Values that change at one time of a run: what FMI lets a master set between two steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import InputRefused, Problem, RunFailed
from ..fmu.slave import WARNING, Slave, status_name
from ..results.changes import ValueChange
from ..system.names import nearest, split_name
from ..system.plan import End, Plan
from ..system.renaming import present_name
from ..system.timing import exchanges_in
from ..system.values import value_for
from .recording import last_words


@dataclass
class Changing:
    """Sets the values of a change when its time has come.

    Attributes
    ----------
    exchange : int
        Number of exchanges after which they are set.
    at : float
        Their time (s).
    settings : list of (End, float or str)
        The ports and their values.
    last : int
        Number of exchanges of the run.
    slaves : mapping of str to Slave
        Of the run; given before the first exchange.
    """

    exchange: int
    at: float
    settings: list[tuple[End, float | str]]
    last: int
    slaves: Mapping[str, Slave] = field(default_factory=dict)

    def next(self, exchange: int) -> int:
        """Return the number of exchanges after which the values are set, if that is to come."""
        return self.exchange if exchange < self.exchange else self.last

    def look(self, exchange: int) -> None:
        """Set the values if it is time.

        Raises
        ------
        RunFailed
            A component refuses its values.
        """
        if exchange == self.exchange:
            for end, value in self.settings:
                set_between_steps(self.slaves[end.component], end, value, self.at)

    @property
    def in_words(self) -> str:
        """Say what is set, and when."""
        told = [
            f"{end.name} = {value} {end.port.unit_name}".removesuffix(" 1")
            for end, value in self.settings
        ]
        return f"{', '.join(told)} at t = {self.at:.9g} s"


def advice(changes: Sequence[Changing], at: float, otherwise: str) -> str:
    """Say what may be done about values that run away: those that were set before are the cause.

    Parameters
    ----------
    changes : sequence of Changing
        Of the run; without them it is one that comes to its end, or would have failed too.
    at : float
        Time (s) at which values have run away.
    otherwise : str
        What may be done where nothing was set before.
    """
    before = [change.in_words for change in changes if change.at <= at]
    if not before:
        return otherwise
    return (
        f"the likely cause is what was set on the way, {' and '.join(before)}: the state jumps "
        "there; set what is nearer to the value before, or let a scenario change it over time"
    )


def set_between_steps(slave: Slave, end: End, value: float | str, at: float) -> None:
    """Set a variable of a slave between two of its steps.

    Parameters
    ----------
    slave : Slave
        Of the component.
    end : End
        The variable.
    value : float or str
        As the port takes it.
    at : float
        Time (s) reached.

    Raises
    ------
    RunFailed
        The slave refuses the value.
    """
    if isinstance(value, str):
        status = slave.set_text(end.port.reference, value)
    else:
        reference = np.array([end.port.reference], np.uint32)
        status = slave.set(reference, np.array([value]), end.port.type)
    if not 0 <= status <= WARNING:
        what = f"{end.port.name} = {value} is refused ({status_name(status)})"
        raise RunFailed(end.component, at, f"{what}: {last_words(slave)}")


def plan_change(plan: Plan, change: ValueChange) -> Changing:
    """Find the ports and the exchange of a change.

    Parameters
    ----------
    plan : Plan
        Of the run.
    change : ValueChange
        What changes.

    Returns
    -------
    Changing

    Raises
    ------
    InputRefused
        The time is not that of an exchange within the run; variables that there are not, that FMI
        lets nobody set between two steps, or values that do not fit; all at once.
    """
    problems: list[Problem] = []
    number = _exchange(plan, change.at, problems)
    settings = []
    for name, value in change.values.items():
        end = settable_end(plan, name, problems)
        if end is None:
            continue
        try:
            settings.append((end, value_for(end.port, value)))
        except ValueError as error:
            problems.append(Problem(name, f"{value!r}: {error}", "give another value"))
    if problems:
        raise InputRefused(problems)
    return Changing(number, change.at, settings, plan.timing.exchanges)


def _exchange(plan: Plan, at: float, problems: list[Problem]) -> int:
    timing = plan.timing
    number = exchanges_in(timing, at - timing.seconds(0))
    if number is None:
        step = timing.lasts(timing.exchange)
        what = f"{at:g} s is no time of an exchange, which are {step:g} s apart"
        problems.append(Problem("at", what, "give a multiple of that after the start"))
        return 0
    if not 0 <= number < timing.exchanges:
        begin = timing.seconds(0)
        end = timing.seconds(timing.exchanges)
        what = f"{at:g} s does not lie in the run, from {begin:g} s until before {end:g} s"
        problems.append(Problem("at", what, "give a time within it"))
    if plan.iteration is not None and number % plan.schedule.period:
        step = timing.lasts(timing.exchange * plan.schedule.period)
        what = f"{at:g} s lies within a window of {step:g} s, which the implicit master iterates"
        problems.append(Problem("at", what, "give a multiple of that after the start"))
    return number


def settable_end(plan: Plan, name: str, problems: list[Problem]) -> End | None:
    """Return the port of a name that may be set between two steps; else tell why it may not.

    Parameters
    ----------
    plan : Plan
        Of the run.
    name : str
        ``component.variable``.
    problems : list of Problem
        Takes the reason.
    """
    component, key = split_name(name, plan.order)
    if component not in plan.descriptions:
        what = "names no component of the run"
        problems.append(Problem(name, what, nearest(component, plan.order)))
        return None
    ports = plan.descriptions[component].ports
    port = ports.get(present_name(plan.descriptions[component], key))
    if port is None:
        problems.append(Problem(name, "does not exist", nearest(key, ports)))
        return None
    end = End(component, port)
    if reason := _why_fixed(plan, end):
        start = "branch at the start of the run, which takes every parameter; "
        remedy = (start if port.causality == "parameter" else "") + _others(plan, component)
        problems.append(Problem(name, reason, remedy))
        return None
    return end


def _why_fixed(plan: Plan, end: End) -> str:
    """Return why a variable cannot be set between two steps; empty where it can."""
    port = end.port
    if port.shape:
        return "is an element of an array of FMI 3.0, which is set as a whole"
    if port.causality == "input":
        if end.name in {target.name for _, target, _ in plan.fed}:
            return "is an input that a connection feeds"
        return "is an input of the scenario" if end.name in plan.scenario.inputs else ""
    if port.causality != "parameter":
        return f"is no parameter and no input, but {port.causality or 'local'}"
    return "" if port.is_tunable else "is a fixed parameter: FMI sets it before the start alone"


def _others(plan: Plan, component: str) -> str:
    """Say what may be set of a component between two steps."""
    ports = plan.descriptions[component].ports.values()
    free = [port.name for port in ports if not _why_fixed(plan, End(component, port))]
    listed = ", ".join(free[:6]) + (", ..." if len(free) > 6 else "")
    return f"from a later time on, {component} takes {listed or 'nothing'}"

"""From FMU files to slaves that are ready for their first step.

What they refuse is collected from all of them.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from ..errors import ComponentLost, InputRefused, Problem, check_of
from ..fmu.access import read_value
from ..fmu.slave import (
    DISCARD,
    OK,
    WARNING,
    Slave,
    SlaveLost,
    Source,
    status_name,
    times,
    without_name,
    worst,
)
from ..system.limits import MOST_INTERNAL_STEPS
from ..system.loops import told
from ..system.plan import End, Plan
from ..system.schedule import Action
from ..system.system import SystemSpec
from .buses import Buses, unfit_text
from .start_values import set_values

_ROUNDS = 20
"""Most rounds in which outputs are passed on at the start; a chain of components needs one round
for each of them."""

Entering = Callable[[str], None]
"""Called with the name of a component before the component is called."""


class Stages:
    """Two moments of an initialisation at which something may be added to it."""

    def entered(self) -> None:
        """Act when all slaves are in initialisation mode, before anything is passed on."""

    def settled(self, unsettled: str) -> None:
        """Act when outputs have been passed on in that mode.

        Parameters
        ----------
        unsettled : str
            Name of an output that still changes, or nothing.
        """


NO_STAGES = Stages()
"""Adds nothing to an initialisation."""


@contextmanager
def losses_refused(system: SystemSpec) -> Iterator[None]:
    """Refuse a system whose component is lost while it is made ready.

    Parameters
    ----------
    system : SystemSpec
        Names the FMUs and the time at which the run starts.

    Raises
    ------
    ComponentLost
        The process of a slave has ended, or does not return.
    """
    try:
        yield
    except SlaveLost as lost:
        what = f"{lost.what} while it was made ready, at t = {system.start_time:.9g} s"
        remedy = check_of(system.components[lost.name].fmu)
        raise ComponentLost([Problem(lost.name, what, remedy)]) from lost


def instantiate(
    plan: Plan,
    sources: Mapping[str, Source],
    entering: Entering = lambda name: None,
    names: Sequence[str] | None = None,
) -> dict[str, Slave]:
    """Make one slave for each component.

    Parameters
    ----------
    plan : Plan
        Gives the order.
    sources : mapping of str to Source
        Makers of the slaves, by component.
    entering : callable, optional
        Called with the name of each component before its turn.
    names : sequence of str, optional
        Components of which slaves are made, by default all.

    Returns
    -------
    dict of str to Slave

    Raises
    ------
    InputRefused
        The reasons of all that cannot be made.
    """
    slaves: dict[str, Slave] = {}
    problems: list[Problem] = []
    try:
        for name in plan.order if names is None else names:
            entering(name)
            try:
                slaves[name] = sources[name].instantiate(name)
            except InputRefused as refusal:
                problems += refusal.problems
        if problems:
            raise InputRefused(problems)
    except BaseException:
        free(slaves.values())
        raise
    return slaves


def free(slaves: Iterable[Slave]) -> None:
    """Free slaves, in whatever state they are."""
    for slave in slaves:
        slave.free()


def initialise(
    slaves: Mapping[str, Slave],
    buses: Buses,
    allow_unstable: bool = False,
    entering: Entering = lambda name: None,
    stages: Stages = NO_STAGES,
) -> list[str]:
    """Bring slaves to their first step.

    Parameters are set, outputs passed on to inputs in the initialisation mode and after it, and
    steps compared with the largest stable ones.

    Parameters
    ----------
    slaves : mapping of str to Slave
        As :func:`instantiate` made them.
    buses : Buses
        Get the values at the start.
    allow_unstable : bool
        Warn of steps that are too long, and do not refuse them.
    entering : callable, optional
        Called with the name of each component before its turn.
    stages : Stages, optional
        Called in between.

    Returns
    -------
    list of str
        Warnings.

    Raises
    ------
    InputRefused
        A slave refuses its parameters or inputs, or would be unstable.
    """
    plan = buses.plan
    span = (plan.timing.seconds(0), plan.timing.seconds(plan.timing.exchanges))
    _phase(slaves, lambda slave: _begin(plan, slave, *span), entering)
    stages.entered()
    before = _settle(buses, slaves, entering)
    stages.settled(before)
    _phase(slaves, lambda slave: slave.exit_initialisation(), entering)
    unsettled = _settle(buses, slaves, entering) or before
    _refuse_lost(buses)
    warnings = [text for slave in slaves.values() for text in _warnings(slave)]
    if unsettled:
        loops = list(plan.loops_at_start)
        where = f"; the loop at the start does not converge: {told(loops)}" if loops else ""
        warnings.append(
            f"outputs at the start still change after {_ROUNDS} rounds of exchange, "
            f"{unsettled} among them{where}"
        )
    endless = [problem for name in plan.order for problem in _too_many(plan, slaves[name])]
    if endless:
        raise InputRefused(endless)
    unstable = [problem for name in plan.order for problem in _stability(plan, slaves[name])]
    if unstable and not allow_unstable:
        raise InputRefused(unstable)
    return warnings + [str(problem) for problem in unstable]


def _warnings(slave: Slave) -> list[str]:
    name = slave.name
    said = Counter(without_name(name, text) for status, text in slave.messages if status == WARNING)
    return [f"{name}: {text}{times(count)}" for text, count in said.items()]


def _refuse_lost(buses: Buses) -> None:
    """Refuse outputs that are no finite numbers."""
    lost = [buses.not_finite(name) for name in buses.plan.order]
    problems = [
        Problem(end.name, "is no finite number after the initialisation", "check the parameters")
        for end in lost
        if end is not None
    ]
    if problems:
        raise InputRefused(problems)


def _begin(plan: Plan, slave: Slave, start: float, stop: float) -> int:
    status = set_values(slave, plan.descriptions[slave.name], plan.starts[slave.name])
    told = slave.setup_experiment(start, stop, plan.tolerance(slave.name))
    return worst(status, told, slave.enter_initialisation())


def _phase(slaves: Mapping[str, Slave], call: Callable[[Slave], int], entering: Entering) -> None:
    """Do the same with all slaves, then see whether any of them refused."""
    refusals = []
    for slave in slaves.values():
        entering(slave.name)
        said = len(slave.messages)
        status = call(slave)
        refusals += _refusals(slave, status)
        if status == WARNING and len(slave.messages) == said:
            slave.messages.append((WARNING, "returned Warning without a message"))
    if refusals:
        raise InputRefused(_causes(refusals))


class _Refusal(NamedTuple):
    """A refusal of a slave; ``of_inputs``: other inputs may content it at its first step."""

    problem: Problem
    of_inputs: bool


def _refusals(slave: Slave, status: int) -> list[_Refusal]:
    """Return what a slave refused, by its status or by a message with the status Error.

    A message with the status Discard tells that the first step will be refused.
    """
    errors = [(severity, text) for severity, text in slave.messages if severity >= DISCARD]
    if OK <= status <= WARNING and not errors:
        return []
    silence = [(status, f"returned {status_name(status)} without a message")]
    told = errors or slave.messages or silence
    return [
        _Refusal(Problem(slave.name, without_name(slave.name, text)), severity == DISCARD)
        for severity, text in dict.fromkeys(told)
    ]


def _causes(refusals: Sequence[_Refusal]) -> list[Problem]:
    """Return the problems without those that may follow from others.

    A component that refuses its parameters shows no outputs; what others have against their inputs
    is then no reason of its own.
    """
    found = list(dict.fromkeys(refusals))
    causes = [refusal for refusal in found if not refusal.of_inputs]
    return [refusal.problem for refusal in causes or found]


def _settle(buses: Buses, slaves: Mapping[str, Slave], entering: Entering) -> str:
    """Pass outputs on to inputs until they no longer change.

    Those with the fewest inputs come first: what they show is then there for those that need much
    and may take long to compute what follows from it.

    Returns the name of an output that still changes, or nothing.
    """
    outputs = buses.outputs
    turns = sorted(slaves.values(), key=lambda slave: len(buses.needs[slave.name]))
    before = np.full_like(outputs, np.nan)
    texts_before: dict[str, str] = {}
    taken: set[int] = set()
    said: dict[str, int] = {}
    for _ in range(_ROUNDS):
        refusals: list[_Refusal] = []
        for slave in turns:
            entering(slave.name)
            refusals += _pass_on(buses, slave, taken, said)
        if refusals:
            raise InputRefused(_causes(refusals))
        changed = np.flatnonzero((outputs != before) & ~(np.isnan(outputs) & np.isnan(before)))
        if not changed.size and buses.texts.newest == texts_before:
            return ""
        before[:] = outputs
        texts_before = dict(buses.texts.newest)
    return buses.plan.outputs[changed[0]].name if changed.size else "a text"


def _pass_on(buses: Buses, slave: Slave, taken: set[int], said: dict[str, int]) -> list[_Refusal]:
    """Set the inputs of a slave, if all are there, and take its outputs.

    A warning about inputs that are replaced now is forgotten: the slave says it again if it still
    holds. ``taken`` are the places of the outputs that are there, ``said`` counts messages.
    """
    name = slave.name
    refusals: list[_Refusal] = []
    if buses.needs[name] <= taken:
        if name in said and buses.needs[name]:
            _forget_warnings(slave, said[name])
        refusals += _refusals(slave, buses.give(slave))
    said[name] = len(slave.messages)
    status = buses.take(slave)
    unfit = buses.unfit(name, Action.GET) if status > WARNING else None
    refused = _unfit(buses, *unfit) if unfit else _refusals(slave, status)
    if not refused:
        taken |= buses.shows[name]
    return refusals + refused


def _unfit(buses: Buses, end: End, value: float) -> list[_Refusal]:
    """Return the refusal of an output that the bus cannot hold."""
    start = buses.plan.timing.seconds(0)
    what = f"{unfit_text(end, value)}, at t = {start:.9g} s"
    return [_Refusal(Problem(end.component, what, "leave it out of the system"), False)]


def _forget_warnings(slave: Slave, since: int) -> None:
    """Take back the warnings among the messages from number ``since`` on."""
    slave.messages[since:] = [
        message for message in slave.messages[since:] if message[0] != WARNING
    ]


def _too_many(plan: Plan, slave: Slave) -> list[Problem]:
    """Refuse more internal steps in one communication step than a run can wait for."""
    ports = plan.descriptions[slave.name].ports
    used = next((name for name in ("time_step", "internal_step") if name in ports), None)
    step = plan.system.longest_step(slave.name)
    if used is None:
        return []
    length = read_value(slave, ports[used])
    if not 0.0 < length * MOST_INTERNAL_STEPS < step:
        return []
    return [
        Problem(
            f"{slave.name}.{used}",
            f"internal steps of {length:.4g} s are {step / length:.2g} in each communication step "
            f"of {step:g} s, and at most {MOST_INTERNAL_STEPS:,} can be made",
            "reduce the exchange step, or what makes the internal step so short",
        )
    ]


def _stability(plan: Plan, slave: Slave) -> list[Problem]:
    """Compare the component's steps with the largest ones that it publishes."""
    return [
        *_port_stability(plan, slave),
        *_internal_stability(plan, slave),
    ]


def _port_stability(plan: Plan, slave: Slave) -> list[Problem]:
    ports = plan.descriptions[slave.name].ports
    step = plan.system.longest_step(slave.name)
    if "step_limit" not in ports:
        return []
    limit = read_value(slave, ports["step_limit"])
    if step <= limit * (1.0 + 1e-9):
        return []
    return [
        Problem(
            slave.name,
            f"the communication step of {step:.6g} s exceeds step_limit = {limit:.6g} s, the "
            "longest that its ports bear",
            "reduce the exchange step, or use a port of waves",
        )
    ]


def _internal_stability(plan: Plan, slave: Slave) -> list[Problem]:
    ports = plan.descriptions[slave.name].ports
    step = plan.system.longest_step(slave.name)
    if "stable_step" not in ports or "internal_step" not in ports:
        return []
    stable = read_value(slave, ports["stable_step"])
    internal = read_value(slave, ports["internal_step"])
    longest = min(internal, step)
    if "time_step" in ports:
        longest = read_value(slave, ports["time_step"])
    if longest <= stable:
        return []
    return [
        Problem(
            f"{slave.name}.internal_step",
            f"steps of {longest:.6g} s (internal_step {internal:.6g} s, "
            f"communication step {step:.6g} s) exceed stable_step = {stable:.6g} s",
            f"set {slave.name}.internal_step to less than {stable:.3g} s, or allow instability",
        )
    ]

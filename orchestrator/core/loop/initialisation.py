"""From FMU files to slaves that are ready for their first step; what they refuse is collected from all of them."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from ..errors import InputRefused, Problem
from ..fmu.description import Port
from ..fmu.slave import ERROR, STATUS_NAMES, WARNING, Slave, Source, without_name
from ..system.plan import Plan
from .exchange import State

_ROUNDS = 20
"""How often outputs are passed on at the start; a chain of components needs one round for each of them."""


Told = Callable[[str], None]
"""Called with the name of a component before it is called."""


def instantiate(
    plan: Plan, sources: Mapping[str, Source], told: Told = lambda name: None
) -> dict[str, Slave]:
    """One slave for each component.

    Raises:
        InputRefused: the reasons of all that cannot be made.
    """
    slaves: dict[str, Slave] = {}
    problems: list[Problem] = []
    for name in plan.order:
        told(name)
        try:
            slaves[name] = sources[name].instantiate(name)
        except InputRefused as refusal:
            problems += refusal.problems
    if problems:
        free(slaves.values())
        raise InputRefused(problems)
    return slaves


def free(slaves: Iterable[Slave]) -> None:
    """Give back all slaves."""
    for slave in slaves:
        slave.free()


def initialise(
    plan: Plan,
    slaves: Mapping[str, Slave],
    state: State,
    allow_unstable: bool = False,
    told: Told = lambda name: None,
) -> list[str]:
    """Set parameters, pass outputs on to inputs in the initialisation mode and after it, check the steps. Returns warnings.

    Raises:
        InputRefused: a slave refuses its parameters or inputs, or would be unstable.
    """
    timing = plan.timing
    _phase(
        slaves,
        lambda slave: _begin(
            slave, plan.starts[slave.name], timing.seconds(0), timing.seconds(timing.exchanges)
        ),
        told,
    )
    before = _settle(state, slaves, told)
    _phase(slaves, lambda slave: slave.exit_initialisation(), told)
    unsettled = _settle(state, slaves, told) or before
    if bad := [end for name in plan.order if (end := state.not_finite(name)) is not None]:
        raise InputRefused(
            [
                Problem(
                    e.name, "is no finite number after the initialisation", "check the parameters"
                )
                for e in bad
            ]
        )
    warnings = [
        f"{name}: {without_name(name, text)}"
        for name, slave in slaves.items()
        for status, text in slave.messages
        if status == WARNING
    ]
    if unsettled:
        warnings.append(
            f"outputs at the start still change after {_ROUNDS} rounds of exchange, {unsettled} among them"
        )
    unstable = [p for name in plan.order for p in _stability(plan, slaves[name])]
    if unstable and not allow_unstable:
        raise InputRefused(unstable)
    return warnings + [str(problem) for problem in unstable]


def _begin(slave: Slave, starts: list[tuple[Port, float | str]], start: float, stop: float) -> int:
    worst = 0
    for port, value in starts:
        if isinstance(value, str):
            worst = max(worst, slave.set_text(port.reference, value))
        else:
            worst = max(
                worst,
                slave.set(np.array([port.reference], np.uint32), np.array([value]), port.kind),
            )
    return max(worst, slave.setup_experiment(start, stop), slave.enter_initialisation())


def _phase(slaves: Mapping[str, Slave], call: Callable[[Slave], int], told: Told) -> None:
    """Do the same with all slaves, then see whether any of them refused."""
    problems = []
    for slave in slaves.values():
        told(slave.name)
        problems += _refusals(slave, call(slave))
    if problems:
        raise InputRefused(problems)


def _refusals(slave: Slave, status: int) -> list[Problem]:
    """What a slave refused: it says so by its status, or by a message with the status Error."""
    reasons = [text for severity, text in slave.messages if severity >= ERROR]
    if status <= WARNING and not reasons:
        return []
    texts = (
        reasons
        or [text for _, text in slave.messages]
        or [f"returned {STATUS_NAMES[status]} without a message"]
    )
    return [Problem(slave.name, without_name(slave.name, text)) for text in dict.fromkeys(texts)]


def _settle(state: State, slaves: Mapping[str, Slave], told: Told) -> str:
    """Pass outputs on to inputs until they no longer change. Returns the name of one that still does, or nothing.

    Those with the fewest inputs come first: what they show is then there for those that need much and may take long to compute what
    follows from it. A warning about inputs that are then replaced is forgotten: the slave says it again if it still holds.
    """
    outputs, needs = state.outputs, state.needs
    turns = sorted(slaves.values(), key=lambda slave: len(needs[slave.name]))
    before, taken = np.full_like(outputs, np.nan), set[int]()
    said: dict[str, int] = {}
    for _ in range(_ROUNDS):
        problems: list[Problem] = []
        for slave in turns:
            told(slave.name)
            if needs[slave.name] <= taken:
                if slave.name in said and needs[slave.name]:
                    _forget_warnings(slave, said[slave.name])
                problems += _refusals(slave, state.give(slave))
            said[slave.name] = len(slave.messages)
            refused = _refusals(slave, state.take(slave))
            taken |= set() if refused else state.shows[slave.name]
            problems += refused
        if problems:
            raise InputRefused(list(dict.fromkeys(problems)))
        changed = np.flatnonzero((outputs != before) & ~(np.isnan(outputs) & np.isnan(before)))
        if not changed.size:
            return ""
        before[:] = outputs
    return state.plan.outputs[changed[0]].name


def _forget_warnings(slave: Slave, since: int) -> None:
    """Take back the warnings among the messages from number ``since`` on."""
    slave.messages[since:] = [
        message for message in slave.messages[since:] if message[0] != WARNING
    ]


def _stability(plan: Plan, slave: Slave) -> list[Problem]:
    """Whether the component's steps exceed the largest ones that it publishes."""
    ports, communication = plan.descriptions[slave.name].ports, plan.system.step(slave.name)
    found = []
    if "step_limit" in ports and communication > (limit := _value(slave, ports["step_limit"])) * (
        1.0 + 1e-9
    ):
        found.append(
            Problem(
                slave.name,
                f"the communication step of {communication:.6g} s exceeds step_limit = {limit:.6g} s, the "
                "longest that its ports bear",
                "reduce the exchange step, or use a port of waves",
            )
        )
    if "stable_step" not in ports or "internal_step" not in ports:
        return found
    stable, internal = _value(slave, ports["stable_step"]), _value(slave, ports["internal_step"])
    longest = (
        _value(slave, ports["time_step"]) if "time_step" in ports else min(internal, communication)
    )
    if longest <= stable:
        return found
    return [
        *found,
        Problem(
            f"{slave.name}.internal_step",
            f"steps of {longest:.6g} s (internal_step {internal:.6g} s, "
            f"communication step {communication:.6g} s) exceed stable_step = {stable:.6g} s",
            f"set {slave.name}.internal_step to less than {stable:.3g} s, or allow instability",
        ),
    ]


def _value(slave: Slave, port: Port) -> float:
    values = np.zeros(1)
    slave.get(np.array([port.reference], np.uint32), values)
    return float(values[0])

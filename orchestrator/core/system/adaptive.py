"""Adaptive exchange steps: which systems can have them, and the schedules of longer exchanges."""

from collections.abc import Iterator, Mapping, Sequence

from ..errors import Problem
from ..fmu.description import Description
from .adaptivity import Adaptive
from .iterated import iterated_schedule
from .plan import PlannedScenario
from .schedule import Schedule, Scheme, make_schedule
from .system import SystemSpec
from .timing import Timing


def make_schedules(
    system: SystemSpec, order: Sequence[str], timing: Timing, extrapolated: Mapping[str, bool]
) -> tuple[Schedule, ...]:
    """Return the schedules of exchanges of 1, 2, 4, 8, ... exchange steps.

    In longer exchanges, components with a step of their own keep it, and the others make one step.

    Parameters
    ----------
    system : SystemSpec
        Checked.
    order : sequence of str
        Components in the order of their turns.
    timing : Timing
        Of the run.
    extrapolated : mapping of str to bool
        Components that extrapolate, and whether they show outputs after each step.

    Returns
    -------
    tuple of Schedule
        One alone where the system is not adaptive.
    """
    if system.master == "implicit":
        return (iterated_schedule(order, timing.steps, timing.exchange, timing.window),)
    scheme: Scheme = system.master
    made = [make_schedule(order, timing.steps, timing.exchange, scheme, extrapolated)]
    for level in range(1, timing.longest.bit_length()):
        exchange = timing.exchange << level
        own = {
            name: timing.steps[name] if system.components[name].step else exchange for name in order
        }
        made.append(make_schedule(order, own, exchange, scheme, extrapolated))
    return tuple(made)


def adaptive_problems(
    system: SystemSpec, descriptions: Mapping[str, Description], scenario: PlannedScenario
) -> list[Problem]:
    """Return why a system cannot have an adaptive exchange step.

    Parameters
    ----------
    system : SystemSpec
        Whose times fit.
    descriptions : mapping of str to Description
        Of its components.
    scenario : PlannedScenario
        What happens in the run.
    """
    if system.adaptive is None:
        return []
    return [
        *_of_steps(system, descriptions),
        *_of_rows(system),
        *_of_scenario(scenario),
        *_of_energies(system.adaptive, system),
    ]


def _of_steps(system: SystemSpec, descriptions: Mapping[str, Description]) -> Iterator[Problem]:
    for name, spec in system.components.items():
        if spec.step and spec.step > system.exchange_step:
            what = f"{spec.step:g} s is longer than the exchange step, the smallest of [adaptive]"
            remedy = "leave it out: the component then makes one step in each exchange"
            yield Problem(f"{name}.step", what, remedy)
        elif spec.step is None and name in descriptions and not descriptions[name].varies_step:
            what = (
                "its FMU takes steps of one length only (canHandleVariableCommunicationStepSize), "
                "and adaptive exchanges have several"
            )
            remedy = f"give it a step that divides the exchange step: {system.exchange_step:g}"
            yield Problem(f"{name}.step", what, remedy)


def _of_rows(system: SystemSpec) -> Iterator[Problem]:
    if system.output_interval is None:
        what = "is missing: a row at every exchange step leaves no room for longer exchanges"
        yield Problem("output_interval", what, "give it, in s; no exchange reaches beyond a row")


def _of_scenario(scenario: PlannedScenario) -> Iterator[Problem]:
    asks = {
        "inputs over time": bool(scenario.driven),
        "noise": any(fault.kind == "noise" for fault in scenario.faults),
        "a value with a condition": bool(scenario.conditions),
    }
    listed = " and ".join(name for name, is_there in asks.items() if is_there)
    if listed:
        what = f"has {listed}, which needs every exchange, and leaves no room for longer ones"
        yield Problem("scenario", what, "leave [adaptive] out, or give values at times (set, at)")


def _of_energies(adaptive: Adaptive, system: SystemSpec) -> Iterator[Problem]:
    if adaptive.control == "ledger" and not system.bonds:
        what = "is ledger, and the system has no power bonds"
        yield Problem("adaptive.control", what, "declare bonds, or take doubling")

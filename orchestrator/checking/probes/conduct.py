"""Probes of the state machine: calls that FMI does not allow in a state are refused."""

from collections.abc import Callable
from typing import Any

from ..subject.calls import Called
from ..subject.subject import Subject
from ..subject.variables import not_finite
from ..verdicts import Seen, failed, not_applicable, passed


def _refuses(instance: Called, what: str, act: Callable[..., Any], *arguments: Any) -> Seen:
    """Return the verdict on a call that must be refused."""
    if instance.attempt(act, *arguments).refused:
        return passed(f"{what} is refused")
    return failed(
        f"{what} is accepted, which FMI does not allow in this state",
        "return an error: otherwise a mistake of the tool gives results that mean nothing",
    )


def step_first(subject: Subject) -> Seen:
    """Step an instance that is not initialised."""
    instance = subject.instantiate()
    return _refuses(instance, "a step before the initialisation", instance.step, subject.step)


def step_initialising(subject: Subject) -> Seen:
    """Step in the initialisation mode."""
    instance = subject.instantiate()
    instance.enter_initialisation(subject.start, subject.horizon)
    return _refuses(instance, "a step in the initialisation mode", instance.step, subject.step)


def step_terminated(subject: Subject) -> Seen:
    """Step an instance that is terminated."""
    instance = subject.begun()
    instance.step(subject.step)
    instance.terminate()
    return _refuses(instance, "a step after the end", instance.step, subject.step)


def enter_twice(subject: Subject) -> Seen:
    """Enter the initialisation mode of a running instance."""
    instance = subject.begun()
    instance.step(subject.step)
    arguments = () if subject.version == 2 else (False, 0.0, subject.start, False, 0.0)
    what = "entering the initialisation mode while running"
    return _refuses(instance, what, instance.call, "EnterInitializationMode", *arguments)


def exit_first(subject: Subject) -> Seen:
    """Exit the initialisation mode that was not entered."""
    instance = subject.instantiate()
    what = "leaving an initialisation mode that was not entered"
    return _refuses(instance, what, instance.call, "ExitInitializationMode")


def terminate_first(subject: Subject) -> Seen:
    """Terminate an instance that is not initialised."""
    instance = subject.instantiate()
    return _refuses(instance, "terminate before the initialisation", instance.terminate)


def events(subject: Subject) -> Seen:
    """Enter event mode where the FMU has none, or none was asked for."""
    instance = subject.begun()
    what = "event mode, which was not asked for,"
    return _refuses(instance, what, instance.call, "EnterEventMode")


def after_refusal(subject: Subject) -> Seen:
    """Refuse a call, reset, and simulate."""
    instance = subject.begun()
    if not instance.attempt(instance.call, "ExitInitializationMode").refused:
        return not_applicable("no refused call was found")
    instance.reset()
    instance.initialise(subject.start, subject.horizon)
    instance.step(subject.step)
    if not_finite(instance.get(subject.readable)):
        return failed("values are not finite after a reset", "set everything back to its start")
    return passed("simulates after a refused call and a reset")

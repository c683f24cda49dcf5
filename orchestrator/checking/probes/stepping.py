"""Probes of the steps: lengths, gaps, ends."""

import math

from ..subject.calls import CallRefused
from ..subject.motions import course, first_difference
from ..subject.subject import Subject
from ..subject.variables import listed, not_finite
from ..verdicts import Seen, failed, not_applicable, passed, warned

_ODD = (1.0, 1 / 3, 0.7, 1.37, 0.123)
"""Lengths of odd steps, in communication steps."""
_TINY = 1e-6
_LARGE = 100.0


def _fixed(subject: Subject) -> Seen | None:
    """Return that steps of other lengths are not asked of this FMU, if that is so."""
    if subject.can.canHandleVariableCommunicationStepSize:
        return None
    return not_applicable("canHandleVariableCommunicationStepSize is false")


def _limit(subject: Subject) -> float:
    """Return the time (s) that no step may pass."""
    return math.inf if subject.horizon is None else subject.horizon


def odd(subject: Subject) -> Seen:
    """Make steps of odd and changing lengths."""
    if fixed := _fixed(subject):
        return fixed
    instance = subject.begun()
    for part in _ODD:
        step = part * subject.step
        if instance.time + step > _limit(subject) or instance.step(step).terminated:
            break
        if lost := not_finite(instance.get(subject.outputs)):
            return failed(
                f"{listed(lost)} is not finite after a step of {step:g} s",
                "return an error for a step that cannot be made",
            )
    return passed(f"steps of {min(_ODD):g} to {max(_ODD):g} times {subject.step:g} s")


def tiny(subject: Subject) -> Seen:
    """Make steps a million times shorter, and an ordinary one after them."""
    if fixed := _fixed(subject):
        return fixed
    instance = subject.begun()
    for _ in range(3):
        instance.step(_TINY * subject.step)
    if not_finite(instance.get(subject.outputs)):
        return failed("values are not finite after tiny steps", "do not divide by the step")
    return passed(f"steps of {_TINY * subject.step:.3g} s")


def large(subject: Subject) -> Seen:
    """Make a step that is much too long; to refuse it is right as well."""
    if fixed := _fixed(subject):
        return fixed
    instance = subject.begun()
    step = min(_LARGE * subject.step, _limit(subject) - subject.start)
    answer = instance.attempt(instance.step, step)
    if answer.refused:
        return passed(f"a step of {step:g} s is refused")
    if lost := not_finite(instance.get(subject.outputs)):
        return warned(
            f"{listed(lost)} is not finite after a step of {step:g} s that was made",
            "refuse a step that cannot be made, or tell the longest in the documentation",
        )
    return passed(f"a step of {step:g} s is made")


def negative(subject: Subject) -> Seen:
    """Make a step of negative length."""
    return _refused(subject, -subject.step)


def not_a_number(subject: Subject) -> Seen:
    """Make a step whose length is no number."""
    return _refused(subject, math.nan)


def _refused(subject: Subject, step: float) -> Seen:
    instance = subject.begun()
    if instance.attempt(instance.step, step).refused:
        return passed(f"a step of {step:g} s is refused")
    return failed(f"a step of {step:g} s is made", "return an error for a step that is none")


def gap(subject: Subject) -> Seen:
    """Step from a time that the FMU is not at."""
    accepted = []
    for name, shift in (("ahead", 3.0), ("back", -0.5)):
        instance = subject.begun()
        instance.step(subject.step)
        time = instance.time + shift * subject.step
        if not instance.attempt(instance.step, subject.step, time).refused:
            accepted.append(f"{abs(shift):g} steps {name}")
        instance.free()
    if accepted:
        return warned(
            f"gaps in time are accepted: {listed(accepted)}",
            "compare currentCommunicationPoint with the own time, or the result is of another time",
        )
    return passed("a step that does not begin where the last one ended is refused")


def rounding(subject: Subject) -> Seen:
    """Give times as the number of steps times the step, and their neighbours."""
    instance = subject.begun()
    for number in range(1, subject.steps):
        if instance.step(subject.step).terminated:
            break
        time = subject.start + number * subject.step
        aside = math.inf if number % 2 else -math.inf
        instance.time = math.nextafter(time, aside)
    return passed("times that differ in the last bit are taken")


def beyond_stop(subject: Subject) -> Seen:
    """Step past the stop time that was set up."""
    instance = subject.instantiate()
    stop = subject.start + 1.5 * subject.step
    instance.initialise(subject.start, stop)
    if instance.step(subject.step).terminated:
        return not_applicable("it wants to end earlier")
    if instance.attempt(instance.step, subject.step).refused:
        return passed("a step past the stop time is refused")
    return failed(
        "a step past the stop time that was set up is made",
        "return an error: FMI has it so",
    )


def late_start(subject: Subject) -> Seen:
    """Start at another time than the description's."""
    start = subject.start + 1000.0 * subject.step
    instance = subject.instantiate()
    try:
        instance.initialise(start)
        for _ in range(3):
            if instance.step(subject.step).terminated:
                break
    except CallRefused as refused:
        return warned(
            f"does not run from t = {start:g} s: {refused}",
            "take the start time that is set up, or say in the documentation which one it has",
        )
    return passed(f"runs from t = {start:g} s too")


def split(subject: Subject) -> Seen:
    """Tell whether the result depends on how a time is divided into steps."""
    if fixed := _fixed(subject):
        return fixed
    whole = course(subject, subject.begun("whole"), 1)
    if subject.can.canBeInstantiatedOnlyOncePerProcess:
        return not_applicable("there may be one instance only, says the description")
    halves = subject.begun("halves")
    course(subject, halves, 0)
    halves.step(subject.step / 2)
    halves.step(subject.step / 2)
    after = course(subject, halves, 0)
    if first_difference(whole[-1:], after):
        return passed("two half steps give another result than one: the step is part of the model")
    return passed("two half steps give the bits of one")


def early_return(subject: Subject) -> Seen:
    """Let steps end early, go on from there, and compare the end with steps that do not."""
    if not subject.can.mightReturnEarlyFromDoStep:
        return not_applicable("mightReturnEarlyFromDoStep is false")
    instance = subject.begun("early", early=True)
    early = 0
    end = subject.start
    for number in range(1, subject.steps + 1):
        end = subject.start + number * subject.step
        while end - instance.time > 1e-9 * subject.step:
            before = instance.time
            done = instance.step(end - instance.time)
            early += done.early
            if done.terminated:
                return passed(f"{early} of the steps ended early, and it wants to end")
            if not before < instance.time <= end + 1e-9 * subject.step:
                return failed(
                    f"a step from {before:g} s to {end:g} s ends at {instance.time:g} s",
                    "let lastSuccessfulTime lie inside the step and go forward",
                )
    return passed(f"{early} steps ended early, and the rest of each could be made")


def event_mode(subject: Subject) -> Seen:
    """Simulate with event mode and early return."""
    if not subject.can.hasEventMode:
        return not_applicable("hasEventMode is false")
    instance = subject.begun("events", events=True, early=True)
    for _ in range(subject.steps):
        if instance.step(subject.step).terminated:
            break
    if lost := not_finite(instance.get(subject.outputs)):
        return failed(f"{listed(lost)} is not finite", "return an error instead")
    return passed("simulates with event mode")

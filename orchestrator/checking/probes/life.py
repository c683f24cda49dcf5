"""Probes of the life of instances: made, used, reset, freed, beside one another."""

import gc
import json
import sys
import time
from itertools import pairwise
from pathlib import Path

from ..subject.motions import OutputCourse, course, first_difference, perturbed
from ..subject.subject import Subject
from ..subject.variables import listed, not_finite
from ..verdicts import Seen, failed, not_applicable, passed, warned

_NOTED = "course.json"
_LIVES = 3
_WARM_UP = 20
"""Lives after which memory is looked at: what is kept once is kept by then."""
_MOST_LIVES = 200
_LONGEST = 2.0
"""Time (s) for lives in which memory is looked at."""
_LEAK = 4096
"""Bytes per life, a page of memory, that are no leak: a Python inside an FMU leaves some behind."""


def simulation(subject: Subject) -> Seen:
    """Simulate from begin to end with the start values."""
    instance = subject.begun()
    wants_end = False
    made = 0
    while made < subject.steps and not wants_end:
        wants_end = instance.step(subject.step).terminated
        made += 1
        if lost := not_finite(instance.get(subject.readable)):
            return failed(
                f"{listed(lost)} is not finite after step {made}",
                "return an error instead, with a message",
            )
    instance.terminate()
    instance.get(subject.readable)
    instance.free()
    ends = ", where it wants to end" if wants_end else ""
    return passed(f"{made} steps of {subject.step:g} s{ends}, all values finite")


def _simulated(subject: Subject) -> OutputCourse:
    """Return the course of a whole life."""
    instance = subject.begun()
    rows = course(subject, instance, variables=subject.readable)
    instance.terminate()
    instance.free()
    return rows


def noted(subject: Subject) -> None:
    """Simulate and write the course down."""
    (subject.shared / _NOTED).write_text(json.dumps(_simulated(subject)), "utf-8")


def repeated(subject: Subject) -> Seen:
    """Simulate in another process and compare."""
    rows = json.loads((subject.shared / _NOTED).read_text("utf-8"))
    before = [{name: tuple(values) for name, values in row.items()} for row in rows]
    if difference := first_difference(before, _simulated(subject)):
        return warned(
            f"another process gives another result: {difference}",
            "take no random numbers, times or addresses into the result",
        )
    return passed("every bit is the same in two processes")


def again(subject: Subject) -> Seen:
    """Live several times in one process, and compare."""
    first = _simulated(subject)
    for life in range(2, _LIVES + 1):
        if difference := first_difference(first, _simulated(subject)):
            return failed(
                f"life {life} in one process gives another result: {difference}",
                "keep nothing in variables that all instances share",
            )
    return passed(f"{_LIVES} lives one after the other give the same bits")


def reset(subject: Subject) -> Seen:
    """Simulate, reset, simulate with other inputs, reset, and compare with the first time."""
    instance = subject.begun()
    fresh = course(subject, instance, variables=subject.readable)
    instance.reset()
    perturbed(subject, instance)
    instance.initialise(subject.start, subject.horizon)
    instance.attempt(instance.step, subject.step)  # may be refused with those inputs
    instance.reset()
    instance.initialise(subject.start, subject.horizon)
    after = course(subject, instance, variables=subject.readable)
    if difference := first_difference(fresh, after):
        return failed(
            f"after a reset {difference}",
            "set everything back to its start value: parameters, inputs, states, time",
        )
    return passed("a reset instance gives the bits of a new one")


def two(subject: Subject) -> Seen:
    """Step two instances in turn, one of them with other inputs, and compare with one alone."""
    if subject.can.canBeInstantiatedOnlyOncePerProcess:
        return not_applicable("there may be one instance only, says the description")
    alone = course(subject, subject.begun("alone"))
    one = subject.begun("one")
    other = subject.instantiate("other")
    perturbed(subject, other)
    other.initialise(subject.start, subject.horizon)
    rows = course(subject, one, 0)
    goes_on = True
    for _ in range(len(alone) - 1):
        goes_on = goes_on and not other.attempt(other.step, subject.step).refused
        rows += course(subject, one, 1)[1:]
    other.free()
    if difference := first_difference(alone, rows):
        return failed(
            f"beside a second instance {difference}",
            "keep the state in the instance, or declare canBeInstantiatedOnlyOncePerProcess",
        )
    one.terminate()
    one.free()
    return passed("two instances in turn give the bits of one alone")


def freed_early(subject: Subject) -> Seen:
    """Free instances in every phase of their life."""
    subject.instantiate("only made").free()
    inside = subject.instantiate("initialising")
    inside.enter_initialisation(subject.start, subject.horizon)
    inside.free()
    running = subject.begun("running")
    running.step(subject.step)
    running.free()
    instance = subject.begun("the next one")
    instance.step(subject.step)
    instance.free()
    return passed("freed after the instantiation, while initialising and while running")


def _used_memory() -> int:
    """Return the bytes of this process that are in memory, without garbage of Python."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096


def _lived(subject: Subject) -> None:
    instance = subject.begun()
    instance.step(subject.step)
    instance.terminate()
    instance.free()


def memory(subject: Subject) -> Seen:
    """Live many times and look whether the memory grows with each life."""
    if not sys.platform.startswith("linux"):
        return not_applicable("memory is looked at under Linux alone")
    begin = time.monotonic()
    lives = 0
    while lives < _WARM_UP and time.monotonic() - begin < _LONGEST:
        _lived(subject)
        lives += 1
    used = [_used_memory()]
    begin = time.monotonic()
    for _ in range(2):
        lives = 0
        while lives < _MOST_LIVES // 2 and time.monotonic() - begin < _LONGEST:
            _lived(subject)
            lives += 1
        used.append(_used_memory())
    if lives < _WARM_UP:
        return not_applicable("a life takes too long to look at many")
    grown = [later - earlier for earlier, later in pairwise(used)]
    if min(grown) > lives * _LEAK:
        return warned(
            f"each life leaves {min(grown) / lives / 1024:.1f} KiB behind",
            "free everything when the instance is freed",
        )
    return passed("the memory does not grow with the number of lives")

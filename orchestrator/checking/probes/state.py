"""Probes of the complete state: back to it, in other instances and processes, damaged."""

import json

from ..subject.calls import Called
from ..subject.motions import OutputCourse, course, first_difference, perturbed
from ..subject.subject import Subject
from ..verdicts import Seen, failed, not_applicable, passed, warned

_BYTES = "state.bin"
_COURSE = "course.json"
_BEFORE = 3
"""Steps before a state is taken."""
_AFTER = 5
"""Steps that are compared."""
_PLACES = 25
"""Bytes that are damaged, one at a time, spread over the state."""


def _no_state(subject: Subject, serialized: bool = False) -> Seen | None:
    """Return that there is no state to look at, if the description says so."""
    if not subject.can.canGetAndSetFMUstate:
        return not_applicable("canGetAndSetFMUState is false")
    if serialized and not subject.can.canSerializeFMUstate:
        return not_applicable("canSerializeFMUState is false")
    return None


def _on_its_way(subject: Subject, name: str = "instance") -> Called:
    """Return an instance after some steps."""
    instance = subject.begun(name)
    for _ in range(_BEFORE):
        instance.step(subject.step)
    return instance


def _everything(subject: Subject, instance: Called, time: float) -> OutputCourse:
    """Return the course of all variables from a time on."""
    instance.time = time
    return course(subject, instance, _AFTER, subject.readable)


_REMEDY = "put everything that the next step needs into the state: time, inputs, memory of solvers"


def rollback(subject: Subject) -> Seen:
    """Take a state, go on with other inputs, go back, and go on as before."""
    if nothing := _no_state(subject):
        return nothing
    instance = _on_its_way(subject)
    time = instance.time
    state = instance.state()
    first = _everything(subject, instance, time)
    perturbed(subject, instance)
    instance.attempt(instance.step, subject.step)  # may be refused with those inputs
    for number in ("first", "second"):
        instance.restore(state)
        if difference := first_difference(first, _everything(subject, instance, time)):
            return failed(f"after the {number} rollback {difference}", _REMEDY)
    instance.free_state(state)
    instance.terminate()
    instance.free()
    return passed(f"{_AFTER} steps after a rollback are the same bit for bit, twice")


def initialising(subject: Subject) -> Seen:
    """Take a state while initialising, and go back to it from a running instance."""
    if nothing := _no_state(subject):
        return nothing
    instance = subject.instantiate()
    instance.enter_initialisation(subject.start, subject.horizon)
    state = instance.state()
    instance.exit_initialisation()
    first = _everything(subject, instance, subject.start)
    instance.restore(state)
    instance.exit_initialisation()
    if difference := first_difference(first, _everything(subject, instance, subject.start)):
        return failed(f"after going back to the initialisation {difference}", _REMEDY)
    return passed("a state of the initialisation mode leads to the same bits")


def kept(subject: Subject) -> Seen:
    """Take a state twice into the same place, step, and look whether it stays."""
    if nothing := _no_state(subject):
        return nothing
    instance = _on_its_way(subject)
    state = instance.state()
    first = _everything(subject, instance, instance.time)
    again = instance.state()
    instance.step(subject.step)
    instance.state(again)
    instance.free_state(again)
    instance.restore(state)
    time = subject.start + _BEFORE * subject.step
    if difference := first_difference(first, _everything(subject, instance, time)):
        return failed(f"after another state was taken {difference}", "keep each state by itself")
    instance.free_state(state)
    return passed("a state stays what it was while steps and other states follow")


def _handed_over(subject: Subject) -> tuple[bytes, OutputCourse]:
    """Return a serialized state and the course from it on."""
    instance = _on_its_way(subject)
    state = instance.state()
    content = instance.serialize(state)
    rows = _everything(subject, instance, instance.time)
    instance.free_state(state)
    instance.free()
    return content, rows


def _taken_over(subject: Subject, content: bytes) -> OutputCourse:
    """Return the course of a new instance from a serialized state on."""
    instance = subject.begun("another")
    state = instance.deserialize(content)
    instance.restore(state)
    instance.free_state(state)
    return _everything(subject, instance, subject.start + _BEFORE * subject.step)


def other_instance(subject: Subject) -> Seen:
    """Go on from a serialized state in another instance."""
    if nothing := _no_state(subject, serialized=True):
        return nothing
    content, first = _handed_over(subject)
    if difference := first_difference(first, _taken_over(subject, content)):
        return failed(f"in another instance {difference}", _REMEDY)
    return passed(f"a serialized state ({len(content):,} bytes) leads on in another instance")


def saved(subject: Subject) -> Seen | None:
    """Write a serialized state and the course from it on into files."""
    if nothing := _no_state(subject, serialized=True):
        return nothing
    content, rows = _handed_over(subject)
    (subject.shared / _BYTES).write_bytes(content)
    (subject.shared / _COURSE).write_text(json.dumps(rows), "utf-8")
    return None


def continued(subject: Subject) -> Seen:
    """Go on from a serialized state in another process."""
    content = (subject.shared / _BYTES).read_bytes()
    rows = json.loads((subject.shared / _COURSE).read_text("utf-8"))
    first = [{name: tuple(values) for name, values in row.items()} for row in rows]
    if difference := first_difference(first, _taken_over(subject, content)):
        return failed(f"in another process {difference}", "serialize no addresses; " + _REMEDY)
    return passed("a serialized state leads on in another process, bit for bit")


def damaged(subject: Subject) -> Seen:
    """Take over serialized states in which a byte has changed."""
    if nothing := _no_state(subject, serialized=True):
        return nothing
    content, _ = _handed_over(subject)
    taken = 0
    places = sorted({number * (len(content) - 1) // _PLACES for number in range(_PLACES + 1)})
    for place in places:
        broken = bytearray(content)
        broken[place] ^= 0xFF
        taken += _accepts(subject, bytes(broken))
    if taken:
        return warned(
            f"{taken} of {len(places)} states with a damaged byte are taken over without error",
            "put a checksum into the bytes",
        )
    return passed(f"{len(places)} states with a damaged byte are refused")


def shortened(subject: Subject) -> Seen:
    """Take over serialized states of which bytes are missing, and bytes that are none."""
    if nothing := _no_state(subject, serialized=True):
        return nothing
    content, _ = _handed_over(subject)
    tried = {
        "no bytes": b"",
        "the first byte": content[:1],
        "half of the bytes": content[: len(content) // 2],
        "all but the last byte": content[:-1],
        "zeros": bytes(len(content)),
    }
    taken = [name for name, broken in tried.items() if _accepts(subject, broken)]
    if taken:
        return warned(
            f"{', '.join(taken)}: taken over without error as a state",
            "compare the number of bytes, and put a mark and a checksum into them",
        )
    return passed("bytes that are missing are noticed")


def _accepts(subject: Subject, content: bytes) -> bool:
    """Tell whether an instance takes bytes over and steps on without error."""
    instance = subject.begun()
    found = []

    def take_over() -> None:
        found.append(instance.deserialize(content))
        instance.restore(found[0])

    accepted = not instance.attempt(take_over).refused
    if accepted:
        instance.time = subject.start + _BEFORE * subject.step
        instance.attempt(instance.step, subject.step)
    instance.free()
    return accepted

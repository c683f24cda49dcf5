"""Probes of the dependencies that a description declares: what follows what at once."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from ...core.errors import counted
from ...core.fmu.slave import WARNING
from ..subject.calls import Called, CallRefused
from ..subject.subject import Subject
from ..subject.variables import Declared, differing, listed
from ..verdicts import Seen, failed, not_applicable, passed

_LONGEST = 5.0
"""Time (s) for the search."""
_NOTHING = "none declares dependencies: each may depend on everything"


def of_outputs(subject: Subject) -> Seen:
    """Change one input after the other while running, and look which outputs follow at once."""
    declared = _declared(subject.model.outputs)
    if not declared:
        return not_applicable(_NOTHING)
    instance = subject.begun()
    instance.step(subject.step)
    return _searched(subject, instance, subject.inputs(), declared)


def of_unknowns(subject: Subject) -> Seen:
    """Change parameters and inputs while initialising, and look which unknowns follow."""
    declared = _declared(subject.model.initialUnknowns)
    if not declared:
        return not_applicable(_NOTHING)
    instance = subject.instantiate()
    instance.enter_initialisation(subject.start, subject.horizon)
    known = [v for v in subject.readable if v.causality in ("parameter", "input")]
    return _searched(subject, instance, known, declared)


def _declared(unknowns: Sequence[Any]) -> dict[str, set[str]]:
    """Return the names that each unknown depends on, of those that tell."""
    return {
        unknown.variable.name: {its.name for its in unknown.dependencies}
        for unknown in unknowns
        if unknown.dependencies is not None
    }


def _searched(
    subject: Subject,
    instance: Called,
    known: Sequence[Declared],
    declared: Mapping[str, set[str]],
) -> Seen:
    watched = [v for v in subject.readable if v.name in declared]
    begin = time.monotonic()
    looked = 0
    for variable in known:
        if time.monotonic() - begin > _LONGEST:
            break
        moved = _moved_by(instance, variable, watched)
        looked += moved is not None
        hidden = [name for name in moved or () if variable.name not in declared[name] | {name}]
        if hidden:
            return failed(
                f"{listed(hidden)} follows {variable.name} at once, and does not declare it",
                "declare the dependency: tools order their calls by it, and find loops",
            )
    return passed(f"{counted(looked, 'variable')} changed, and nothing follows undeclared")


def _moved_by(
    instance: Called, variable: Declared, watched: Sequence[Declared]
) -> list[str] | None:
    """Return what a change of a variable moves; None where it cannot be changed, or is doubted."""
    values = variable.other_start()
    if values is None or variable.kind == "Binary":
        return None
    (own,) = instance.get([variable]).values()
    before = instance.get(watched)
    said = len(instance.messages)
    try:
        instance.set(variable, values)
        after = instance.get(watched)
        instance.set(variable, own)
    except CallRefused:
        return None
    if any(message.status >= WARNING for message in instance.messages[said:]):
        return None
    return differing(before, after)

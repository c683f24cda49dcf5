"""Probes of the experiments that an FMU carries with it (FMI-LS-REF, MA-HS-Experiments)."""

from dataclasses import replace
from pathlib import Path

from ...platforms import this_machine
from ..experiments.manifest import (
    FOLDER,
    MANIFEST,
    SMOKE,
    STATE,
    Related,
    Remarks,
    Untrue,
    read_manifest,
    setups,
    states_for,
)
from ..experiments.running import Compared, compared, state_difference
from ..subject.calls import CallRefused, NoInstance
from ..subject.subject import Subject
from ..subject.variables import listed
from ..verdicts import Seen, failed, not_applicable, passed, warned

_NONE = "the FMU carries no experiments"
_TOLD_BY_MANIFEST = "see experiments/manifest"


def manifest(subject: Subject) -> Seen:
    """Read the manifest and the files that it names."""
    if not (subject.folder / FOLDER / MANIFEST).is_file():
        return not_applicable(_NONE)
    said = Remarks()
    try:
        related = read_manifest(subject.folder, said)
        found = setups(subject.folder, related, said)
    except Untrue as untrue:
        return failed(str(untrue), "correct the manifest")
    if said.untrue:
        what = listed([*said.untrue, *said.departures], 3)
        return failed(what, "correct the manifest, or pack what it names")
    if said.departures:
        return warned(listed(said.departures, 3), "keep to the schema of the layered standard")
    return passed(f"{len(related)} files, {len(found)} experiments, all of them there")


def smoke_test(subject: Subject) -> Seen:
    """Carry out the smoke tests."""
    return _carried_out(subject, SMOKE)


def validation(subject: Subject) -> Seen:
    """Carry out the experiments that validate the model."""
    return _carried_out(subject, "validation")


def uncertainty(subject: Subject) -> Seen:
    """Carry out the experiments of the analysis of uncertainty."""
    return _carried_out(subject, "uncertainty-analysis")


def _carried_out(subject: Subject, purpose: str) -> Seen:
    if not (subject.folder / FOLDER / MANIFEST).is_file():
        return not_applicable(_NONE)
    try:
        related = read_manifest(subject.folder, Remarks())
        found = setups(subject.folder, related, Remarks())
    except Untrue:
        return not_applicable(_TOLD_BY_MANIFEST)
    usable = _states_taken(subject, related)
    chosen = [
        setup if setup.state in usable else replace(setup, state=None)
        for setup in found
        if setup.purpose == purpose
    ]
    if not chosen:
        return not_applicable("there are none of this purpose")
    outcomes = [compared(subject, setup) for setup in chosen]
    bad = [each for each in outcomes if not each.worst <= 1.0]
    if not bad:
        return passed(f"{len(outcomes)} of {len(outcomes)}; {_told(_worst(outcomes))}")
    what = f"{len(outcomes) - len(bad)} of {len(outcomes)}; {'; '.join(map(_told, bad))}"
    if all(not each.told for each in bad):
        return warned(what, "tell the tolerance of each experiment")
    return failed(what, "correct the model, or the experiment")


def _states_taken(subject: Subject, related: list[Related]) -> set[Path | None]:
    """Return the states that experiments begin with here; others begin with their parameters."""
    if not subject.can.canSerializeFMUstate:
        return set()
    return {e.file for e in states_for(related, _platforms(subject)) if not e.damage}


def _worst(outcomes: list[Compared]) -> Compared:
    return max(outcomes, key=lambda outcome: outcome.worst)


def _told(outcome: Compared) -> str:
    if outcome.refused:
        return f"{outcome.name}: {outcome.refused}"
    untold = "" if outcome.told else ", as none is told"
    return (
        f"{outcome.name}: {outcome.variable} deviates by {outcome.deviation:.3g}, allowed is "
        f"{outcome.tolerance:.3g}{untold}"
    )


def state(subject: Subject) -> Seen:
    """Go to the states that the FMU carries for this machine, and carry experiments out from them.

    An experiment gives the bits from its state that it gives from its parameters.
    """
    if not (subject.folder / FOLDER / MANIFEST).is_file():
        return not_applicable(_NONE)
    try:
        related = read_manifest(subject.folder, Remarks())
    except Untrue:
        return not_applicable(_TOLD_BY_MANIFEST)
    states = [entry for entry in related if entry.role.partition("/")[0] == STATE]
    if not states:
        return not_applicable("the FMU carries no serialized states")
    found = states_for(related, _platforms(subject))
    if not found:
        others = ", ".join(sorted({entry.role.partition("/")[2] for entry in states}))
        return not_applicable(f"its states are for {others}; this machine is {subject.platform3}")
    return _taken(subject, related, found)


def _platforms(subject: Subject) -> tuple[str, ...]:
    """Return the names of this machine's platform, those of the FMU's version of FMI first."""
    names = (this_machine().in_fmi2, subject.platform3)
    return names if subject.version == 2 else names[::-1]


def _taken(subject: Subject, related: list[Related], states: list[Related]) -> Seen:
    """Take states, and compare the experiments that begin with them."""
    if not subject.can.canSerializeFMUstate:
        return failed("its description says that states cannot be serialized", "say that they can")
    for entry in states:
        instance = subject.instantiate()
        try:
            instance.restore(instance.deserialize(entry.content()))
        except Untrue as untrue:
            return failed(str(untrue), "pack the state that was serialized")
        except CallRefused as refused:
            return failed(f"{entry.source}: {refused}", "serialize it anew with this build")
        instance.get(subject.readable)
    files = {entry.file for entry in states}
    begun = [
        setup
        for setup in setups(subject.folder, related, Remarks())
        if setup.state in files and setup.parameters
    ]
    try:
        apart = [said for setup in begun if (said := state_difference(subject, setup))]
    except (Untrue, CallRefused, NoInstance) as error:
        return failed(str(error), "correct the experiment, or its state")
    if apart:
        return failed(apart[0], "serialize the state anew, with the parameters of the experiment")
    same = ", ".join(setup.name for setup in begun)
    return passed(f"{len(states)} taken{f'; {same}: the bits of its parameters' if same else ''}")

"""Probes of the experiments that an FMU carries with it (FMI-LS-REF, MA-HS-Experiments)."""

from ..experiments.manifest import FOLDER, MANIFEST, SMOKE, Remarks, Untrue, read_manifest, setups
from ..experiments.running import Compared, compared
from ..subject.calls import CallRefused
from ..subject.subject import Subject
from ..subject.variables import listed
from ..verdicts import Seen, failed, not_applicable, passed, warned

_STATE = "serialized-state"
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
        found = setups(subject.folder, read_manifest(subject.folder, Remarks()), Remarks())
    except Untrue:
        return not_applicable(_TOLD_BY_MANIFEST)
    chosen = [setup for setup in found if setup.purpose == purpose]
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
    """Go to the states that the FMU carries for this machine."""
    if not (subject.folder / FOLDER / MANIFEST).is_file():
        return not_applicable(_NONE)
    try:
        related = read_manifest(subject.folder, Remarks())
    except Untrue:
        return not_applicable(_TOLD_BY_MANIFEST)
    roles = (_STATE, f"{_STATE}/{subject.library.parent.name}", f"{_STATE}/{subject.platform3}")
    found = [each for each in related if each.role in roles and each.file is not None]
    if not found:
        return not_applicable("there is no serialized state for this machine")
    for each in found:
        assert each.file is not None
        instance = subject.begun()
        try:
            instance.restore(instance.deserialize(each.file.read_bytes()))
        except CallRefused as refused:
            return failed(f"{each.source}: {refused}", "serialize it anew with this build")
        instance.get(subject.readable)
    return passed(f"{len(found)} taken")

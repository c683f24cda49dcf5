"""The table of probes: all that a check looks at, in its order."""

from collections.abc import Callable
from dataclasses import dataclass

from .probes import (
    archive,
    conduct,
    dependencies,
    derivatives,
    description,
    environment,
    experiments,
    library,
    life,
    state,
    stepping,
    units,
    values,
)
from .subject.subject import Subject
from .verdicts import Seen

ProbeStage = Callable[[Subject], Seen | None]
"""One process of a probe; the last one has the verdict."""

LOADS = "library/loads"
"""Probe without which nothing can be called."""
RUNS = "life/simulation"
"""Probe without which nothing can be said about motions and states."""


@dataclass(frozen=True)
class Probe:
    """One thing that is looked at.

    Attributes
    ----------
    name : str
        Theme and name: ``state/rollback``.
    about : str
        The thing, in words.
    stages : tuple of callable
        Each runs in a process of its own, one after the other.
    needs : str
        Probe that must not have failed; empty if there is none.
    version : int
        Major version of FMI that has such a thing; 0 for all.
    """

    name: str
    about: str
    stages: tuple[ProbeStage, ...]
    needs: str = RUNS
    version: int = 0

    @property
    def theme(self) -> str:
        """Part of the name before the slash."""
        return self.name.partition("/")[0]


def _probe(
    name: str, about: str, *stages: ProbeStage, needs: str = RUNS, version: int = 0
) -> Probe:
    return Probe(name, about, stages, needs, version)


SAFE = "archive/names"
"""Probe without which nothing is unpacked."""
READS = "description/readable"
"""Probe without which nobody knows the variables."""

MANIFEST = "experiments/manifest"
"""Probe of the manifest of FMI-LS-REF."""

PROBES = (
    _probe(SAFE, "names of members stay inside the FMU", archive.names, needs=""),
    _probe("archive/size", "number and size of members", archive.size, needs=""),
    _probe("description/schema", "the XML schemas of FMI", description.schema, needs=SAFE),
    _probe(READS, "a description that can be understood", description.readable, needs=SAFE),
    _probe("description/structure", "rules of FMI beyond them", description.structure, needs=READS),
    _probe("description/units", "meaning of the units", units.units, needs=READS),
    _probe("description/ranges", "start values in their ranges", description.ranges, needs=READS),
    _probe("archive/layout", "files where FMI has them", archive.layout, needs=READS),
    _probe(LOADS, "library and functions", library.loads, needs=READS),
    _probe("library/version", "version and platform told", library.version, needs=LOADS),
    _probe("library/token", "a wrong GUID or token is refused", library.token, needs=LOADS),
    _probe("library/spaces", "a folder with spaces", library.spaces, needs=LOADS),
    _probe("library/letters", "a folder with other letters", library.letters, needs=LOADS),
    _probe("library/name", "odd names of instances", library.odd_name, needs=LOADS),
    _probe(RUNS, "a simulation from begin to end", life.simulation, needs=LOADS),
    _probe("life/repetition", "the same in another process", life.noted, life.repeated),
    _probe("life/again", "several lives in one process", life.again),
    _probe("life/reset", "reset leads back to the start", life.reset),
    _probe("life/two", "two instances do not touch each other", life.two),
    _probe("life/early-end", "an instance may be freed at any time", life.freed_early),
    _probe("life/memory", "memory is given back", life.memory),
    _probe("conduct/step-first", "no step before the initialisation", conduct.step_first),
    _probe("conduct/step-initialising", "no step inside it", conduct.step_initialising),
    _probe("conduct/step-terminated", "no step after the end", conduct.step_terminated),
    _probe("conduct/enter-twice", "no second initialisation", conduct.enter_twice),
    _probe("conduct/exit-first", "no exit of a mode not entered", conduct.exit_first),
    _probe("conduct/terminate-first", "no end before the begin", conduct.terminate_first),
    _probe("conduct/events", "no event mode that is not there", conduct.events, version=3),
    _probe("conduct/after-refusal", "a reset mends what was refused", conduct.after_refusal),
    _probe("values/starts", "start values are true", values.starts),
    _probe("values/read-back", "what is set is read", values.read_back),
    _probe("values/order", "any order of references", values.order),
    _probe("values/unknown", "unknown references are refused", values.unknown),
    _probe("values/other-type", "calls of another type are refused", values.other_type),
    _probe("values/read-only", "outputs and constants are not set", values.read_only),
    _probe("values/fixed", "fixed parameters stay fixed", values.fixed),
    _probe("values/not-finite", "NaN and infinity", values.not_finite_inputs),
    _probe("values/range", "values beyond the declared range", values.out_of_range),
    _probe("values/length", "a wrong number of values is refused", values.length, version=3),
    _probe("values/dependencies", "declared dependencies of outputs", dependencies.of_outputs),
    _probe("values/initial", "declared dependencies at the start", dependencies.of_unknowns),
    _probe("stepping/odd", "steps of odd lengths", stepping.odd),
    _probe("stepping/tiny", "tiny steps", stepping.tiny),
    _probe("stepping/large", "a large step", stepping.large),
    _probe("stepping/negative", "a step backwards is refused", stepping.negative),
    _probe("stepping/nan", "a step of NaN is refused", stepping.not_a_number),
    _probe("stepping/gap", "gaps in time", stepping.gap),
    _probe("stepping/rounding", "times with rounding errors", stepping.rounding),
    _probe("stepping/stop", "no step beyond the stop time", stepping.beyond_stop),
    _probe("stepping/late-start", "a start at another time", stepping.late_start),
    _probe("stepping/split", "the same time in other steps", stepping.split),
    _probe("stepping/early-return", "steps that end early", stepping.early_return, version=3),
    _probe("stepping/event-mode", "event mode", stepping.event_mode, version=3),
    _probe("derivatives/running", "derivatives after a step", derivatives.running),
    _probe("derivatives/initial", "derivatives at the start", derivatives.initialising),
    _probe("derivatives/undeclared", "none by what is not declared", derivatives.undeclared),
    _probe("derivatives/linear", "several seeds at once", derivatives.linear),
    _probe("derivatives/adjoint", "adjoint ones, the transpose", derivatives.adjoint, version=3),
    _probe("derivatives/unchanged", "asking changes nothing", derivatives.unchanged),
    _probe("state/rollback", "back to a state, bit for bit", state.rollback),
    _probe("state/initialising", "a state of the initialisation", state.initialising),
    _probe("state/kept", "a state stays what it was", state.kept),
    _probe("state/other-instance", "a state in another instance", state.other_instance),
    _probe("state/other-process", "a state in another process", state.saved, state.continued),
    _probe("state/damaged", "damaged bytes", state.damaged),
    _probe("state/shortened", "bytes that are missing", state.shortened),
    _probe("environment/printing", "nothing is printed", environment.printing),
    _probe("environment/files", "no files are written", environment.files),
    _probe("environment/process", "the process stays as it was", environment.process),
    _probe("environment/messages", "a refusal has a reason", environment.messages),
    _probe("environment/logging", "log categories", environment.logging),
    _probe(MANIFEST, "experiments inside are there", experiments.manifest, needs=READS),
    _probe("experiments/smoke-test", "they give what is expected", experiments.smoke_test),
    _probe("experiments/validation", "so do validations", experiments.validation),
    _probe("experiments/uncertainty-analysis", "and other parameters", experiments.uncertainty),
    _probe("experiments/state", "so do states inside", experiments.state),
)
"""All probes, in the order in which they run."""


def probe(name: str) -> Probe:
    """Return a probe by its name.

    Raises
    ------
    KeyError
        There is none of this name.
    """
    return _BY_NAME[name]


_BY_NAME = {probe.name: probe for probe in PROBES}


def function_of(name: str, stage: int) -> ProbeStage:
    """Return the function of a stage of a probe."""
    return _BY_NAME[name].stages[stage]

"""A run from a system to its results, metrics and references included."""

import weakref
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from rockshed.components.catalogue import component
from rockshed.components.common.component import Component

from ..core.errors import InputRefused, Problem, RunDoubted, RunFailed
from ..core.loop.master import Progress
from ..core.results.metric import Metrics
from ..core.results.reading import add_facts, add_metrics
from ..core.run import simulate as simulate_spec
from ..core.system.plan import Plan
from ..metrics import comparison
from ..metrics.practice import formula_values, with_formulas
from ..temporary import TemporaryFolder
from .building import Note, silent
from .first_compilation import tell_first_compilation
from .job import Job
from .run import Run, read_run
from .system import System, case
from .undriven import undriven


def simulate(
    system: System | str,
    folder: str | Path | None = None,
    *,
    progress: Progress | None = None,
    allow_unstable: bool = False,
    note: Note = silent,
    strict: bool = False,
    checkpoint_every: float | None = None,
) -> Run:
    """Run a system. Ctrl-C ends the run and keeps what was computed.

    ``rockshed run`` calls this function: metrics, warnings and files are the same.

    Parameters
    ----------
    system : System or str
        From :func:`rockshed.case`, ``System.load`` or ``System.new``; or the name of a case.
    folder : str or Path, optional
        Folder of the results, new, empty or that of an earlier run, which is replaced. By default
        a temporary folder that is removed when nothing refers to the run any more;
        :meth:`Run.save` keeps the results.
    progress : callable, optional
        Called with the time reached and the stop time (s), every now and then.
    allow_unstable : bool
        Run also with steps above the stable ones.
    note : callable, optional
        Called with a line before the run if its results will be large.
    strict : bool
        Take a complete run with any warning for an error.
    checkpoint_every : float, optional
        Simulated time (s) between two checkpoints in the folder of the results, from which
        :func:`rockshed.resume` goes on whatever has ended the run; by default there are none.

    Returns
    -------
    Run
        Complete, or with the status ``interrupted`` after Ctrl-C.

    Raises
    ------
    InputRefused
        The system does not fit its FMUs, or the folder cannot be had; nothing has been computed.
    RunFailed
        The run began and could not go on; its attribute ``run`` has the results until then.
    RunDoubted
        With ``strict``, the run is complete and has warnings; its attribute ``run`` has the
        results.

    Examples
    --------
    >>> import rockshed
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> run = rockshed.simulate(system)
    >>> run["rock.velocity.y"].unit
    'm/s'
    >>> round(float(run["rock.velocity.y"][0]), 3)
    -8.0
    >>> run.metrics["simulated_time"].value
    0.001
    """
    system = _system(system)
    system.refuse_empty()
    temporary = TemporaryFolder("rockshed-") if folder is None else None
    place = Path(temporary.name) / system.name if temporary else Path(str(folder))
    try:
        _carry_out(system, place, progress, allow_unstable, note, checkpoint_every)
    except RunFailed as failure:
        failure.run = kept(measured(place), temporary)
        raise
    except BaseException:
        if temporary:
            temporary.cleanup()
        raise
    return checked(kept(measured(place), temporary), strict)


def checked(done: Run, strict: bool) -> Run:
    """Return a run; a complete one with warnings is an error where none is allowed.

    Parameters
    ----------
    done : Run
        That has ended.
    strict : bool
        Whether a complete run may have no warning.

    Raises
    ------
    RunDoubted
        It has some; its attribute ``run`` has the results.
    """
    if strict and done.status == "complete" and done.warnings:
        raise RunDoubted(done)
    return done


def _system(system: System | str) -> System:
    """Return a system, or that of a case by its name."""
    if isinstance(system, str):
        return case(system)
    if not isinstance(system, System):
        reason = f"cannot be made of {type(system).__name__}"
        remedy = "give a System (rockshed.case, System.load, System.new) or the name of a case"
        raise InputRefused([Problem("simulation", reason, remedy)])
    return system


def warnings_of(job: Job, plan: Plan) -> list[str]:
    """Return warnings of the preparation, and of bodies that nothing drives."""
    return [*job.facts.get("warnings", ()), *undriven(plan)]


def _carry_out(
    system: System,
    folder: Path,
    progress: Progress | None,
    allow_unstable: bool,
    note: Note,
    checkpoint_every: float | None,
) -> None:
    job = system.job
    sources = [getattr(source, "component", None) for source in job.sources.values()]
    here = [made for made in sources if isinstance(made, Component)]
    tell_first_compilation([*here, *map(component, sorted(job.components))])
    with job.refused_in_place():
        simulate_spec(
            job.system,
            folder,
            sources=job.sources,
            allow_unstable=allow_unstable,
            checkpoint_every=checkpoint_every,
            progress=progress,
            facts=lambda plan: {**job.facts, "warnings": warnings_of(job, plan)},
            note=note,
            files=job.files,
        )


def measured(folder: Path) -> Run:
    """Add metrics, warnings and formulas that follow from the results to those of the run.

    Parameters
    ----------
    folder : Path
        Of a run that has ended.

    Returns
    -------
    Run
        With all of them; they are written down too, unless the disk is full.
    """
    done = read_run(folder)
    formulas = formula_values(done)
    metrics = with_formulas(comparison.figures(done, comparison.known_of(done)), formulas)
    found = {"warnings": done.warnings, "formulas": [entry.as_data() for entry in formulas]}
    with suppress(OSError):
        add_metrics(done.folder, metrics)
        add_facts(done.folder, found)
    everything = Metrics([*done.metrics.values(), *metrics])
    provenance = {**done.provenance, **found}
    return Run(**{**vars(done), "metrics": everything, "provenance": provenance})


def with_facts(run: Run, found: Mapping[str, Any]) -> Run:
    """Add to a finished run what was found about it later.

    Parameters
    ----------
    run : Run
        The run.
    found : mapping of str to Any
        Entries of ``run.json``, which is written unless the disk is full.

    Returns
    -------
    Run
        With these entries in its provenance.
    """
    with suppress(OSError):
        add_facts(run.folder, found)
    return Run(**{**vars(run), "provenance": {**run.provenance, **found}})


def kept(run: Run, temporary: TemporaryFolder | None) -> Run:
    """Return the run; a temporary folder of its results goes with it."""
    if temporary:
        weakref.finalize(run, temporary.cleanup)
    return run

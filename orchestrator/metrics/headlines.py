"""Headline metrics of a run: of an impact, of a static test, of a blow on a pile.

They follow from the results alone, whatever system it was: variables are found by their roles, and
a metric whose variable is missing is left out.
"""

from collections.abc import Iterator

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .cushion import of_cushions
from .energy import largest, machine_work, of_structures, of_system, system_residual
from .pressure import of_pressures
from .pulse import of_pulses
from .reported import reported
from .shares import of_energies
from .utilisation import of_design


def headlines(run: StoredRun) -> list[Metric]:
    """Return every headline metric that the results give.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of Metric
        Without references, in the order of the tables; none of a run without a row.
    """
    if not run.time.size:
        return []
    declared = [entry.metric for entry in reported(run)]
    cushions, machine = list(of_cushions(run)), list(_of_machine(run))
    loads = [*of_pulses(run), *of_pressures(run)]
    bent = list(of_structures(run))
    design = of_design(run, [*cushions, *bent, *declared])
    return [
        *cushions,
        *loads,
        *machine,
        *bent,
        *design,
        *declared,
        *of_system(run),
        *of_energies(run),
    ]


def headline(run: StoredRun, name: str) -> float | None:
    """Return the value of a headline metric; None if the results do not give it.

    Parameters
    ----------
    run : StoredRun
        The run.
    name : str
        Name in words.
    """
    return next((float(m.value) for m in headlines(run) if m.name == name), None)


def _of_machine(run: StoredRun) -> Iterator[Metric]:
    """Yield the work of the machine on a driven body, and the residual as a share of it."""
    work = machine_work(run)
    if work is None:
        return
    yield Metric(names.MACHINE_WORK, float(work[-1]), "J")
    residual = system_residual(run)
    if residual is not None and work[-1]:
        yield Metric(names.RESIDUAL_WORK_SHARE, largest(residual) / float(work[-1]))

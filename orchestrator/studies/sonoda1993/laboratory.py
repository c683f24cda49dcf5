"""Impacts of the laboratory as tasks: models of the sand, seeds."""

from collections.abc import Mapping, Sequence

from ...cases.sand_models import settings
from ...cases.sonoda1993 import case_name
from ...job import Request
from ..study import Task

MODELS: Mapping[str, Sequence[str]] = {name: settings(name) for name in ("calibrated", "literal")}
"""Models of the paper's sand by name, and what is changed for them."""
ONE_LAW = "one-law"
"""The model with one contact law for all tests."""
ALL_MODELS = (*MODELS, ONE_LAW)
SEEDS = range(1, 11)
LATTICE_SHIFT = 1e-3
"""Random displacement of the discs of the lattice, in diameters."""
STOP = 0.03
"""End of the runs (s): force and penetration have had their peaks."""

SEED_NOTE = (f"Mean and standard deviation over {len(SEEDS)} seeds of a lattice shifted by {LATTICE_SHIFT:g} diameters; with "
             "--quick one run on the undisturbed lattice, with the coupling impulse, which needs a tenth of the exchanges.")


def impact(test: int, model: str, changes: Sequence[str] = (), seed: int | None = None, coupling: str | None = None) -> Task:
    """The impact of a test of table 2 with one of :data:`ALL_MODELS`. A seed shifts the lattice, or gives another packing."""
    shifted = () if seed is None else (*_lattice(model), f"sand.seed={seed}")
    changed = MODELS.get(model, ())
    request = Request(case_name(test), (*changed, *changes, *shifted), coupling=coupling, options={"stop_time": STOP},
                      model=None if model in MODELS else model)
    return Task(request, model, seed)


def _lattice(model: str) -> Sequence[str]:
    return (f"sand.lattice_shift={LATTICE_SHIFT:g}",) if model in MODELS else ()


def impacts(test: int, model: str, quick: bool, changes: Sequence[str] = ()) -> list[Task]:
    """One impact for each seed; in a quick study one on the undisturbed lattice, with few exchanges."""
    if quick:
        return [impact(test, model, changes, None if model in MODELS else SEEDS[0], "impulse")]
    return [impact(test, model, changes, seed, None if model in MODELS else "impulse") for seed in SEEDS]

"""Impacts of the laboratory as tasks: models of the sand, seeds."""

import math
from collections.abc import Mapping, Sequence

from rockshed.components.common.units import cm

from ...cases.sand_models import settings
from ...cases.sonoda1993 import case_name
from ...runs.job import Request
from ..study import Task

MODELS: Mapping[str, Sequence[str]] = {name: settings(name) for name in ("calibrated", "literal")}
"""Models of the paper's sand by name, and what is changed for them."""
STEEL_DISCS = "calibrated, steel discs"
READINGS: Mapping[str, Sequence[str]] = {
    **MODELS,
    STEEL_DISCS: (f"sand.beam.disc_mass={math.pi * (2.5 * cm) ** 2 * 10 * cm * 7850.0:.4g}",),
}
"""The same, and the calibrated sand with another reading of eq. (1) on the beam: in the dashpots there, m is the mass of a beam
disc of steel, as deep as the cushion."""
ONE_LAW = "one-law"
"""The model with one contact law for all tests."""
ALL_MODELS = (*MODELS, ONE_LAW)
SEEDS = range(1, 11)
LATTICE_SHIFT = 1e-3
"""Random displacement of the discs of the lattice, in diameters."""
STOP = 0.03
"""End of the runs (s): force and penetration have had their peaks."""

SEED_NOTE = (
    f"Mean and standard deviation over {len(SEEDS)} seeds of a lattice shifted by {LATTICE_SHIFT:g} diameters; with "
    "--quick one seed, with the coupling impulse, which needs a tenth of the exchanges."
)


def impact(
    test: int,
    model: str,
    changes: Sequence[str] = (),
    seed: int | None = None,
    coupling: str | None = None,
) -> Task:
    """The impact of a test of table 2 with one of :data:`ALL_MODELS`. A seed shifts the lattice, or gives another packing."""
    shifted = () if seed is None else (*_lattice(model), f"sand.seed={seed}")
    changed = READINGS.get(model, ())
    request = Request(
        case_name(test),
        (*changed, *changes, *shifted),
        coupling=coupling,
        options={"stop_time": STOP},
        model=model if model == ONE_LAW else None,
    )
    return Task(request, model, seed)


def _lattice(model: str) -> Sequence[str]:
    return (f"sand.lattice_shift={LATTICE_SHIFT:g}",) if model != ONE_LAW else ()


def impacts(test: int, model: str, quick: bool, changes: Sequence[str] = ()) -> list[Task]:
    """One impact for each seed; in a quick study one, with few exchanges."""
    if quick:
        return [impact(test, model, changes, SEEDS[0], "impulse")]
    return [
        impact(test, model, changes, seed, "impulse" if model == ONE_LAW else None)
        for seed in SEEDS
    ]

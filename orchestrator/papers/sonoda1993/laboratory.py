"""Impacts of the laboratory as tasks: models of the sand, seeds."""

import math
from collections.abc import Mapping

from rockshed.components.common.units import cm

from ...cases.sand_models import LATTICE_SHIFT, model_values
from ...cases.sonoda1993 import DEFAULT_TEST, case_name
from ...core.system.fields import Value
from ...runs.batch import Task
from ...runs.job import Request
from ..study import shortened

MODELS: Mapping[str, Mapping[str, Value]] = {
    name: model_values(name) for name in ("calibrated", "literal")
}
"""Values, by ``sand.parameter``, of the models of the paper's sand on a floor by name."""
STEEL_DISCS = "calibrated, steel discs"
READINGS: Mapping[str, Mapping[str, Value]] = {
    **{name: {} for name in MODELS},
    STEEL_DISCS: {"sand.beam.disc_mass": math.pi * (2.5 * cm) ** 2 * 10 * cm * 7850.0},
}
"""The models, and the calibrated sand with another reading of eq. (1) on the beam: what it sets.

In the dashpots there, m is the mass of a beam disc of steel, as thick as the cushion.
"""
BOX_MASS = 15.0
"""Mass (kg) of the sand box, assumed: a box of steel plates; the paper gives none."""
BOXED = f"calibrated, box of {BOX_MASS:g} kg"
UNDER_BOX: Mapping[str, Mapping[str, Value]] = {
    BOXED: {"beam.box.mass": BOX_MASS},
}
"""The calibrated sand in a box that has a mass between sand and load cells."""
ONE_LAW = "one-law"
"""The model with one contact law for all tests."""
ALL_MODELS = (*MODELS, ONE_LAW)
SEEDS = range(1, 11)
STOP = 0.034
"""End of the runs (s): force and penetration have had their peaks."""

SEED_NOTE = (
    f"Mean and standard deviation over {len(SEEDS)} seeds of a lattice shifted by "
    f"{LATTICE_SHIFT:g} diameters; in a quick reproduction one seed, with the coupling impulse, "
    "which needs a tenth of the exchanges."
)


def impact(
    test: int,
    model: str,
    changes: Mapping[str, Value] | None = None,
    seed: int | None = None,
    coupling: str | None = None,
) -> Task:
    """Return the impact of a test of table 2.

    Parameters
    ----------
    test : int
        Number of the test.
    model : str
        One of :data:`ALL_MODELS`, or a reading.
    changes : mapping of str to Value, optional
        Further values.
    seed : int, optional
        Shifts the lattice, or gives another packing.
    coupling : str, optional
        Scheme of exchange, by default that of the paper.
    """
    values = {**{**READINGS, **UNDER_BOX}.get(model, {}), **(changes or {})}
    if seed is not None and model != ONE_LAW:
        values["sand.lattice_shift"] = LATTICE_SHIFT
    if seed is not None:
        values["sand.seed"] = seed
    request = Request(
        case_name(test),
        values,
        coupling=coupling,
        options={"stop_time": STOP},
        model=model if model in ALL_MODELS else None,
    )
    return Task(request, model, seed)


def _beginning(model: str, coupling: str = "impulse", stop_time: float = 4e-3) -> Request:
    return shortened(impact(DEFAULT_TEST, model, None, SEEDS[0], coupling), stop_time)


SHORT_LATTICES: Mapping[str, Request] = {
    **{f"impact, {model}": _beginning(model) for model in MODELS},
    "impact, exchange every 0.01 ms": _beginning("calibrated", "paper", 1e-3),
}
SHORT_IMPACTS: Mapping[str, Request] = {
    **SHORT_LATTICES,
    f"impact, {ONE_LAW}": _beginning(ONE_LAW, stop_time=1e-2),
}
"""Beginnings of the impact of test 4, which studies of the laboratory stand on.

With the one law the ball starts higher, and meets the sand later.
"""
SHORT_STEEL: Mapping[str, Request] = {f"impact, {STEEL_DISCS}": _beginning(STEEL_DISCS)}
SHORT_JACOBI: Mapping[str, Request] = {
    "impact, all at once": _beginning("calibrated", "jacobi", 2e-3)
}


def impacts(
    test: int, model: str, quick: bool, changes: Mapping[str, Value] | None = None
) -> list[Task]:
    """Return one impact for each seed; in a quick study one, with few exchanges."""
    if quick:
        return [impact(test, model, changes, SEEDS[0], "impulse")]
    return [
        impact(test, model, changes, seed, "impulse" if model == ONE_LAW else None)
        for seed in SEEDS
    ]

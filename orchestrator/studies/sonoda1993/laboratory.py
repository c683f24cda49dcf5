"""Impacts of the laboratory as tasks: models of the sand, seeds."""

from collections.abc import Mapping, Sequence

from ...cases.sonoda1993 import case_name
from ...job import Request
from ..study import Task

MODELS: Mapping[str, Sequence[str]] = {
    "calibrated": (),
    "literal": ("sand.rotation=free", "sand.stiffness_factor=1"),
}
"""Models of the sand by name, and what is changed for them."""
SEEDS = range(1, 11)
LATTICE_SHIFT = 1e-3
"""Random displacement of the discs of the lattice, in diameters."""
STOP = 0.03
"""End of the runs (s): force and penetration have had their peaks."""

SEED_NOTE = (f"Mean and standard deviation over {len(SEEDS)} seeds of a lattice shifted by {LATTICE_SHIFT:g} diameters; with "
             "--quick one run on the undisturbed lattice, with the coupling impulse, which needs a tenth of the exchanges.")


def impact(test: int, model: str, settings: Sequence[str] = (), seed: int | None = None, coupling: str | None = None) -> Task:
    """The impact of a test of table 2 with one of the :data:`MODELS`."""
    shifted = () if seed is None else (f"sand.lattice_shift={LATTICE_SHIFT:g}", f"sand.seed={seed}")
    request = Request(case_name(test), (*MODELS[model], *settings, *shifted), coupling=coupling, options={"stop_time": STOP})
    return Task(request, model, seed)


def impacts(test: int, model: str, quick: bool, settings: Sequence[str] = ()) -> list[Task]:
    """One impact for each seed; in a quick study one on the undisturbed lattice, with few exchanges."""
    if quick:
        return [impact(test, model, settings, coupling="impulse")]
    return [impact(test, model, settings, seed) for seed in SEEDS]

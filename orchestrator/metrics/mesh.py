"""How far the results of a shed hang on the sizes of its sand discs and beam elements.

A study of one shed is kept with the program (``rockshed converge``, docs/convergence.md). What it
found is told of every shed with the default sizes; for another shed it is a guide and no proof.
"""

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from rockshed.components.common.units import mm

from ..core.results.facts import number_of, table_of
from ..core.results.reading import StoredRun

TRIAL = Path(__file__).parent / "data" / "trial_shed.json"
"""The kept study: ``convergence.json`` of the example ``trial-shed.toml``, with its stamp."""
SIZES = ("disc_radius", "elements")
"""Fields of ``numerics`` that replace default sizes."""
_STUDY = "`rockshed converge` tells it of this project"
_NEAR = 0.03
"""Departure that is told as a small one."""
_DISCS = "sand discs"


@cache
def trial() -> Mapping[str, Any]:
    """Return the kept study of the trial shed."""
    content: Mapping[str, Any] = json.loads(TRIAL.read_text(encoding="utf-8"))
    return content


def mesh_in_words(run: StoredRun) -> str:
    """Return the mesh of a project's run, and how far its results are from those of a finer one.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    str
        A sentence; empty for a run that is none of a project.
    """
    project = table_of(run.provenance, "project")
    derived = table_of(project, "derived")
    radius, rock = number_of(derived, "disc_radius"), number_of(table_of(derived, "rock"), "radius")
    if not radius or not rock:
        return ""
    mesh = (
        f"mesh: {derived['discs']} sand discs of {radius / mm:.3g} mm (1/{rock / radius:.2g} of "
        f"the rock's radius), {derived['elements']} beam elements"
    )
    chosen = table_of(table_of(project, "content"), "numerics")
    if any(chosen.get(name) is not None for name in SIZES):
        return f"{mesh}, not all by default; {_STUDY}"
    return f"{mesh}; {_departures()}; {_STUDY}"


def _departures() -> str:
    """Return what finer discs changed in the trial shed."""
    own, finest = _own_and_finest()
    small, told = [], []
    for entry in _of_discs():
        change = 1.0 / (1.0 + entry["share"]) - 1.0
        error = entry["standard_error"] / (1.0 + entry["share"]) ** 2
        if abs(change) + error <= _NEAR:
            small.append(entry["figure"])
        else:
            told.append(f"{entry['figure']} by {100.0 * change:+.0f} ± {100.0 * error:.0f} %")
    changed = f"changed {', '.join(told)}" if told else ""
    less = f"{', '.join(small)} by less than {100.0 * _NEAR:.0f} %" if small else ""
    return (
        f"in the trial shed of the examples discs of 1/{own / finest:.2g} of that size "
        f"{' and '.join(part for part in (changed, less) if part)}"
    )


def _own_and_finest() -> tuple[float, float]:
    """Return the radii of the project's own discs and of the finest ones (m)."""
    discs = [mesh for mesh in trial()["meshes"] if mesh["refined"] == _DISCS]
    own = next(mesh for mesh in trial()["meshes"] if mesh["refined"] != _DISCS)
    return float(own["disc_radius"]), min(float(mesh["disc_radius"]) for mesh in discs)


def _of_discs() -> Iterator[Mapping[str, Any]]:
    """Yield the departures from the finest discs."""
    return (entry for entry in trial()["departures"] if entry["refined"] == _DISCS)

"""Notes on the numbers of a structure: of how many girders, with which loads, of which sign."""

from collections.abc import Iterator, Mapping
from typing import Any

from rockshed.components.common.roles import Role
from rockshed.components.common.units import kN, mm

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .energy import has_yielded, of_structures, structures, weightless
from .roles import column

_SIGNS = (
    "a moment is positive with tension below (sagging), negative with tension above (hogging); a "
    "shear force is positive where the part on its left pushes the other up; a reaction is that of "
    "one support, upwards on the roof"
)
_PARTS = ((names.PEAK_MOMENT, "kN m"), (names.PEAK_SHEAR, "kN"), (names.PEAK_REACTION, "kN"))


def on_structures(run: StoredRun) -> list[str]:
    """Return what a reader has to know of moment, shear force, reaction and deflection.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of str
        Sentences; none where no structure bends.
    """
    design = run.provenance.get("design")
    told = design if isinstance(design, Mapping) else {}
    found = {metric.name: metric for metric in of_structures(run)}
    if names.PEAK_MOMENT not in found:
        return []
    roof, cushion = told.get("roof"), told.get("cushion")
    shared = _shared(roof, cushion, found) if isinstance(roof, Mapping) else []
    return [*shared, _SIGNS, *_dead_load(run), *_yielding(run, roof)]


def _shared(roof: Mapping[str, Any], cushion: Any, found: Mapping[str, Metric]) -> Iterator[str]:
    """Yield how many girders, or metres of a strip, bear together, and what one of them bears."""
    number = roof.get("girders")
    if not isinstance(number, int | float) or not number > 0.0:
        return
    parts = [
        f"{float(found[name].value) / number / kN:.4g} {unit}"
        for name, unit in _PARTS
        if name in found
    ]
    whole = f"all {number:.3g} girders in the effective width together; of one girder"
    if roof.get("kind") == "concrete":
        width = cushion.get("effective_width", number) if isinstance(cushion, Mapping) else number
        whole = f"the whole strip of {width:.4g} m, the effective width; of a metre"
    yield f"moment, shear force and reaction are those of {whole}: {', '.join(parts)}"


def _dead_load(run: StoredRun) -> Iterator[str]:
    """Yield what a structure bears at rest, where its weights are in the results."""
    for structure in structures(run):
        deflection = column(run, structure, Role.DEFLECTION)
        if deflection is not None and structure not in weightless(run):
            at_rest = float(run.series[deflection][0]) / mm
            yield (
                "deflection, moment, shear force and reaction hold the dead load of structure and "
                f"cushion; at rest the deflection is {at_rest:.3g} mm"
            )


def _yielding(run: StoredRun, roof: Any) -> Iterator[str]:
    """Yield what yielding or cracking makes of stress and residual deflection."""
    if not any(has_yielded(run, structure) for structure in structures(run)):
        return
    if isinstance(roof, Mapping) and roof.get("kind") == "concrete":
        yield (
            "concrete has cracked: it unloads towards the origin until its bars yield, so a "
            "residual deflection is that of bars which have yielded, or of a face that broke "
            "without bars; the work of cracking counts as dissipated"
        )
    else:
        yield "the section has yielded: M/W is the stress that an elastic section would have"

"""Utilisation of a structure: what a run has found over the limits of its design criteria.

Criteria and the section stand in the provenance of a run, ``design``: of a project, or of a case
that knows them.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rockshed.components.common.roles import Role
from rockshed.components.common.units import MPa, cm, kN, mm

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .energy import structures, yields
from .roles import all_samples, parameter
from .values import of_each

STRESS = "stress"
"""Criterion: bending stress of the elastic section (Pa)."""
SAGGING, HOGGING = "sagging moment", "hogging moment"
"""Criteria of a section whose capacities differ (N m)."""
CURVATURE = "curvature"
"""Criterion: curvature in that at which the section has no more capacity."""

_MEASURES: Mapping[str, Sequence[str]] = {
    STRESS: (names.PEAK_STRESS,),
    "plastic moment": (names.PEAK_MOMENT,),
    SAGGING: (names.PEAK_SAGGING,),
    HOGGING: (names.PEAK_HOGGING,),
    CURVATURE: (names.CURVATURE_RATIO,),
    "deflection": (names.DEFLECTION,),
    "reaction": (names.PEAK_REACTION,),
    "penetration": (names.PENETRATION,),
    "pile set": ("permanent set",),
}
"""Metrics that a criterion limits, each in the unit of the limit; the largest of them counts."""


def criteria(run: StoredRun) -> dict[str, float]:
    """Return the limits of a run's design by the name of the criterion.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    dict of str to float
        In SI units, positive ones only; empty where the run has no design.
    """
    found = {}
    for entry in _criteria(run):
        name, limit = entry.get("name"), entry.get("limit")
        if isinstance(name, str) and isinstance(limit, int | float) and 0.0 < limit < math.inf:
            found[name] = float(limit)
    return found


def _criteria(run: StoredRun) -> list[Mapping[str, Any]]:
    """Return the criteria as the design tells them; what has another form is passed over."""
    told = _part(run, "criteria")
    return [entry for entry in told if isinstance(entry, Mapping)] if isinstance(told, list) else []


def _part(run: StoredRun, name: str) -> Any:
    """Return a part of the design; None where there is none, or it is none."""
    design = run.provenance.get("design")
    return design.get(name) if isinstance(design, Mapping) else None


def _elastic_stress(run: StoredRun, structure: str) -> float | None:
    """Return the largest stress (Pa) of a structure's outer fibre by its own section, M H / 2 I.

    Returns
    -------
    float or None
        None where a stress means nothing (the design knows no section modulus, or concrete may
        crack), or the structure tells no section.
    """
    roof = _part(run, "roof")
    if not isinstance(roof, Mapping) or not roof.get("section_modulus"):
        return None
    if roof.get("kind") == "concrete" and yields(run, structure):
        return None
    height = parameter(run, structure, Role.SECTION_HEIGHT)
    second_moment = parameter(run, structure, Role.SECOND_MOMENT)
    moments = all_samples(run, structure, Role.BENDING_MOMENT)
    if not height or not second_moment or not moments.size:
        return None
    return float(np.abs(moments).max()) * float(height) / (2.0 * float(second_moment))


def of_design(run: StoredRun, found: Iterable[Metric]) -> Iterator[Metric]:
    """Yield stress, sagging and hogging, and the share of each limit that the run has reached.

    Of a run that has failed nothing is yielded: it says nothing about a design.

    Parameters
    ----------
    run : StoredRun
        The run.
    found : iterable of Metric
        Its other headline metrics.
    """
    if run.has_failed:
        return
    limits = criteria(run)
    bent = list(of_each(run, structures(run), _peak_stress))
    if HOGGING in limits:
        bent += of_each(run, structures(run), _sagging_and_hogging)
    yield from bent
    known = [*found, *bent]
    for criterion, limit in limits.items():
        value = _largest(known, _MEASURES.get(criterion, ()))
        if value is not None:
            yield Metric(names.utilisation(criterion), value / limit)


def _peak_stress(run: StoredRun, structure: str) -> Iterator[Metric]:
    stress = _elastic_stress(run, structure)
    if stress is not None:
        yield Metric(names.PEAK_STRESS, stress, "Pa")


def _sagging_and_hogging(run: StoredRun, structure: str) -> Iterator[Metric]:
    moments = all_samples(run, structure, Role.BENDING_MOMENT)
    if moments.size:
        yield Metric(names.PEAK_SAGGING, max(0.0, float(moments.max())), "N.m")
        yield Metric(names.PEAK_HOGGING, max(0.0, -float(moments.min())), "N.m")


def _largest(found: Iterable[Metric], wanted: Sequence[str]) -> float | None:
    """Return the largest amount of the metrics of some names, of whatever component."""
    amounts = [
        abs(float(metric.value))
        for metric in found
        if names.without_component(metric.name) in wanted
    ]
    return max(amounts, default=None)


def exceeded(run: StoredRun, found: Iterable[Metric]) -> Iterator[str]:
    """Yield a doubt for each criterion whose limit a run has passed.

    Parameters
    ----------
    run : StoredRun
        The run.
    found : iterable of Metric
        Its headline metrics, those of :func:`of_design` included.
    """
    limits = criteria(run)
    yielding = any(yields(run, structure) for structure in structures(run))
    for metric in found:
        criterion = names.criterion_of(names.without_component(metric.name))
        if criterion not in limits or float(metric.value) <= 1.0:
            continue
        share = float(metric.value)
        limit = limits[criterion]
        if criterion == STRESS and not yielding:
            yield _past_yield(share, limit, _source(run, criterion))
        elif criterion == CURVATURE:
            yield _past_capacity(share)
        else:
            yield _past(criterion, share, limit)


def _source(run: StoredRun, criterion: str) -> str:
    """Return where a limit comes from, in brackets; empty where the design does not say."""
    named = (entry for entry in _criteria(run) if entry.get("name") == criterion)
    source = next((entry.get("source") for entry in named), None)
    return f" ({source})" if source else ""


def _past_yield(share: float, limit: float, source: str) -> str:
    """Say that an elastic section was bent beyond its yield stress (Pa)."""
    return (
        f"stress past yield: {share * limit / MPa:.4g} MPa are {share:.2f} times the "
        f"{limit / MPa:.4g} MPa of the design{source}, and the section of this run is elastic: "
        "results mean nothing beyond yield; let the section yield (section.bending=yielding), or "
        "make it stronger"
    )


def _past_capacity(share: float) -> str:
    """Say that a section was bent beyond the curvature at which its capacity ends."""
    return (
        f"curvature past its limit: {share:.3g} times that at which the section has no more "
        "capacity (concrete is crushed, or cracks where no bars cross): what comes after means "
        "nothing; change the design"
    )


_SHOWN = {
    STRESS: ("MPa (elastic, M/W)", MPa),
    "plastic moment": ("kN m", kN),
    SAGGING: ("kN m", kN),
    HOGGING: ("kN m", kN),
    "deflection": ("mm", mm),
    "reaction": ("kN", kN),
    "penetration": ("cm", cm),
    "pile set": ("mm", mm),
}
"""Units on the screen by the name of the criterion, with their size in SI."""


def _past(criterion: str, share: float, limit: float) -> str:
    """Say that a run is past the limit (SI) of a criterion."""
    unit, size = _SHOWN[criterion]
    return (
        f"{criterion} past its limit: {share * limit / size:.4g} {unit} are {share:.2f} times the "
        f"{limit / size:.4g} {unit} of the design; change the design, or the criterion"
    )

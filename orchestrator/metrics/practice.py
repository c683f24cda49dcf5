"""Formulas of practice for the impact of a run, computed from what its results tell."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rockshed.components.common.roles import Role

from ..core.results.metric import Beside, Metric
from ..core.results.reading import StoredRun
from ..formulas import FORCE, PENETRATION, FormulaValue, RockImpact, estimates, table_of
from ..references import Known, Reference
from ..tables import Table
from . import names
from .cushion import cushions, thickness_at_start
from .energy import driven
from .headlines import headlines
from .roles import column, owners, positive

_COLUMNS = {
    "computed": {FORCE: names.PEAK_ROCK, PENETRATION: names.PENETRATION},
    "settled": {FORCE: names.SETTLED_ROCK},
}
"""Metrics that stand beside an estimate, by title of a column and quantity of the estimate."""
_TITLE = "beside it, by formulas of practice (docs/formulas.md)"


def impact_of(run: StoredRun) -> RockImpact | None:
    """Return the impact that formulas of practice take: mass, radius, speed, thickness.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    RockImpact or None
        None where not one body strikes one cushion, or it has not touched it. The speed is that of
        the kinetic energy at the last row before contact. Modulus and angle of friction are the
        usual ones of the formulas: the sand's E_bar and the friction of its discs are neither.
    """
    bodies, struck = owners(run, Role.STRIKING), cushions(run)
    if driven(run) or len(bodies) != 1 or len(struck) != 1 or not run.time.size:
        return None
    mass, radius = (positive(run, bodies[0], role) for role in (Role.BODY_MASS, Role.BODY_RADIUS))
    energy = _energy_at_contact(run, bodies[0], struck[0])
    if not mass or not radius or not energy:
        return None
    thickness = thickness_at_start(run, struck[0])
    return RockImpact(
        mass,
        radius,
        float(np.sqrt(2.0 * energy / mass)),
        thickness if thickness and thickness > 0.0 else None,
    )


def _energy_at_contact(run: StoredRun, body: str, cushion: str) -> float | None:
    """Return the kinetic energy (J) of a body at the last row before its first contact."""
    energy = column(run, body, Role.STRIKING)
    force = column(run, cushion, Role.ON_BODY)
    if energy is None or force is None:
        return None
    touching = np.flatnonzero(run.series[force] > 0.0)
    return float(run.series[energy][max(touching[0] - 1, 0)]) if touching.size else None


def formula_values(run: StoredRun) -> list[FormulaValue]:
    """Return what the formulas of practice give for the impact of a run.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of FormulaValue
        Empty where the run is no impact of a rock on a cushion, or has failed.
    """
    impact = None if run.has_failed else impact_of(run)
    try:
        return [] if impact is None else estimates(impact)
    except ValueError:  # a value that no formula takes: results of a run that went astray
        return []


def with_formulas(metrics: Iterable[Metric], values: Iterable[FormulaValue]) -> list[Metric]:
    """Return metrics with the estimates of their quantity among their references.

    Parameters
    ----------
    metrics : iterable of Metric
        Of a run.
    values : iterable of FormulaValue
        Estimates for its impact.
    """
    listed = [entry for entry in values if entry.value]
    beside = {
        name: [entry for entry in listed if entry.quantity == quantity]
        for metrics_of in _COLUMNS.values()
        for quantity, name in metrics_of.items()
    }
    return [_compared(metric, beside.get(metric.name, [])) for metric in metrics]


def _compared(metric: Metric, values: Iterable[FormulaValue]) -> Metric:
    found = {
        entry.name: Beside(entry.value, float(metric.value) / entry.value - 1.0, entry.remark)
        for entry in values
    }
    return replace(metric, references={**metric.references, **found}) if found else metric


def with_handbook(run: StoredRun, known: Known | None) -> Known:
    """Return references of the force on the rock with that of the handbook's formula.

    Parameters
    ----------
    run : StoredRun
        The run.
    known : Known or None
        References that there are.
    """
    own = {} if known is None else known.by()
    forces = (value for value in formula_values(run) if value.quantity == FORCE)
    first = next(({f"the {entry.name}": Reference(entry.value)} for entry in forces), {})
    return Known.of({**own, **first})


def formula_table(run: StoredRun) -> Table:
    """Return the formulas of practice beside the peak force and the penetration of a run.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    Table
        Without a row where the run is no impact of a rock on a cushion.
    """
    found = {metric.name: float(metric.value) for metric in headlines(run)}
    computed = {
        title: {quantity: found[name] for quantity, name in beside.items() if name in found}
        for title, beside in _COLUMNS.items()
    }
    shown = {title: values for title, values in computed.items() if values}
    return table_of(formula_values(run), shown, _TITLE)

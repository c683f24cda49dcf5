"""Stamps: what a study's results follow from, as digests that are kept beside the results.

Kept results whose stamps are not those of the present program come from an older one. Numbers count
to nine digits, so that no processor that rounds otherwise makes results look old.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..core.run import simulate
from ..metrics import names
from ..runs.batch import metrics_of, slim
from ..runs.job import prepare
from ..runs.request import Request
from ..temporary import TemporaryFolder
from .study import Outcomes, Row, Study

if TYPE_CHECKING:
    from numpy.typing import NDArray

TASKS = "tasks"
"""Name of the stamp of what a study runs: cases, values, seeds."""
ROWS = "rows"
"""Name of the stamp of a study without runs: its rows, which are quickly computed."""
DIGITS = 9
"""Digits to which numbers count."""
_COLUMNS = (
    "sand.transmitted_force",
    "sand.rock.force.y",
    "sand.penetration",
    "beam.midspan.deflection",
    "beam.energy.elastic",
    "beam.energy.strain_estimate",
    "rock.energy.kinetic",
)
"""Variables that studies show; with more recorded, results stay what they were."""
_METRICS = (
    names.PEAK_TRANSMITTED,
    names.PENETRATION,
    names.BEAM_ENERGY,
    names.BEAM_ENERGY_FROM_STRAIN,
    names.SETTLED_RATIO,
)
"""Metrics that studies show, as far as a short run has them."""


def stamps(studies: Iterable[Study]) -> dict[str, dict[str, str]]:
    """Return the stamps of studies, by the present program.

    Parameters
    ----------
    studies : iterable of Study
        Short runs that several of them name are carried out once.

    Returns
    -------
    dict of str to dict of str to str
        By the name of the study and of the stamp.
    """
    chosen = list(studies)
    short_runs: dict[str, Request] = {}
    for study in chosen:
        short_runs |= study.stands_on
    of_runs = {name: of_run(request) for name, request in short_runs.items()}
    return {study.name: _of_study(study, of_runs) for study in chosen}


def _of_study(study: Study, of_runs: Mapping[str, str]) -> dict[str, str]:
    """Return the stamps of a study whose short runs have been carried out."""
    tasks = study.tasks(False)
    if not tasks:
        return {ROWS: of_rows(study.rows(Outcomes({})))}
    named = {name: of_runs[name] for name in study.stands_on}
    return {TASKS: _digest(sorted({task.key for task in tasks})), **named}


def of_run(request: Request) -> str:
    """Return the digest of a short run.

    Parameters
    ----------
    request : Request
        Carried out in this process; the bits are those of the FMUs.

    Returns
    -------
    str
        SHA-256 of the recorded variables, each by its largest value, and by mean and end in parts
        of it, and of the metrics that studies show.
    """
    job = prepare(request)
    system = slim(job.system)
    with TemporaryFolder("rockshed-") as folder:
        run = simulate(system, folder / "run", sources=job.sources)
        known = metrics_of(run)
        shown = {name: _rounded(known[name]) for name in _METRICS if name in known}
        return _digest(
            [{name: _summary(run.series[name]) for name in _COLUMNS if name in run.series}, shown]
        )


def of_series(columns: Mapping[str, "NDArray[Any]"]) -> str:
    """Return the digest of columns: of each the largest value, and mean and end in parts of it."""
    return _digest({name: _summary(column) for name, column in columns.items()})


def of_rows(rows: Sequence[Row]) -> str:
    """Return the digest of computed values, spreads and verdicts."""
    return _digest(
        [(row.quantity, _rounded(row.computed), _rounded(row.spread), row.verdict) for row in rows]
    )


def _summary(column: "NDArray[Any]") -> list[float]:
    """Return the largest value of a column, and mean and end in parts of it."""
    largest = float(abs(column).max())
    scale = largest or 1.0
    parts = [float(column.mean()) / scale, float(column[-1]) / scale]
    return [float(f"{largest:.{DIGITS}g}"), *(round(part, DIGITS) for part in parts)]


def _rounded(value: float | None) -> float | None:
    """Round to nine digits, numbers below 1 to nine decimals: what is no more is rounding."""
    if value is None or abs(value) < 1.0:
        return value if value is None else round(value, DIGITS) + 0.0
    return float(f"{value:.{DIGITS}g}")


def _digest(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

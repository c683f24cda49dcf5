"""Energy residuals of runs against their true errors.

Systems of the catalogue run with exchange steps h, h/2, h/4, ... with both explicit masters. The
largest residual of each run, as a part of the impact energy, is held against the true error of a
figure: its relative difference from that with the finest step.
"""

import math
from collections.abc import Mapping, Sequence
from statistics import correlation
from typing import Any, NamedTuple

from ..analyses.exchange_steps.figures import Level
from ..analyses.exchange_steps.run import converge_exchange
from ..core.results.metric import identifier
from ..metrics import names

FIGURE = "peak_transmitted_force"
"""Identifier of the figure whose error is looked at."""
_SHARE = identifier(names.RESIDUAL_SHARE)


class Ladder(NamedTuple):
    """A system that is run with several exchange steps.

    levels: their number. options: keys of the system, the coarsest step among them. coupling: of
    the case, None for its first one.
    """

    levels: int
    options: Mapping[str, Any]
    coupling: str | None = None


LADDERS = {
    "lab-impact": Ladder(
        7, {"exchange_step": 2e-4, "stop_time": 0.02, "output_interval": 2e-4}, "paper"
    ),
    "rigid-base-crushed": Ladder(
        6, {"exchange_step": 8e-4, "stop_time": 0.08, "output_interval": 1.6e-3}, "paper"
    ),
    "girders-8": Ladder(
        6, {"exchange_step": 8e-4, "stop_time": 0.08, "output_interval": 1.6e-3}, "paper"
    ),
    "slope-to-cushion": Ladder(4, {"exchange_step": 8e-4, "output_interval": 1.6e-3}),
}
"""By case. Values are held and forces are those of the last moment where a case has a choice."""
MASTERS = ("sequential", "jacobi")


class ResidualAndError(NamedTuple):
    """Residual and error of a run, as parts of impact energy and figure."""

    case: str
    master: str
    step: float
    residual: float
    error: float


def pairs_of(
    case: str, master: str, levels: Sequence[Level], figure: str = FIGURE
) -> list[ResidualAndError]:
    """Return residual and error of each run but the finest, with which the others are compared.

    Parameters
    ----------
    case, master : str
        Of the runs.
    levels : sequence of Level
        From coarse to fine.
    figure : str
        Identifier of a metric.

    Returns
    -------
    list of ResidualAndError
        Without runs that have no error or residual at all, which no logarithm has.
    """
    true = levels[-1].values[figure][1]
    found = [
        ResidualAndError(
            case,
            master,
            level.step,
            abs(level.values[_SHARE][1]),
            abs(level.values[figure][1] / true - 1.0),
        )
        for level in levels[:-1]
    ]
    return [pair for pair in found if pair.residual > 0.0 and pair.error > 0.0]


def measured(cases: Sequence[str] = tuple(LADDERS), figure: str = FIGURE) -> list[ResidualAndError]:
    """Run systems with all their steps and both masters.

    Parameters
    ----------
    cases : sequence of str
        Of :data:`LADDERS`.
    figure : str
        Identifier of a metric that all of them have.
    """
    found = []
    for case in cases:
        ladder = LADDERS[case]
        for master in MASTERS:
            options = {**ladder.options, "master": master}
            study = converge_exchange(
                case, levels=ladder.levels, options=options, coupling=ladder.coupling
            )
            found += pairs_of(case, master, study.levels, figure)
    return found


def of_logarithms(pairs: Sequence[ResidualAndError]) -> float:
    """Return the correlation of the logarithms of residuals and errors.

    Parameters
    ----------
    pairs : sequence of ResidualAndError
        Two at least.
    """
    residuals = [math.log(pair.residual) for pair in pairs]
    return correlation(residuals, [math.log(pair.error) for pair in pairs])

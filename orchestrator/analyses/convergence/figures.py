"""Figures of a convergence study: means over the packings, their errors, and what they say."""

import math
import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rockshed.components.common.units import cm, kN, mm

from ...metrics import names
from ...metrics.filtering import low_pass
from ...runs.batch import COMPLETE, Outcome
from .meshes import DISCS, ELEMENTS, Resolution

TOLERANCE = 0.03
"""Deviation from the finest mesh up to which a figure counts as converged."""


@dataclass(frozen=True)
class Quantity:
    """A figure that is followed.

    Attributes
    ----------
    name : str
        Of the metric.
    unit : str
        In which it is shown.
    scale : float
        Of that unit, in SI.
    si_unit : str
        In which it is computed.
    """

    name: str
    unit: str
    scale: float
    si_unit: str


QUANTITIES = (
    Quantity(names.PEAK_ROCK, "kN", kN, "N"),
    Quantity(names.SETTLED_ROCK, "kN", kN, "N"),
    Quantity(names.PEAK_TRANSMITTED, "kN", kN, "N"),
    Quantity(names.SETTLED_TRANSMITTED, "kN", kN, "N"),
    Quantity(names.PENETRATION, "cm", cm, "m"),
    Quantity(names.PEAK_MOMENT, "kN.m", kN, "N.m"),
    Quantity(names.DEFLECTION, "mm", mm, "m"),
)
"""Figures that are followed, in the order of the table."""


SETTLED = {
    names.SETTLED_ROCK: "sand.rock.force.y",
    names.SETTLED_TRANSMITTED: "sand.transmitted_force",
}
"""Column of a project's run from which a settled maximum is taken, by the figure's name."""


@dataclass(frozen=True)
class PackingMean:
    """Mean of a figure over the packings of a mesh.

    Attributes
    ----------
    mean : float
        In SI.
    error : float
        Standard error of the mean; infinite for a single packing.
    """

    mean: float
    error: float


@dataclass(frozen=True)
class Measured:
    """A mesh and what its runs gave.

    Attributes
    ----------
    mesh : Resolution
        The mesh.
    estimates : mapping of str to PackingMean
        By the name of the quantity.
    failed : sequence of str
        Reasons of runs without a result.
    runs : int
        Number of runs with one.
    """

    mesh: Resolution
    estimates: Mapping[str, PackingMean]
    failed: Sequence[str]
    runs: int


@dataclass(frozen=True)
class Departure:
    """How far a figure of the project's own mesh is from that of the finest one.

    Attributes
    ----------
    quantity : Quantity
        The figure.
    refined : str
        What is finer.
    share : float
        Own / finest - 1.
    error : float
        Standard error of that.
    """

    quantity: Quantity
    refined: str
    share: float
    error: float

    @property
    def converged(self) -> bool:
        """Whether it is not above :data:`TOLERANCE`, its standard error included."""
        return abs(self.share) + self.error <= TOLERANCE

    @property
    def verdict(self) -> str:
        """Meaning of the departure, in words."""
        if self.converged:
            return f"converged to {100.0 * TOLERANCE:g} %"
        if abs(self.share) <= 2.0 * self.error:
            return "no difference beyond the scatter of the packings"
        return "not converged"


def common_cut_off(outcomes: Sequence[Outcome]) -> float | None:
    """Return the cut-off frequency of the settled forces of a mesh.

    A run takes half the natural frequency of its own discs, which are faster the finer they are:
    its settled maxima would differ from mesh to mesh though the forces were the same.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Of the project's own mesh.

    Returns
    -------
    float or None
        In Hz; None where no run has one.
    """
    known = [outcome.metrics.get(names.SETTLED_CUT_OFF) for outcome in outcomes]
    return next((cut_off for cut_off in known if cut_off), None)


def measured(
    mesh: Resolution, outcomes: Sequence[Outcome], cut_off: float | None = None
) -> Measured:
    """Return what the runs of a mesh gave.

    Parameters
    ----------
    mesh : Resolution
        The mesh.
    outcomes : sequence of Outcome
        Of its runs.
    cut_off : float, optional
        Of the settled forces of all meshes (Hz); by default each run's own.
    """
    whole = [
        {**outcome.metrics, **_settled(outcome, cut_off)}
        for outcome in outcomes
        if outcome.status == COMPLETE
    ]
    estimates = {}
    for quantity in QUANTITIES:
        values = [metrics[quantity.name] for metrics in whole if quantity.name in metrics]
        if values:
            error = statistics.stdev(values) / math.sqrt(len(values)) if values[1:] else math.inf
            estimates[quantity.name] = PackingMean(statistics.fmean(values), error)
    failed = [outcome.error for outcome in outcomes if outcome.status != COMPLETE]
    return Measured(mesh, estimates, failed, len(whole))


def _settled(outcome: Outcome, cut_off: float | None) -> dict[str, float]:
    """Return the settled maxima of a run by a given cut-off, as far as its rows can tell them."""
    if cut_off is None:
        return {}
    series = outcome.series
    recorded = {name: column for name, column in SETTLED.items() if column in series}
    curves = {
        name: low_pass(series["time"], series[column], cut_off) for name, column in recorded.items()
    }
    return {name: float(curve.max()) for name, curve in curves.items() if curve is not None}


def departures(found: Sequence[Measured]) -> Iterator[Departure]:
    """Yield how far each figure of the project's own mesh is from that of the finest one.

    Parameters
    ----------
    found : sequence of Measured
        Of all meshes.
    """
    for refined in (DISCS, ELEMENTS):
        series = [entry for entry in found if entry.mesh.refined == refined]
        own = next(entry for entry in series if entry.mesh.fineness == 1.0)
        finest = max(series, key=lambda entry: entry.mesh.fineness)
        for quantity in QUANTITIES:
            here, there = own.estimates.get(quantity.name), finest.estimates.get(quantity.name)
            if here and there and there.mean:
                share = here.mean / there.mean
                parts = (here.error / there.mean, share * there.error / there.mean)
                yield Departure(quantity, refined, share - 1.0, math.hypot(*parts))

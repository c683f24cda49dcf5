"""Figures that components declare of their outputs, each under the name of its component."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from .names import of_component
from .roles import elements
from .values import extreme


@dataclass(frozen=True)
class ReportedMetric:
    """A declared metric and how it is shown.

    Attributes
    ----------
    metric : Metric
        The figure.
    unit : str
        Unit on the screen.
    decimals : int
        Decimals on the screen.
    """

    metric: Metric
    unit: str
    decimals: int


def reported(run: StoredRun) -> Iterator[ReportedMetric]:
    """Yield the figures that the components declare, as far as the results have the outputs.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    units = {column.name.partition("[")[0]: column.unit for column in run.columns}
    for component, facts in run.provenance["components"].items():
        for variable, told in facts.get("variables", {}).items():
            name = f"{component}.{variable}"
            for figure in told.get("reported", ()):
                if figure["statistic"] not in _STATISTICS:  # of a later version
                    continue
                value = _value(run, name, figure["statistic"])
                if value is not None:
                    words = of_component(component, figure["name"])
                    metric = Metric(words, value, units.get(name, "1"))
                    yield ReportedMetric(metric, figure["unit"], figure["decimals"])


def _value(run: StoredRun, name: str, statistic: str) -> float | None:
    """Return a statistic of an output; of an array, the largest of its elements'."""
    if name in run.series and statistic == "largest":
        return extreme(run, name)[0]
    several = [run.series[name]] if name in run.series else elements(run, name)
    return max((float(_STATISTICS[statistic](values)) for values in several), default=None)


def _first(values: NDArray[np.float64]) -> float:
    return float(values[0])


def _last(values: NDArray[np.float64]) -> float:
    return float(values[-1])


_STATISTICS: Mapping[str, Any] = {
    "largest": np.max,
    "least": np.min,
    "first": _first,
    "last": _last,
}

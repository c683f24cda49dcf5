"""The result of a back-analysis."""

import platform
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ...core.results.columns import result_column, result_table
from ...core.results.metric import Metric
from ...core.results.run_folder import RUN, SUMMARY
from ...files import write_json
from ...metrics.percentiles import borne
from ...sites.rockfall.preparation import PreparedSlope
from ...tables import Table, digits
from ...versions import versions
from ..frame import FloatArray, Result
from .files import SAMPLES, inferred_facts, write_details
from .forecast import CONFIDENCE, SHARES, Forecast
from .inferred import Inferred
from .likelihood import ANYTHING, held_out
from .parameters import parts_of, unit_of

MATERIALS = "calibrated.toml"
FOLDS = 5
"""Parts into which the end points are divided for the cross-validation."""
_FEWEST_EFFECTIVE = 100
"""Independent samples below which the intervals are rough."""
_INNER = 0.8
"""Part of the rocks that the interval of the cross-validation holds."""


class BackAnalysisResult(Result):
    """Parameters of the ground with their uncertainty, fit, cross-validation and forecast.

    Attributes
    ----------
    slope : PreparedSlope
        On which the rocks were released.
    inferred : Inferred
        Samples of the parameters, and the measured values.
    fitted : Forecast
        End points on that slope.
    forecast : Forecast or None
        End points on another one.
    wall_time : float
        Time (s) that all took.
    """

    kind = "rockfall-calibration"

    def __init__(
        self,
        slope: PreparedSlope,
        inferred: Inferred,
        fitted: Forecast,
        forecast: Forecast | None,
        wall_time: float,
    ) -> None:
        super().__init__()
        self.slope = slope
        self.inferred = inferred
        self.fitted = fitted
        self.forecast = forecast
        self.wall_time = wall_time

    @property
    def name(self) -> str:
        """Name of the slope of the data, or of its file."""
        return self.slope.name

    @property
    def parameters(self) -> dict[str, tuple[float, float, float]]:
        """Median and interval (SI) of each parameter by name."""
        tail = 50.0 * (1.0 - CONFIDENCE)
        found = np.percentile(self.inferred.values, [50.0, tail, 100.0 - tail], axis=0).T
        return {
            entry.name: (float(middle), float(low), float(high))
            for entry, (middle, low, high) in zip(self.inferred.parameters, found, strict=True)
        }

    @cached_property
    def held_out_ranks(self) -> FloatArray:
        """Part of the rocks that end before each measured one, foretold from the other folds."""
        ends = self.inferred.end_points
        fold, weights = held_out(self.inferred.posterior.pointwise, FOLDS, self.inferred.seed)
        below = np.array([(self.fitted.ends <= x).mean(axis=1) for x in ends])
        kept = weights[:, self.fitted.numbers]
        kept = kept / kept.sum(axis=1, keepdims=True)
        return np.array([below[i] @ kept[int(fold[i])] for i in range(len(ends))])

    @property
    def covered(self) -> float:
        """Part of the end points within the inner 80 % that is foretold without their fold."""
        tail = 0.5 * (1.0 - _INNER)
        ranks = self.held_out_ranks
        return float(((ranks >= tail) & (ranks <= 1.0 - tail)).mean())

    def metric_list(self) -> list[Metric]:
        """Return each parameter with its interval, percentiles of fit and forecast, validation."""
        return list(self._metrics())

    def _metrics(self) -> Iterator[Metric]:
        for name, (middle, low, high) in self.parameters.items():
            unit = unit_of(name)
            yield Metric(f"{name}", middle, unit)
            yield Metric(f"{name}.low", low, unit)
            yield Metric(f"{name}.high", high, unit)
        for share, value in self._measured.items():
            yield Metric(f"measured.x.p{100 * share:.0f}", value, "m")
        for prefix, made in (("fit", self.fitted), ("forecast", self.forecast)):
            for share, ends in made.percentiles if made else ():
                for suffix, value in zip(("", ".low", ".high"), ends, strict=True):
                    if not np.isfinite(value):  # beyond the profile
                        continue
                    yield Metric(f"{prefix}.x.p{100 * share:.0f}{suffix}", value, "m")
        yield Metric("cross_validation.inner_80_percent", self.covered)
        yield Metric("samples.effective", self.inferred.posterior.effective)

    @property
    def _measured(self) -> dict[float, float]:
        """Percentiles of the measured end points (m), as far as their number bears them."""
        ends = self.inferred.end_points
        return {
            share: float(np.percentile(ends, 100.0 * share)) for share in borne(SHARES, len(ends))
        }

    @property
    def summary(self) -> str:
        """Number of parameters and of end points in one line."""
        return f"{len(self.parameters)} parameters from {len(self.inferred.end_points)} end points"

    @property
    def warnings(self) -> list[str]:
        """Reasons for doubts about the parameters, a sentence each."""
        found = []
        if self.inferred.posterior.effective < _FEWEST_EFFECTIVE:
            found.append(
                f"the samples are worth {self.inferred.posterior.effective:.0f} independent ones: "
                "the intervals are rough, take more steps"
            )
        for entry in self.inferred.parameters:
            places = self.inferred.posterior.places[:, self.inferred.parameters.index(entry)]
            if np.quantile(places, 0.5) < 0.05 or np.quantile(places, 0.5) > 0.95:
                found.append(f"{entry.name} lies at the end of its range: widen it with fit=...")
        for made in (self.fitted, self.forecast):
            if made and made.left > 0.01:
                part = 100.0 * made.left
                found.append(f"{part:.0f} % of the rocks leave the profile {made.name}")
        return found

    @property
    def notes(self) -> list[str]:
        """Model of the likelihood, and how the samples were drawn."""
        observed = self.inferred.observed
        posterior = self.inferred.posterior
        scatter = ", ".join(
            f"{entry.name} ± {entry.scatter:.3g} {entry.unit}" for entry in observed
        )
        return [
            f"A measured value is a computed one with a normal deviation ({scatter}); "
            f"{100 * ANYTHING:.0f} % may be anything. {self.inferred.trials} trials with common "
            "random numbers for each set of parameters.",
            f"{len(posterior.places)} samples (emcee), worth {posterior.effective:.0f} "
            f"independent ones; {100 * posterior.accepted:.0f} % of the steps accepted; "
            f"{self.wall_time:.0f} s.",
            f"Intervals hold {100 * CONFIDENCE:.0f} % of the posterior. Cross-validation in "
            f"{FOLDS} parts: {100 * self.covered:.0f} % of the end points lie within the inner "
            f"{100 * _INNER:.0f} % that the others foretell.",
        ]

    def tables(self) -> list[Table]:
        """Return the parameters, and percentiles of the end points.

        Returns
        -------
        list of Table
            Median, interval and range of each parameter; measured, fitted and foretold x.
        """
        return [self._parameter_table(), self._end_table()]

    def _parameter_table(self) -> Table:
        columns = ["parameter", "unit", "median", "low", "high", "sought from", "to"]
        table = Table(columns, right=columns[2:], title="parameters")
        for entry, (name, found) in zip(
            self.inferred.parameters, self.parameters.items(), strict=True
        ):
            unit = unit_of(name)
            numbers = (*found, entry.low, entry.high)
            table.add(name, unit, *(digits(number) for number in numbers))
        return table

    def _end_table(self) -> Table:
        made = [self.fitted, *([self.forecast] if self.forecast else [])]
        columns = ["x (m) at", "measured", *(f"{entry.name}" for entry in made)]
        if len(made) == 2 and made[0].name == made[1].name:
            columns[-1] = f"{made[1].name}, forecast"
        table = Table(columns, right=columns[1:], title="end points")
        measured = self._measured
        for share in SHARES:
            cells = [_with_interval(entry.percentile(share)) for entry in made]
            own = digits(measured[share]) if share in measured else "-"
            table.add(f"{100 * share:.0f} %", own, *cells)
        if len(measured) < len(SHARES):
            count = len(self.inferred.end_points)
            table.notes.append(f"-: {count} measured end points do not bear this percentile")
        return table

    def to_arrow(self) -> Any:
        """Return the samples of the posterior.

        Returns
        -------
        pyarrow.Table
            A column for each parameter, and the logarithm of the likelihood.
        """
        columns = [
            result_column(entry.name, values, unit_of(entry.name), "sample")
            for entry, values in zip(self.inferred.parameters, self.inferred.values.T, strict=True)
        ]
        heights = self.inferred.posterior.pointwise.sum(axis=1)
        words = "logarithm of the likelihood"
        return result_table([*columns, result_column("log_likelihood", heights, "1", words)])

    def write_files(self, folder: Path) -> Sequence[Path]:
        """Write samples, materials, summary and ``run.json`` into a folder, and return them."""
        import pyarrow.parquet
        import tomli_w

        pyarrow.parquet.write_table(self.to_arrow(), folder / SAMPLES, compression="zstd")
        materials = {"material": self._materials()}
        (folder / MATERIALS).write_text(tomli_w.dumps(materials), encoding="utf-8")
        write_json(folder / SUMMARY, [metric.as_entry() for metric in self.metric_list()])
        details = write_details(folder, self.inferred, self.fitted, self.forecast)
        file = self.slope.source.file
        content = {
            "status": "complete",
            "kind": self.kind,
            "name": self.name,
            "ended": datetime.now(UTC).isoformat(timespec="seconds"),
            "site_file": str(file) if file else None,
            "site": self.slope.site.model_dump(mode="json", by_alias=True),
            "nodes": [
                {"x": node.x, "y": node.y, "material": node.material} for node in self.slope.nodes
            ],
            "warnings": self.warnings,
            "notes": self.notes,
            "wall_time": self.wall_time,
            "forecast": self.forecast.name if self.forecast else None,
            **inferred_facts(self.inferred),
            "platform": platform.platform(),
            "versions": versions("numpy", "numba", "scipy", "emcee"),
        }
        write_json(folder / RUN, content)
        return [*(folder / name for name in (SAMPLES, MATERIALS, SUMMARY, RUN)), *details]

    def _materials(self) -> dict[str, dict[str, Any]]:
        """Return the materials with the values of the likeliest sample, as a site has them."""
        made: dict[str, dict[str, Any]] = {}
        for name, material in self.slope.materials.items():
            values = material.model_dump(exclude_none=True, exclude={"like", "source"})
            made[name] = {**values, "description": "back-analysis: likeliest sample"}
        for entry, value in zip(self.inferred.parameters, self.inferred.best, strict=True):
            name, quantity, part = parts_of(entry.name)
            if name in made and part:
                made[name][quantity][part] = float(value)
            elif name in made:
                made[name][quantity] = float(value)
        return made


def _with_interval(found: tuple[float, float, float]) -> str:
    value, low, high = (digits(number) if np.isfinite(number) else "beyond" for number in found)
    return f"{value} [{low}, {high}]"

"""The result of a wave matching."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.components.common.units import kN, mm

from ...core.results.columns import result_column, result_table
from ...core.results.metric import Metric
from ...core.results.run_folder import RUN, SUMMARY
from ...files import write_json
from ...tables import Table, digits
from ...versions import versions
from ..frame import FloatArray, Result
from ..pile.files import write_tables
from .measured import MeasuredBlow
from .model import WaveModel

CONFIDENCE = 1.96
"""Standard errors of an interval of 95 %."""
_LOOSE = 0.7
"""Standard error of a logarithm from which a parameter is not determined: a factor of 4."""
_UNLIKE = 0.15
"""Part by which force and Z v may differ at the first peak."""
_SHOWN = {"N": (kN, "kN"), "m": (mm, "mm"), "s/m": (1.0, "s/m")}


@dataclass(frozen=True)
class SoilEstimate:
    """A parameter as the measurement gives it.

    Attributes
    ----------
    name, unit : str
        Identifier and SI unit.
    value : float
        Best value.
    error : float
        Standard error of its logarithm.
    at_bound : bool
        Whether the search was stopped there.
    """

    name: str
    unit: str
    value: float
    error: float
    at_bound: bool

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the interval of 95 %, in the unit of the value."""
        factor = math.exp(min(50.0, CONFIDENCE * self.error))
        return self.value / factor, self.value * factor


class PileMatch(Result):
    """A measured blow and the soil with which it is computed best.

    Attributes
    ----------
    model : WaveModel
        The pile under the measured wave.
    blow : MeasuredBlow
        Measurement.
    estimates : list of SoilEstimate
        Parameters, and at the end the whole resistance.
    up : array of float, shape (steps,)
        Force of the computed wave upwards (N).
    """

    kind = "pile matching"

    def __init__(
        self,
        model: WaveModel,
        blow: MeasuredBlow,
        estimates: Sequence[SoilEstimate],
        up: FloatArray,
    ) -> None:
        super().__init__()
        self.model = model
        self.blow = blow
        self.estimates = list(estimates)
        self.up = up

    @property
    def name(self) -> str:
        """Name of the file of the measurement."""
        return self.blow.name

    @property
    def departure(self) -> float:
        """Root mean square of computed less measured wave, over the largest force."""
        left = self.up - self.model.up
        return float(np.sqrt(np.mean(left**2)) / np.abs(self.blow.force).max())

    def metric_list(self) -> list[Metric]:
        """Return parameters with their intervals, and the departure of the waves."""
        listed = [Metric("departure", self.departure)]
        for one in self.estimates:
            low, high = one.interval
            listed.append(Metric(one.name, one.value, one.unit))
            listed.append(Metric(f"{one.name}.low", low, one.unit))
            listed.append(Metric(f"{one.name}.high", high, one.unit))
        return listed

    @property
    def summary(self) -> str:
        """Resistance with its interval in one line."""
        low, high = self.estimates[-1].interval
        return (
            f"R_u {self.estimates[-1].value / kN:.0f} kN ({low / kN:.0f} to {high / kN:.0f} kN), "
            f"waves match to {100.0 * self.departure:.2g} % of the largest force"
        )

    @property
    def notes(self) -> list[str]:
        """Resistance, and what the intervals of the numbers mean."""
        return [
            self.summary,
            "intervals of 95 % from least squares, widened by the autocorrelation of what is left; "
            "they hold for this model of the soil and this pile, and say nothing of others",
        ]

    @property
    def warnings(self) -> list[str]:
        """Parameters that the measurement does not determine, and doubts about it."""
        sentences = [
            f"{one.name} is not determined by this measurement: the wave hardly hangs on it"
            for one in self.estimates
            if one.error > _LOOSE and not one.at_bound
        ]
        sentences += [
            f"{one.name} has run to the end of its range: take another start, or other layers"
            for one in self.estimates
            if one.at_bound
        ]
        peak = int(np.argmax(self.model.down))
        force = self.model.down[peak] + self.model.up[peak]
        motion = self.model.down[peak] - self.model.up[peak]
        if abs(force / motion - 1.0) > _UNLIKE:
            sentences.append(
                f"force and Z v differ by {100.0 * (force / motion - 1.0):+.0f} % at the first "
                "peak: look at area, modulus and density of the pile, or at the gauges"
            )
        return sentences

    def tables(self) -> list[Table]:
        """Return the parameters with start and interval."""
        titles = ["start", "matched", "95 % from", "to"]
        table = Table(["parameter", *titles, "unit"], right=titles, title="wave matching")
        starts = [one.start for one in self.model.sought]
        whole = sum(one.start for one in self.model.sought if one.unit == "N")
        for one, start in zip(self.estimates, [*starts, whole], strict=True):
            size, unit = _SHOWN[one.unit]
            values = [start, one.value, *one.interval]
            table.add(one.name, *(digits(value / size) for value in values), unit)
        return [table]

    def to_arrow(self) -> Any:
        """Return measured and computed waves, force and Z v over time.

        Returns
        -------
        pyarrow.Table
            Means over the travel time of a segment.
        """
        down, up = self.model.down, self.model.up
        return result_table(
            [
                result_column("time", self.model.time, "s", "time of the measurement"),
                result_column("measured.force", down + up, "N", "force at the gauge"),
                result_column("measured.zv", down - up, "N", "impedance times velocity there"),
                result_column("measured.wave_up", up, "N", "force of the wave upwards"),
                result_column("computed.force", down + self.up, "N", "force at the gauge"),
                result_column("computed.zv", down - self.up, "N", "impedance times velocity"),
                result_column("computed.wave_up", self.up, "N", "force of the wave upwards"),
            ]
        )

    def write_files(self, folder: Path) -> list[Path]:
        """Write curves, summary and ``run.json`` into a folder."""
        files = write_tables({"waves": self.to_arrow()}, folder)
        write_json(folder / SUMMARY, [metric.as_entry() for metric in self.metric_list()])
        content = {
            "status": self.status,
            "kind": self.kind,
            "name": self.name,
            "measurement": self.blow.name,
            "site_file": str(self.model.pile.source.file),
            "warnings": self.warnings,
            "versions": versions("numpy", "numba", "scipy", "pyarrow"),
        }
        write_json(folder / RUN, content)
        return [*files, folder / SUMMARY, folder / RUN]

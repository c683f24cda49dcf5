"""The result of a study."""

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from ...core.results.metric import Metric
from ...metrics.percentiles import borne
from ...tables import Table
from ..frame import Result, shared_folder
from .designs import SAMPLED, SOBOL
from .files import NAMES, run_table, write_files
from .records import StudyRecords, common_reasons, values_of
from .statistics import FEWEST_FOR_SOBOL, mean_of, percentiles
from .tables import all_tables, notes

_MOST_TEXTS = 5
"""Different warnings of runs that are told."""


class StudyResult(Result):
    """Runs of a study with means, percentiles, exceedance and sensitivity.

    Attributes
    ----------
    records : StudyRecords
        All runs, with what varies.
    metric_names : tuple of str
        Identifiers of the metrics that are told; the runs have all.
    asked, shares : tuple of float
        Parts of the population whose percentiles were wanted, and those that the runs bear.
    origin : mapping of str to Any
        What was studied: ``case``, ``project_file`` or ``system_file``, and the request.
    effort : mapping of str to Any
        Workers, scheduler, and time (s) that the runs took.
    """

    kind = "study"
    picture_folder = "."

    def __init__(
        self,
        name: str,
        records: StudyRecords,
        metric_names: Sequence[str],
        shares: Sequence[float],
        origin: Mapping[str, Any],
        effort: Mapping[str, Any],
    ) -> None:
        super().__init__()
        self._name = name
        self.records = records
        self.metric_names = tuple(metric_names)
        self.shares = tuple(borne(shares, len(records.sample)))
        self.asked = tuple(shares)
        self.origin = origin
        self.effort = effort

    @classmethod
    def opened(cls, folder: str | Path) -> AbstractContextManager[Path]:
        """Open the folder of the results, in which other files stay as they are."""
        return shared_folder(folder, NAMES)

    @property
    def name(self) -> str:
        """Name of the system that was studied."""
        return self._name

    def metric_list(self) -> list[Metric]:
        """Return numbers of runs, and mean and percentiles of each metric over the sample."""
        records = self.records
        failed = len(records.runs) - len(records.complete)
        found = [Metric("runs", len(records.runs)), Metric("failed runs", failed)]
        for metric in self.metric_names:
            values = values_of(records.sample, metric)
            if len(values) and records.design in SAMPLED:
                found += self._of_metric(metric, values)
        return found

    def _of_metric(self, metric: str, values: Any) -> list[Metric]:
        name = self.records.names[metric]
        mean = mean_of(values)
        numbers: dict[str, float | None] = {
            "mean": mean.value,
            "mean low": mean.low,
            "mean high": mean.high,
            "deviation": mean.deviation,
        }
        for entry in percentiles(values, self.shares):
            which = f"p{100 * entry.share:g}"
            numbers |= {which: entry.value, f"{which} low": entry.low, f"{which} high": entry.high}
        return [
            Metric(f"{name.words} {which}", float(value), name.unit)
            for which, value in numbers.items()
            if value is not None and np.isfinite(value)
        ]

    @property
    def summary(self) -> str:
        """Number of points and runs in one line."""
        records = self.records
        points = len({run.design for run in records.runs})
        failed = len(records.runs) - len(records.complete)
        ended = f", {failed} of them without a result" if failed else ""
        return f"{points} designs, {len(records.runs)} runs{ended}"

    @property
    def notes(self) -> list[str]:
        """Meaning of the numbers, and effort."""
        return [*notes(self.records, self.shares), *self._about_sobol()]

    def _about_sobol(self) -> list[str]:
        if self.records.design != SOBOL:
            return []
        if any(not run.is_complete for run in self.records.runs):
            return ["no Sobol indices: they need all runs of the design"]
        count = sum(run.role == "A" for run in self.records.runs)
        if count < FEWEST_FOR_SOBOL:
            return [f"no Sobol indices: they need {FEWEST_FOR_SOBOL} samples at least"]
        return []

    @property
    def warnings(self) -> list[str]:
        """Runs without a result, percentiles that are not borne, and doubts about runs."""
        found = [*self._about_failures(), *self._about_packings()]
        if lost := [share for share in self.asked if share not in self.shares]:
            told = ", ".join(f"{100 * share:g} %" for share in lost)
            count = len(self.records.sample)
            found.append(f"{told}: the {count} runs with a result do not bear these percentiles")
        said = Counter(text for run in self.records.complete for text in _kinds(run.warnings))
        most = said.most_common(_MOST_TEXTS)
        found += [f"{number} of {len(self.records.complete)} runs: {text}" for text, number in most]
        if len(said) > len(most):
            found.append(f"and {len(said) - len(most)} other warnings, in runs.csv")
        return found

    def _about_failures(self) -> list[str]:
        failed = [run for run in self.records.runs if not run.is_complete]
        if not failed:
            return []
        reason, number = common_reasons(failed)[0]
        return [
            f"{len(failed)} of {len(self.records.runs)} runs have no result and are left out of "
            f"all means and percentiles; {number} of them: {reason}"
        ]

    def _about_packings(self) -> list[str]:
        """Return a doubt about packings that change nothing, or of which there is only one."""
        seeds = {run.seed for run in self.records.runs}
        if len(seeds) > 1 and self._seed_has_no_effect():
            return ["the packing's number changes nothing: runs that differ in it alone are equal"]
        if self.records.design in SAMPLED and len(seeds) == 1 and seeds != {None}:
            return ["one packing of the sand: its scatter is not in the percentiles (seeds=...)"]
        return []

    def _seed_has_no_effect(self) -> bool:
        """Tell whether all points with several packings have equal metrics in all of them."""
        several = [
            done
            for _, runs in self.records.points
            if len(done := [run for run in runs if run.is_complete]) > 1
        ]
        return bool(several) and all(
            len({tuple(run.metrics.items()) for run in runs}) == 1 for runs in several
        )

    def tables(self) -> list[Table]:
        """Return means of the designs or percentiles of the sample, sensitivity, and failures."""
        return all_tables(self.records, self.metric_names, self.shares)

    def to_arrow(self) -> Any:
        """Return a row for each run: point, packing, inputs, status, and all metrics in SI."""
        return run_table(self.records)

    def write_files(self, folder: Path) -> list[Path]:
        """Write all tables into a folder, and return the files."""
        return write_files(self, folder)


def _kinds(texts: Sequence[str]) -> list[str]:
    """Return warnings without what follows their first colon: numbers differ from run to run."""
    return list(dict.fromkeys(text.partition(": ")[0] for text in texts))

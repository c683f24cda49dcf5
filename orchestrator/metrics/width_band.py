"""Table of the band that the rules of the effective width make of the headlines of a run."""

from collections.abc import Mapping, Sequence
from typing import Any

from ..core.results.reading import StoredRun
from ..tables import Table
from .comparison import ShownMetric, shown_metrics

BAND = ("low", "run", "high")
"""Names of the runs of a band: with the smallest width, that of the run, and the largest."""


def width_band_table(run: StoredRun) -> Table:
    """Return the headlines with the smallest and the largest effective width of all rules.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    Table
        Every number of the run's own table; without a row where the band was not computed.
    """
    told = run.provenance.get("band", {})
    found: list[Mapping[str, Any]] = [told[name] for name in BAND if name in told]
    titles = [f"{entry['width']:.2f} m" for entry in found]
    if found:
        titles[BAND.index("run")] += " (this run)"
    made = Table(("quantity", "unit", *titles), right=titles, title="band of the effective width")
    for shown in shown_metrics(run) if found else ():
        made.add(shown.label, shown.unit, *_values(shown, found))
    return made


def _values(shown: ShownMetric, found: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a metric as the runs of a band have it; nothing where one has none."""
    values = [entry["metrics"].get(shown.name) for entry in found]
    return ["" if value is None else shown.written(float(value)) for value in values]

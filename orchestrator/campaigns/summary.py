"""Metrics of a campaign: ends of the trials, and every line and barrier with percentiles."""

from collections.abc import Iterator, Sequence

from rockshed.components.slope_rockfall.records import OUTCOME

from ..core.results.metric import Metric
from .campaign import Campaign, TrialRecords
from .passages import ENDS, QUANTITIES, LinePassages, PassageQuantity

_LARGEST = (
    ("height", OUTCOME.height, "m"),
    ("speed", OUTCOME.speed, "m/s"),
    ("energy", OUTCOME.kinetic, "J"),
)


def metrics_of(
    campaign: Campaign, records: TrialRecords, lines: Sequence[LinePassages]
) -> Iterator[Metric]:
    """Yield the metrics of a campaign.

    Parameters
    ----------
    campaign : Campaign
        That was computed.
    records : TrialRecords
        Of all its trials.
    lines : sequence of LinePassages
        Of all its lines.

    Yields
    ------
    Metric
        ``trials``, ``end.at_rest``, ..., ``line.NAME.energy.p95.low``, ...
    """
    ends = records.outcomes[:, OUTCOME.end].astype(int)
    yield Metric("trials", campaign.trials)
    for code, words in ENDS.items():
        yield Metric(f"end.{words.replace(' ', '_')}", int((ends == code).sum()))
    yield Metric("events", int(records.outcomes[:, OUTCOME.events].sum()))
    for name, column, unit in _LARGEST:
        yield Metric(f"largest.{name}", float(records.outcomes[:, column].max()), unit)
    for line in lines:
        yield from _of_line(line)


def _of_line(line: LinePassages) -> Iterator[Metric]:
    prefix = f"{'line' if line.barrier is None else 'barrier'}.{line.name}"
    low, high = line.interval
    yield Metric(f"{prefix}.passing", line.count)
    yield Metric(f"{prefix}.share", line.share)
    yield Metric(f"{prefix}.share.low", low)
    yield Metric(f"{prefix}.share.high", high)
    for name, number in (line.barrier or {}).items():
        yield Metric(f"{prefix}.{name}", number)
    for quantity in QUANTITIES:
        if line.count:
            yield from _of_quantity(f"{prefix}.{quantity.name}", line, quantity)


def _of_quantity(prefix: str, line: LinePassages, quantity: PassageQuantity) -> Iterator[Metric]:
    values = line.values[quantity.name]
    yield Metric(f"{prefix}.mean", float(values.mean()), quantity.unit)
    if line.count > 1:
        yield Metric(f"{prefix}.deviation", float(values.std(ddof=1)), quantity.unit)
    for found in line.percentiles(quantity.name):
        name = f"{prefix}.p{100 * found.share:.0f}"
        yield Metric(name, found.value, quantity.unit)
        if line.numbers:
            yield Metric(f"{name}.trial", line.trial_of(quantity.name, found.share))
        yield Metric(f"{name}.low", found.low, quantity.unit)
        yield Metric(f"{name}.high", found.high, quantity.unit)

"""Tables of a campaign for a person."""

from collections.abc import Iterator, Sequence

from ...campaigns.passages import QUANTITIES, LinePassages, PassageQuantity
from ...metrics.percentiles import CONFIDENCE, SHARES, Percentile, needed
from ...tables import Table, digits

_TITLES = [f"{100 * share:.0f} %" for share in SHARES]


def line_tables(lines: Sequence[LinePassages]) -> list[Table]:
    """Return a table for each line and barrier.

    Parameters
    ----------
    lines : sequence of LinePassages
        In the order of the site.

    Returns
    -------
    list of Table
        Named by the line and by who passes it; a row for each quantity with mean, standard
        deviation, and percentiles with their intervals. Empty where no rock passes.
    """
    return [_table(line) for line in lines]


def _table(line: LinePassages) -> Table:
    columns = ["", "unit", "mean", "±", *_TITLES]
    table = Table(columns, right=("mean", "±", *_TITLES), title=f"{line.name}  {_words(line)}")
    for quantity in QUANTITIES:
        if line.count:
            table.add(*_cells(line, quantity))
    return table


def _words(line: LinePassages) -> str:
    if line.barrier is not None:
        return (
            f"barrier: {line.count} of {line.trials} rocks arrive, "
            f"{line.barrier['stopped']} are stopped, {line.barrier['overtopped']} overtop, "
            f"{line.barrier['broken_through']} break through"
        )
    share, low, high = (100.0 * part for part in (line.share, *line.interval))
    return f"{line.count} of {line.trials} rocks pass, {share:.4g} % [{low:.4g}, {high:.4g}]"


def _cells(line: LinePassages, quantity: PassageQuantity) -> Iterator[str]:
    values = line.values[quantity.name] / quantity.scale
    yield quantity.words
    yield quantity.shown
    yield _number(values.mean())
    yield _number(values.std(ddof=1)) if len(values) > 1 else ""
    by_share = {found.share: found for found in line.percentiles(quantity.name)}
    for share in SHARES:
        yield _with_interval(by_share[share], quantity.scale) if share in by_share else "-"


def _with_interval(found: Percentile, scale: float) -> str:
    value, low, high = (_number(x / scale) for x in (found.value, found.low, found.high))
    return f"{value} [{low}, {high}]"


def _number(value: float) -> str:
    """Write three digits, but none that are rounding: a rock that rolls has the height 0."""
    return digits(round(value, 6))


def notes(has_lines: bool, hypercube: bool) -> list[str]:
    """Return remarks on the intervals in the tables.

    Parameters
    ----------
    has_lines : bool
        Whether the site has search lines or barriers.
    hypercube : bool
        Whether the trials are those of a Latin hypercube.

    Returns
    -------
    list of str
        A sentence each.
    """
    sentences = []
    if has_lines:
        sentences.append(
            "Percentiles are of the rocks that pass, at their first passage. [low, high]: "
            f"{100.0 * CONFIDENCE:.0f} % confidence interval, from order statistics."
        )
    if hypercube:
        sentences.append(
            "The intervals are those of independent trials; a Latin hypercube is usually more "
            "precise."
        )
    return sentences


def thin_lines(lines: Sequence[LinePassages]) -> list[str]:
    """Return the lines that so few rocks pass that a percentile of them has no interval.

    Parameters
    ----------
    lines : sequence of LinePassages
        Of a campaign.

    Returns
    -------
    list of str
        A sentence each.
    """
    sentences = []
    for line in lines:
        beyond = [share for share in SHARES if 0 < line.count < needed(share)]
        if beyond:
            words = ", ".join(f"{100 * share:.0f} %" for share in beyond)
            sentences.append(
                f"{line.name}: {line.count} rocks pass, which do not bear a percentile of "
                f"{words}: its interval has two bounds from {needed(beyond[0])} rocks on."
            )
    return sentences

"""What a campaign shows on the screen."""

from collections.abc import Iterator

from rich.markup import escape
from rich.table import Table

from ...commands.screen import plain_table
from .carrying_out import Finished
from .preparation import Prepared
from .results import QUANTITIES, Passing, Quantity
from .statistics import CONFIDENCE, SHARES, Percentile


def tables(done: Finished) -> Iterator[str | Table]:
    """Every line and barrier: who passes, then a row for each quantity with mean, deviation, and percentiles with intervals."""
    names = [f"{100 * share:.0f} %" for share in SHARES]
    for passing in done.passings:
        yield f"\n[bold]{escape(passing.name)}[/]  {escape(_words(passing, done.trials))}"
        if passing.count:
            made = plain_table("", "unit", "mean", "±", *names, right=("mean", "±", *names))
            for quantity in QUANTITIES:
                values = passing.values[quantity.name] / quantity.scale
                spread = _number(values.std(ddof=1)) if len(values) > 1 else ""
                made.add_row(
                    quantity.name.replace("_", " "),
                    quantity.shown,
                    _number(values.mean()),
                    spread,
                    *(_cell(found, quantity) for found in passing.percentiles(quantity.name)),
                )
            yield made


def _words(passing: Passing, trials: int) -> str:
    if passing.barrier is not None:
        kept = passing.barrier
        return (
            f"barrier: {passing.count} of {trials} rocks arrive, {kept['stopped']} are stopped, {kept['overtopped']} overtop, "
            f"{kept['broken_through']} break through"
        )
    return (
        f"{passing.count} of {trials} rocks pass, {100.0 * passing.share:.4g} % [{100.0 * passing.low:.4g}, "
        f"{100.0 * passing.high:.4g}]"
    )


def _cell(found: Percentile, quantity: Quantity) -> str:
    value, low, high = (
        "?" if v is None else _number(v / quantity.scale)
        for v in (found.value, found.low, found.high)
    )
    return escape(f"{value} [{low}, {high}]")


def _number(value: float) -> str:
    """Three digits, but none that are rounding: a rock that rolls has the height 0."""
    return f"{round(value, 6):.3g}"


def lines(made: Prepared, done: Finished) -> Iterator[str]:
    """What else there is to say, a sentence each."""
    ends = {
        figure.name.removeprefix("end.").replace("_", " "): figure.value
        for figure in done.figures
        if figure.name.startswith("end.")
    }
    listed = ", ".join(f"{number} {words}" for words, number in ends.items() if number)
    yield f"{done.trials} trials in {done.wall_time:.2f} s, seed {made.campaign.seed}: {listed}"
    if done.passings:
        yield (
            f"Percentiles are of the rocks that pass, at their first passage. [low, high]: {100.0 * CONFIDENCE:.0f} % "
            "confidence interval, from order statistics (?: the sample is too small for a bound)."
        )
    if made.site.hypercube:
        yield "The intervals are those of independent trials; a Latin hypercube is usually more precise."

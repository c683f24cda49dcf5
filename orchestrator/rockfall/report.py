"""What a campaign shows on the screen."""

from collections.abc import Iterator

from rich.markup import escape
from rich.table import Table

from ..screen import plain_table
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
                spread = f"{values.std(ddof=1):.3g}" if len(values) > 1 else ""
                made.add_row(quantity.name.replace("_", " "), quantity.shown, f"{values.mean():.3g}", spread,
                             *(_cell(found, quantity) for found in passing.percentiles(quantity.name)))
            yield made


def _words(passing: Passing, trials: int) -> str:
    if passing.barrier is not None:
        kept = passing.barrier
        return (f"barrier: {passing.count} of {trials} rocks arrive, {kept['stopped']} are stopped, {kept['overtopped']} overtop, "
                f"{kept['broken_through']} break through")
    return (f"{passing.count} of {trials} rocks pass, {100.0 * passing.share:.3g} % [{100.0 * passing.low:.3g}, "
            f"{100.0 * passing.high:.3g}]")


def _cell(found: Percentile, quantity: Quantity) -> str:
    bounds = ["?" if bound is None else f"{bound / quantity.scale:.3g}" for bound in (found.low, found.high)]
    return escape(f"{found.value / quantity.scale:.3g} [{bounds[0]}, {bounds[1]}]")


def lines(made: Prepared, done: Finished) -> Iterator[str]:
    """What else there is to say, a sentence each."""
    ends = {figure.name.removeprefix("end.").replace("_", " "): figure.value for figure in done.figures
            if figure.name.startswith("end.")}
    listed = ", ".join(f"{number} {words}" for words, number in ends.items() if number)
    yield f"{done.trials} trials in {done.wall_time:.2f} s, seed {made.campaign.seed}: {listed}"
    if done.passings:
        yield (f"Percentiles are of the rocks that pass, at their first passage. [low, high]: {100.0 * CONFIDENCE:.0f} % "
               "confidence interval, from order statistics (?: the sample is too small for a bound).")
    if made.site.hypercube:
        yield "The intervals are those of independent trials; a Latin hypercube is usually more precise."

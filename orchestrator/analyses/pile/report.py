"""What a pile shows on the screen."""

from collections.abc import Iterator, Sequence

from rich.table import Table

from rockshed.components.common.units import kJ, kN, mm

from ...commands.screen import plain_table
from .blows import FOOT, Blow, blow_figures
from .carrying_out import Finished
from .preparation import Prepared

MPa = 1e6
BALANCE = 1e-3
"""Part of the impact energy that may be missing in the balance."""
RESTLESS = 1e-2
"""Part of the impact energy that may still move the rod at the end of a blow's time."""
UNSPENT = 0.01
"""Part of its energy that a ram has spent at least at the end of its blow."""
_COLUMNS = (
    ("set", "set (mm)", mm, 2),
    ("blows_per_0.3_m", "blows / 0.3 m", 1.0, 1),
    ("head_force", "head force (kN)", kN, 1),
    ("compression", "compression (MPa)", MPa, 1),
    ("compression_depth", "at (m)", 1.0, 1),
    ("tension", "tension (MPa)", MPa, 1),
    ("tension_depth", "at (m)", 1.0, 1),
    ("transferred_energy", "transferred (kJ)", kJ, 3),
    ("energy_ratio", "of rated (%)", 0.01, 1),
    ("residual_force", "residual (kN)", kN, 1),
)
"""Figure, title, unit in SI, digits."""


def tables(made: Prepared, done: Finished) -> Iterator[str | Table]:
    """A row for each blow, then the bearing graph."""
    yield "\n[bold]blows[/]"
    yield _table(made, "blow", [(str(number), blow) for number, blow in enumerate(done.blows, 1)])
    if done.graph:
        yield "\n[bold]bearing graph[/]"
        yield _table(made, "R_u (kN)", [(f"{blow.resistance / kN:g}", blow) for blow in done.graph])


def _table(made: Prepared, title: str, listed: Sequence[tuple[str, Blow]]) -> Table:
    titles = [words for _, words, _, _ in _COLUMNS]
    shown = plain_table(title, *titles, right=(title, *titles))
    for name, blow in listed:
        values = {key: value for key, value, _ in blow_figures(made, blow)}
        shown.add_row(
            name,
            *(
                "refusal"
                if values[key] is None
                else f"{float(values[key] or 0.0) / size:.{digits}f}"
                for key, _, size, digits in _COLUMNS
            ),
        )
    return shown


def lines(made: Prepared, done: Finished) -> Iterator[str]:
    """What else there is to say, a sentence each."""
    total = sum(blow.set for blow in done.blows)
    worst = max(
        (abs(blow.unbalanced / blow.impact_energy) for blow in [*done.blows, *done.graph]),
        default=0.0,
    )
    yield (
        f"{len(done.blows)} blows, {total / mm:.1f} mm; rated energy {made.rated_energy / kJ:.4g} kJ, ram strikes with "
        f"{done.blows[0].impact_energy / kJ:.4g} kJ; wave from head to toe in {1e3 * made.travel_time:.3g} ms; computed in "
        f"{done.wall_time:.2f} s"
    )
    yield f"energy balance closed to {100.0 * worst:.2g} % of the impact energy; blows / 0.3 m = {FOOT:g} m / set"


def warnings(done: Finished) -> Iterator[str]:
    """What makes figures doubtful."""
    if any(
        abs(blow.unbalanced) > BALANCE * blow.impact_energy for blow in [*done.blows, *done.graph]
    ):
        yield "the balance of energy does not close to 0.1 %: raise segments"
    every = [*done.blows, *done.graph]
    moving = max(blow.moving / blow.impact_energy for blow in every)
    if moving > RESTLESS:
        yield (
            f"the rod still moves at the end of a blow, with {100.0 * moving:.2g} % of the impact energy: what comes later is "
            "not in the figures; raise time"
        )
    if any(blow.transferred < UNSPENT * blow.impact_energy for blow in every):
        yield "the ram has hardly given any energy to the rod when its time is over: raise time, or the stiffness of the cushion"

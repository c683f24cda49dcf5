"""Tables of a pile for a person."""

from collections.abc import Iterator, Sequence

from rockshed.components.common.units import kJ, kN, mm

from ...sites.pile.preparation import PreparedPile
from ...tables import Table
from .blows import FOOT, Blow
from .summary import blow_values

MPa = 1e6
"""Pascal in a megapascal."""
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
"""Value of a blow, title, size of its unit in SI, digits."""


def blow_table(pile: PreparedPile, blows: Sequence[Blow]) -> Table:
    """Return a row for each blow.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows : sequence of Blow
        One after the other.

    Returns
    -------
    Table
        Set, blow count, forces, stresses, energies.
    """
    named = [(str(number), blow) for number, blow in enumerate(blows, 1)]
    return _table(pile, "blows", "blow", named)


def graph_table(pile: PreparedPile, graph: Sequence[Blow]) -> Table:
    """Return a row for each ultimate resistance of the bearing graph.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    graph : sequence of Blow
        One for each resistance.

    Returns
    -------
    Table
        Set, blow count, forces, stresses, energies.
    """
    named = [(f"{blow.resistance / kN:g}", blow) for blow in graph]
    return _table(pile, "bearing graph", "R_u (kN)", named)


def _table(pile: PreparedPile, title: str, first: str, named: Sequence[tuple[str, Blow]]) -> Table:
    titles = [first, *(words for _, words, _, _ in _COLUMNS)]
    table = Table(titles, right=titles, title=title)
    for name, blow in named:
        table.add(name, *_cells(pile, blow))
    return table


def _cells(pile: PreparedPile, blow: Blow) -> Iterator[str]:
    values = {entry.name: entry.value for entry in blow_values(pile, blow)}
    for name, _, size, digits in _COLUMNS:
        value = values[name]
        yield "refusal" if value is None else f"{value / size:.{digits}f}"


def in_words(blows: Sequence[Blow]) -> str:
    """Return the number of blows in words.

    Parameters
    ----------
    blows : sequence of Blow
        One after the other.

    Returns
    -------
    str
        ``5 blows``.
    """
    return "1 blow" if len(blows) == 1 else f"{len(blows)} blows"


def notes(
    pile: PreparedPile, blows: Sequence[Blow], graph: Sequence[Blow], wall_time: float
) -> list[str]:
    """Return remarks on a pile.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows, graph : sequence of Blow
        One after the other, and of the bearing graph.
    wall_time : float
        That the blows took (s).

    Returns
    -------
    list of str
        A sentence each.
    """
    total = sum(blow.set for blow in blows)
    worst = max(abs(blow.unbalanced / blow.impact_energy) for blow in (*blows, *graph))
    return [
        f"{in_words(blows)}, {total / mm:.1f} mm; rated energy {pile.rated_energy / kJ:.4g} kJ, "
        f"ram strikes with {blows[0].impact_energy / kJ:.4g} kJ; wave from head to toe in "
        f"{1e3 * pile.travel_time:.3g} ms; computed in {wall_time:.2f} s",
        f"energy balance closed to {100.0 * worst:.2g} % of the impact energy; "
        f"blows / 0.3 m = {FOOT:g} m / set",
    ]


def warnings(blows: Sequence[Blow]) -> list[str]:
    """Return the reasons for doubts about blows.

    Parameters
    ----------
    blows : sequence of Blow
        Those of the bearing graph too.

    Returns
    -------
    list of str
        A sentence each.
    """
    sentences = []
    if any(abs(blow.unbalanced) > BALANCE * blow.impact_energy for blow in blows):
        sentences.append("the balance of energy does not close to 0.1 %: raise segments")
    moving = max(blow.moving / blow.impact_energy for blow in blows)
    if moving > RESTLESS:
        sentences.append(
            f"the rod still moves at the end of a blow, with {100.0 * moving:.2g} % of the impact "
            "energy: what comes later is not in the figures; raise time"
        )
    if any(blow.transferred < UNSPENT * blow.impact_energy for blow in blows):
        sentences.append(
            "the ram has hardly given any energy to the rod when its time is over: raise time, or "
            "the stiffness of the cushion"
        )
    return sentences

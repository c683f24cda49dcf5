"""Tables of a pile for a person."""

from collections.abc import Iterator, Sequence

from rockshed.components.common.units import kJ, kN, mm

from ...formulas.pile_driving import GATES_SOURCE, HILEY_SOURCE
from ...sites.pile.preparation import PreparedPile
from ...tables import Table
from .blows import FOOT, BearingPoint, Blow
from .drivability import Stage
from .formulas import stroke_of
from .rods import CUSTOMARY_SOURCE, RodBlow, answer
from .summary import BlowValue, blow_values, formula_values, stage_values

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


def graph_tables(pile: PreparedPile, graph: Sequence[BearingPoint]) -> list[Table]:
    """Return a row for each ultimate resistance, with dynamic formulas beside it.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    graph : sequence of BearingPoint
        One for each resistance.

    Returns
    -------
    list of Table
        Set, blow count, forces, stresses, energies at the first blow, at the last one where there
        are several, and resistances by formulas.
    """
    first = [(f"{point.first.resistance / kN:g}", point.first) for point in graph]
    last = [(f"{point.last.resistance / kN:g}", point.last) for point in graph]
    tables = [_table(pile, "bearing graph", "R_u (kN)", first)]
    if graph[0].last is not graph[0].first:
        tables.append(_table(pile, f"bearing graph, blow {pile.site.blows}", "R_u (kN)", last))
    return [*tables, formula_table(pile, [blow for _, blow in last])]


def formula_table(pile: PreparedPile, blows: Sequence[Blow]) -> Table:
    """Return the resistances that dynamic formulas make of computed sets, beside those computed.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows : sequence of Blow
        One for each resistance.

    Returns
    -------
    Table
        Resistance, set, and the formulas with their deviation.
    """
    titles = [
        *("R_u (kN)", "set (mm)", "Hiley (kN)", "Hiley - R_u (%)"),
        *("Gates, FHWA (kN)", "Gates - R_u (%)"),
    ]
    table = Table(titles, right=titles, title="dynamic formulas for the computed sets")
    for blow in blows:
        cells = [f"{blow.resistance / kN:g}", f"{blow.set / mm:.2f}"]
        for entry in formula_values(pile, blow):
            if entry.value is None:
                cells += ["-", "-"]
            else:
                deviation = 100.0 * (entry.value / blow.resistance - 1.0)
                cells += [f"{entry.value / kN:.0f}", f"{deviation:+.0f}"]
        table.add(*cells)
    stroke = stroke_of(pile)
    table.notes = [
        f"Hiley: efficiency {stroke.efficiency:g}, restitution {stroke.restitution:g} of the "
        f"softest cushion, quake {stroke.quake / mm:g} mm. Source: {HILEY_SOURCE}",
        f"Gates: rated energy {stroke.rated_energy / kJ:.4g} kJ. Source: {GATES_SOURCE}",
    ]
    return table


def stage_table(stages: Sequence[Stage]) -> Table:
    """Return a row for each penetration.

    Parameters
    ----------
    stages : sequence of Stage
        Of the drivability analysis, one at least.

    Returns
    -------
    Table
        Resistances, blows, stresses, energy, and blows and time from the first penetration on.
    """
    wanted = stages[0].pile.site.drivability
    assert wanted is not None
    titles = [
        "toe at (m)",
        "shaft (kN)",
        "toe (kN)",
        f"blows / {wanted.per:g} m",
        *(words for _, words, _, _ in _STAGE_COLUMNS),
        "blows so far",
    ]
    has_rate = stages[0].pile.site.hammer.rate is not None
    titles += ["time (min)"] if has_rate else []
    table = Table(titles, right=titles, title="drivability")
    for stage in stages:
        table.add(*_stage_cells(stage, has_rate))
    number = stages[0].pile.site.blows
    table.notes = [f"blow {number} at each penetration; refusal: {wanted.refusal:g} blows and more"]
    if not has_rate:
        table.notes.append("the time is not known: give hammer.rate, as in `40 1/min`")
    return table


_STAGE_COLUMNS = tuple(
    column
    for column in _COLUMNS
    if column[0] in ("set", "compression", "tension", "transferred_energy")
)


def rod_table(rods: Sequence[RodBlow]) -> Table:
    """Return a row for each length of the rod of a penetration test.

    Parameters
    ----------
    rods : sequence of RodBlow
        One at least.

    Returns
    -------
    Table
        Energy ratio, that of the first wave alone, N, N for 60 %, and N with the customary factor.
    """
    titles = [
        *("rod (m)", "energy (%)", "first wave (%)", "set (mm)", "N"),
        *("N_60", "customary C_R", "energy / that of the longest"),
    ]
    table = Table(titles, right=titles, title="penetration test over the length of the rod")
    longest = rods[-1].energy_ratio
    for rod in rods:
        counts = [f"{n:.1f}" for n in (rod.count, rod.corrected) if n is not None]
        cells = [f"{100.0 * rod.energy_ratio:.1f}", f"{100.0 * rod.first_wave_ratio:.1f}"]
        cells += [f"{rod.blow.set / mm:.2f}", *(counts or ["refusal", "refusal"])]
        share = f"{rod.energy_ratio / longest:.2f}"
        table.add(f"{rod.length:g}", *cells, f"{rod.customary:g}", share)
    table.notes = [answer(rods), f"C_R: {CUSTOMARY_SOURCE}"]
    return table


def _stage_cells(stage: Stage, has_rate: bool) -> Iterator[str]:
    pile = stage.pile
    yield f"{stage.penetration:g}"
    yield f"{pile.shaft_resistance / kN:.0f}"
    yield f"{pile.site.toe.resistance / kN:.0f}"
    if stage.blow is None:
        yield "own weight"
    else:
        yield "refusal" if stage.count is None else f"{stage.count:.1f}"
    values = {entry.name: entry.value for entry in stage_values(stage)}
    for name, _, size, digits in _STAGE_COLUMNS:
        value = values[name]
        yield "" if value is None else f"{value / size:.{digits}f}"
    yield "no end" if stage.driven is None else f"{stage.driven:.0f}"
    if has_rate:
        yield "no end" if stage.time is None else f"{stage.time / _MINUTE:.1f}"


_MINUTE = 60.0


def _table(pile: PreparedPile, title: str, first: str, named: Sequence[tuple[str, Blow]]) -> Table:
    titles = [first, *(words for _, words, _, _ in _COLUMNS)]
    table = Table(titles, right=titles, title=title)
    for name, blow in named:
        table.add(name, *_cells(blow_values(pile, blow)))
    return table


def _cells(entries: Sequence[BlowValue]) -> Iterator[str]:
    values = {entry.name: entry.value for entry in entries}
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
    pile: PreparedPile, blows: Sequence[Blow], every: Sequence[Blow], wall_time: float
) -> list[str]:
    """Return remarks on a pile.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows, every : sequence of Blow
        One after the other, and those of the bearing graph and of all penetrations too.
    wall_time : float
        That the blows took (s).

    Returns
    -------
    list of str
        A sentence each.
    """
    total = sum(blow.set for blow in blows)
    worst = max(abs(blow.unbalanced / blow.impact_energy) for blow in every)
    return [
        f"{in_words(blows)}, {total / mm:.1f} mm; rated energy {pile.rated_energy / kJ:.4g} kJ, "
        f"ram strikes with {blows[0].impact_energy / kJ:.4g} kJ; wave from head to toe in "
        f"{1e3 * pile.travel_time:.3g} ms; computed in {wall_time:.2f} s",
        f"energy balance closed to {100.0 * worst:.2g} % of the impact energy; "
        f"blows / 0.3 m = {FOOT:g} m / set",
        *(f"{name}: {source}" for name, source, _ in _sources(pile)),
    ]


def _sources(pile: PreparedPile) -> Iterator[tuple[str, str, bool]]:
    """Yield name, source and proof of all that is taken from a table."""
    site = pile.site
    if site.hammer.model:
        yield site.hammer.model, site.hammer.source, site.hammer.verified
    for spring in (site.cushion, site.pile_cushion):
        if spring and spring.source:
            yield f"cushion of {spring.material}", spring.source, spring.verified


def unverified(pile: PreparedPile) -> list[str]:
    """Return the hammers and materials whose source could not be read, a sentence each."""
    return [
        f"{name}: the source of its values could not be read ({source}); give your own"
        for name, source, verified in _sources(pile)
        if not verified
    ]


def warnings(blows: Sequence[Blow]) -> list[str]:
    """Return the reasons for doubts about blows.

    Parameters
    ----------
    blows : sequence of Blow
        Those of the bearing graph and of all penetrations too.

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


def limit_warnings(pile: PreparedPile, blows: Sequence[Blow], stages: Sequence[Stage]) -> list[str]:
    """Return where stresses exceed their limits, and where the pile does not go on.

    Parameters
    ----------
    pile : PreparedPile
        With the limits.
    blows : sequence of Blow
        One after the other.
    stages : sequence of Stage
        Of the drivability analysis.

    Returns
    -------
    list of str
        A sentence each.
    """
    sentences = []
    named = [(f"blow {number}", blow) for number, blow in enumerate(blows, 1)]
    driven = [(f"a toe at {s.penetration:g} m", s.blow) for s in stages if s.blow]
    for kind in ("compression", "tension"):
        limit = getattr(pile.site.limits, kind)
        for group in (named, driven) if limit else ():
            above = [(name, blow) for name, blow in group if getattr(blow, kind).max() > limit]
            if above:
                sentences.append(_exceeded(pile, kind, limit, above))
    if stuck := [stage for stage in stages if stage.blow and stage.count is None]:
        wanted = pile.site.drivability
        assert wanted is not None
        sentences.append(
            f"the pile is not driven on with the toe at {stuck[0].penetration:g} m: more than "
            f"{wanted.refusal:g} blows for {wanted.per:g} m"
        )
    return sentences


def _exceeded(
    pile: PreparedPile, kind: str, limit: float, above: Sequence[tuple[str, Blow]]
) -> str:
    name, worst = max(above, key=lambda entry: getattr(entry[1], kind).max())
    stress = getattr(worst, kind)
    more = f", and above the limit in {len(above) - 1} more" if len(above) > 1 else ""
    return (
        f"{kind} of {stress.max() / MPa:.1f} MPa with {name}, "
        f"{pile.middles[stress.argmax()]:.1f} m "
        f"below the head, exceeds the limit of {limit / MPa:g} MPa{more}"
    )

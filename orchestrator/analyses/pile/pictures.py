"""Pictures of a pile: traces, envelopes of stresses, several blows, bearing graph, drivability."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rockshed.components.common.units import kJ, kN, mm, ms

from ...pictures.style import (
    BEAM,
    GREY,
    INK,
    ROCK,
    SAND,
    TRANSMITTED,
    WIDTH,
    legend,
    literal,
    plain_powers,
)
from ...sites.pile.preparation import PreparedPile
from ...tables import digits
from ..drawing import drawn
from ..frame import Drawing
from .blows import BearingPoint, Blow
from .drivability import Stage
from .formulas import by_formulas
from .rods import RodBlow, customary

if TYPE_CHECKING:
    from .result import PileResult

MPa = 1e6
"""Pascal in a megapascal."""
MN = 1e6
"""Newton in a meganewton."""
_WIDE = 50.0
"""Largest over smallest blow count from which on the scale of a bearing graph is logarithmic."""
_TRAVELS = 8.0
"""Travel times of a wave that the traces show at least."""
_PRESSING = 0.05
"""Part of the largest head force below which a blow is over."""


def caption(pile: PreparedPile) -> list[str]:
    """Return in short lines what was computed for a pile."""
    site = pile.site
    length = site.length
    shaft = pile.shaft_resistance
    cushion = "no cushion"
    if site.cushion:
        stiffness = f"cushion {site.cushion.stiffness / kN:.4g} kN/m"
        cushion = f"{stiffness}, restitution {site.cushion.restitution:g}"
    return [
        ": ".join(filter(None, (literal(pile.name), literal(site.description)))),
        f"ram {digits(site.hammer.mass, 4)} kg x {digits(site.hammer.drop, 4)} m, "
        f"efficiency {site.hammer.efficiency:g}, {cushion}; "
        f"rod {length:g} m in {len(site.rod)} section(s), {site.segments} segments; "
        f"R_u {digits(shaft / kN, 4)} kN at the shaft, "
        f"{digits(site.toe.resistance / kN, 4)} kN at the toe",
    ]


def drawings(result: "PileResult") -> dict[str, Drawing]:
    """Return a function for each figure of a pile.

    Parameters
    ----------
    result : PileResult
        Of the blows.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    pile = result.pile
    figures: dict[str, Drawing] = {
        "traces": partial(traces, pile, result.blows[0]),
        "envelopes": partial(envelopes, pile, result.blows),
    }
    if len(result.blows) > 1:
        figures["blows"] = partial(blow_by_blow, pile, result.blows)
    if result.graph:
        figures["bearing"] = partial(bearing, pile, result.graph)
    if result.stages:
        figures["drivability"] = partial(depths, result.stages)
    if result.rods:
        figures["rods"] = partial(over_length, result.rods)
    return figures


def traces(pile: PreparedPile, blow: Blow) -> Figure:
    """Draw the first blow over time.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blow : Blow
        With traces.

    Returns
    -------
    matplotlib.figure.Figure
        Force and Z v at head and gauge, force at the toe, displacements.
    """
    time = blow.traces["time"] / ms
    end = _end_of_blow(pile, blow)
    words = "First blow. Forces are compression positive, displacements downwards."
    with drawn([*caption(pile), words], WIDTH, 6.6) as figure:
        head, toe, way = figure.subplots(3, 1, sharex=True)
        _head_forces(pile, blow, head)
        force = blow.traces["toe.contact_force"] / kN
        toe.plot(time, force, color=TRANSMITTED, label="force at the toe")
        _displacements(blow, way)
        for axes, label in ((head, "force (kN)"), (toe, "force (kN)"), (way, "displacement (mm)")):
            axes.set(ylabel=label)
            axes.axhline(0.0, color=GREY, linewidth=0.7)
            for arrival in np.arange(2.0, end * ms / pile.travel_time, 2.0):
                at = arrival * pile.travel_time / ms
                axes.axvline(at, color=GREY, linewidth=0.5, linestyle=":")
            legend(axes)
        way.invert_yaxis()
        way.set(xlabel="time (ms); dotted: back from the toe", xlim=(0.0, min(end, time[-1])))
    return figure


def _end_of_blow(pile: PreparedPile, blow: Blow) -> float:
    """Return the time (ms) until which something happens, and a little more."""
    time = blow.traces["time"] / ms
    changing = np.abs(np.diff(blow.traces["toe.set"], prepend=0.0)) > 1e-6 * abs(blow.set)
    pressing = np.abs(blow.traces["head.contact_force"]) > _PRESSING * blow.head_force
    busy = np.flatnonzero(pressing | changing)
    if not busy.size:
        return float(time[-1])
    return float(max(1.3 * time[busy[-1]], _TRAVELS * pile.travel_time / ms))


def _head_forces(pile: PreparedPile, blow: Blow, axes: Axes) -> None:
    curves = [
        ("head.contact_force", "-", ROCK, 1.4, "force at the head"),
        ("head.zv", "--", ROCK, 1.0, "Z v at the head"),
    ]
    if pile.site.gauge > 0.0:
        below = f"force {pile.site.gauge:g} m below"
        curves.append(("gauge.force", "-", INK, 1.0, below))
        curves.append(("gauge.zv", "--", INK, 0.9, "Z v there"))
    time = blow.traces["time"] / ms
    for name, dashes, colour, width, label in curves:
        force = blow.traces[name] / kN
        axes.plot(time, force, dashes, color=colour, linewidth=width, label=label)


def _displacements(blow: Blow, axes: Axes) -> None:
    time = blow.traces["time"] / ms
    axes.plot(time, blow.traces["head.position"] / mm, color=ROCK, label="head")
    axes.plot(time, blow.traces["toe.position"] / mm, color=TRANSMITTED, label="toe")
    words = f"set, {digits(blow.set / mm)} mm"
    axes.plot(time, blow.traces["toe.set"] / mm, ":", color=INK, label=words)


def envelopes(pile: PreparedPile, blows: Sequence[Blow]) -> Figure:
    """Draw the largest stresses along the rod and the residual force, first and last blow.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows : sequence of Blow
        One after the other.

    Returns
    -------
    matplotlib.figure.Figure
        Stress and force over the depth.
    """
    words = (
        "Largest stresses in each segment; right: mean force at the end of the blow (residual), "
        "compression positive."
    )
    numbers = dict.fromkeys((1, len(blows)))
    with drawn([*caption(pile), words], WIDTH, 5.2) as figure:
        stress, left = figure.subplots(1, 2, sharey=True, width_ratios=[1.6, 1])
        for number, dashes in zip(numbers, ("-", "--")):
            blow = blows[number - 1]
            style = {"linestyle": dashes}
            pressed = f"compression, blow {number}"
            pulled = f"tension, blow {number}"
            depth = pile.middles
            stress.plot(blow.compression / MPa, depth, color=TRANSMITTED, label=pressed, **style)
            stress.plot(-blow.tension / MPa, depth, color=ROCK, label=pulled, **style)
            after = f"after blow {number}"
            left.plot(blow.residual / kN, depth, color=INK, label=after, **style)
        for axes in (stress, left):
            axes.axvline(0.0, color=GREY, linewidth=0.7)
            for top, bottom in _with_friction(pile):
                axes.axhspan(top, bottom, color=SAND, alpha=0.18, linewidth=0.0)
            legend(axes)
        stress.set(xlabel="stress (MPa), tension to the left", ylabel="depth below the head (m)")
        stress.set_ylim(pile.depths[-1], 0.0)
        left.set(xlabel="residual force (kN)")
    return figure


def _with_friction(pile: PreparedPile) -> list[tuple[float, float]]:
    """Return the depths (m) between which soil holds the shaft."""
    layers = [(layer.top, layer.bottom) for layer in pile.site.shaft]
    return layers + [(part.top, part.bottom) for part in pile.site.friction]


def blow_by_blow(pile: PreparedPile, blows: Sequence[Blow]) -> Figure:
    """Draw set and transferred energy from blow to blow.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows : sequence of Blow
        One after the other.

    Returns
    -------
    matplotlib.figure.Figure
        Two curves over the number of the blow.
    """
    with drawn(caption(pile), WIDTH, 3.6) as figure:
        axes = figure.subplots()
        numbers = np.arange(1, len(blows) + 1)
        sets = [blow.set / mm for blow in blows]
        axes.plot(numbers, sets, "o-", color=TRANSMITTED, label="set per blow")
        axes.set(xlabel="blow", ylabel="set (mm)", xticks=numbers[:: max(1, len(blows) // 12)])
        axes.set_ylim(0.0, 1.2 * max(sets) or 1.0)
        energy = axes.twinx()
        energies = [blow.transferred / kJ for blow in blows]
        label = "transferred energy"
        energy.plot(numbers, energies, "s--", color=BEAM, linewidth=1.0, label=label)
        energy.set(ylabel="transferred energy (kJ)")
        energy.set_ylim(0.0, 1.2 * max(energies) or 1.0)
        energy.grid(False)
        lines = [*axes.get_lines(), *energy.get_lines()]
        legend(axes, lines)
    return figure


def bearing(pile: PreparedPile, graph: Sequence[BearingPoint]) -> Figure:
    """Draw the bearing graph of the first blow and, where there are several, of the last one.

    The axis ends at the blow count that is said to be refusal; what is beyond it stands at the
    right edge.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    graph : sequence of BearingPoint
        One for each ultimate resistance.

    Returns
    -------
    matplotlib.figure.Figure
        Ultimate resistance, that by dynamic formulas, and largest stresses over the blow count.
    """
    several = graph[0].last is not graph[0].first
    curves = {"first blow": [point.first for point in graph]}
    if several:
        curves[f"blow {pile.site.blows}"] = [point.last for point in graph]
    counts = [_counted(pile, blow) for blows in curves.values() for blow in blows]
    shown = [count for count in counts if count is not None]
    wide = bool(shown) and max(shown) > _WIDE * min(shown)
    words = "The soil of the file scaled to R_u."
    if len(shown) < len(counts):
        words += f" Arrows: {_refusal(pile):g} blows per 0.3 m and more, or no set."
    words += " Blow counts on a logarithmic scale." if wide else ""
    with drawn([*caption(pile), words], WIDTH, 6.4) as figure:
        resistance, stress = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1])
        edge = max(shown, default=1.0) * (1.6 if wide else 1.1)
        for (name, blows), dashes in zip(curves.items(), ("-", "--")):
            _resistance_over(pile, blows, edge, (resistance, dashes, name))
            _stresses_over(pile, blows, (stress, dashes, name if several else ""))
        _formulas_over(pile, list(curves.values())[-1], resistance)
        resistance.set(ylabel="ultimate resistance R_u (kN)")
        resistance.set_ylim(bottom=0.0)
        largest = max(blow.compression.max() / MPa for blows in curves.values() for blow in blows)
        stress.set_ylim(0.0, 1.15 * largest)
        if wide:
            stress.set_xscale("log")
            plain_powers(stress.xaxis)
            stress.set_xlim(0.8 * min(shown), 1.05 * edge)
        else:
            stress.set_xlim(0.0, 1.03 * edge)
        legend(resistance)
        legend(stress)
    return figure


def _refusal(pile: PreparedPile) -> float:
    """Return the blows per 0.3 m from which a bearing graph shows refusal."""
    assert pile.site.bearing is not None
    return pile.site.bearing.refusal


def _counted(pile: PreparedPile, blow: Blow) -> float | None:
    """Return the blow count of a blow; None at refusal."""
    count = blow.count
    return None if count is None or count >= _refusal(pile) else count


def _known(pile: PreparedPile, blows: Sequence[Blow]) -> list[tuple[float, Blow]]:
    """Return the blows that have a count, with it."""
    counted = [(_counted(pile, blow), blow) for blow in blows]
    return [(count, blow) for count, blow in counted if count is not None]


def _resistance_over(
    pile: PreparedPile, blows: Sequence[Blow], edge: float, line: tuple[Axes, str, str]
) -> None:
    """Draw R_u over the blow count on axes, with dashes and a label; refusals at the edge."""
    axes, dashes, label = line
    known = _known(pile, blows)
    values = [blow.resistance / kN for _, blow in known]
    form: dict[str, Any] = {"color": INK, "markersize": 4.0}
    axes.plot([count for count, _ in known], values, f"o{dashes}", label=f"R_u, {label}", **form)
    beyond = [blow.resistance / kN for blow in blows if _counted(pile, blow) is None]
    if beyond:
        axes.plot([edge] * len(beyond), beyond, ">", color=INK, markersize=5.0)


def _formulas_over(pile: PreparedPile, blows: Sequence[Blow], axes: Axes) -> None:
    """Draw what Hiley and Gates make of the sets."""
    known = _known(pile, blows)
    count = [count for count, _ in known]
    found = [by_formulas(pile, blow) for _, blow in known]
    hiley = [entry.hiley / kN for entry in found]
    gates = [(entry.gates or 0.0) / kN for entry in found]
    axes.plot(count, hiley, ":", color=BEAM, linewidth=1.2, label="Hiley")
    axes.plot(count, gates, "-.", color=SAND, linewidth=1.2, label="Gates (FHWA)")


def _stresses_over(pile: PreparedPile, blows: Sequence[Blow], line: tuple[Axes, str, str]) -> None:
    axes, dashes, label = line
    known = _known(pile, blows)
    count = [count for count, _ in known]
    pressed = [blow.compression.max() / MPa for _, blow in known]
    pulled = [blow.tension.max() / MPa for _, blow in known]
    after = f", {label}" if label else ""
    form: dict[str, Any] = {"markersize": 3.5}
    axes.plot(count, pressed, f"o{dashes}", color=TRANSMITTED, label=f"compression{after}", **form)
    axes.plot(count, pulled, f"o{dashes}", color=ROCK, label=f"tension{after}", **form)
    axes.set(ylabel="largest stress (MPa)", xlabel="blows per 0.3 m")


def depths(stages: Sequence[Stage]) -> Figure:
    """Draw the drivability over the penetration.

    Parameters
    ----------
    stages : sequence of Stage
        One for each penetration.

    Returns
    -------
    matplotlib.figure.Figure
        Resistances, blow counts, stresses with their limits, and blows or time from the first
        penetration on, side by side.
    """
    pile = stages[0].pile
    number = pile.site.blows
    words = (
        f"Blow {number} at each penetration. Dotted: refusal, and limits of the stresses; grey: "
        "bounds of the layers."
    )
    name = ": ".join(filter(None, (literal(pile.name), literal(pile.site.description))))
    with drawn([name, _hammer_words(pile), words], 1.15 * WIDTH, 5.0) as figure:
        bearing, blows, stress, time = figure.subplots(1, 4, sharey=True)
        _resistances_down(stages, bearing)
        _blows_down(stages, blows)
        _stresses_down(stages, stress)
        _time_down(stages, time)
        _layers_down(stages, (bearing, blows, stress, time))
        bearing.set(ylabel="depth of the toe below the ground (m)")
        bearing.set_ylim(1.03 * stages[-1].penetration, 0.0)
        for axes in (bearing, blows, stress, time):
            legend(axes)
    return figure


def over_length(rods: Sequence[RodBlow]) -> Figure:
    """Draw energy and N over the length of the rod of a penetration test.

    Parameters
    ----------
    rods : sequence of RodBlow
        By rising length.

    Returns
    -------
    matplotlib.figure.Figure
        Energies over that of the longest rod beside the customary factor; N, and N for 60 %.
    """
    pile = rods[-1].pile
    words = "C_R: customary factor of the rod's length (Skempton 1986). N: blows per 0.3 m."
    lengths = [rod.length for rod in rods]
    longest = rods[-1]
    with drawn([*caption(pile), words], WIDTH, 5.0) as figure:
        energy, number = figure.subplots(2, 1, sharex=True)
        whole = [rod.energy_ratio / longest.energy_ratio for rod in rods]
        first = [rod.first_wave_ratio / longest.first_wave_ratio for rod in rods]
        energy.plot(lengths, whole, "o-", color=TRANSMITTED, label="transferred energy")
        energy.plot(lengths, first, "--", color=BEAM, label="first wave alone")
        fine = np.linspace(lengths[0], lengths[-1], 500)
        energy.plot(fine, [customary(length) for length in fine], ":", color=ROCK, label="C_R")
        energy.set(ylabel="share of the longest rod's")
        energy.set_ylim(0.0, 1.1 * max(whole))
        known = [rod for rod in rods if rod.count is not None]
        at = [rod.length for rod in known]
        number.plot(at, [rod.count or 0.0 for rod in known], "o-", color=INK, label="N")
        sixty = [rod.corrected or 0.0 for rod in known]
        number.plot(at, sixty, "s-", color=TRANSMITTED, markersize=4.0, label="N for 60 %")
        by_custom = [(rod.count or 0.0) * rod.customary for rod in known]
        number.plot(at, by_custom, ":", color=ROCK, label="N C_R")
        number.set(xlabel="length of the rod (m)", ylabel="blows per 0.3 m")
        number.set_ylim(bottom=0.0)
        for axes in (energy, number):
            legend(axes)
    return figure


def _hammer_words(pile: PreparedPile) -> str:
    """Return hammer and cushions in a line."""
    hammer = pile.site.hammer
    parts = [
        " ".join(filter(None, (hammer.kind, "hammer", literal(hammer.model)))),
        f"ram {digits(hammer.mass, 4)} kg",
        f"rated energy {digits(hammer.energy / kJ, 4)} kJ, efficiency {hammer.efficiency:g}",
    ]
    for spring, words in ((pile.site.cushion, "cushion"), (pile.site.pile_cushion, "pile cushion")):
        if spring:
            parts.append(f"{words} {digits(spring.stiffness / MN, 3)} MN/m")
    if pile.site.helmet:
        parts.append(f"helmet {digits(pile.site.helmet, 4)} kg")
    return "; ".join(parts)


def _resistances_down(stages: Sequence[Stage], axes: Axes) -> None:
    depth = [stage.penetration for stage in stages]
    shaft = [stage.pile.shaft_resistance / kN for stage in stages]
    total = [stage.pile.resistance / kN for stage in stages]
    axes.plot(shaft, depth, "-", color=SAND, label="shaft")
    axes.plot(total, depth, "-", color=INK, label="shaft and toe")
    axes.set(xlabel="resistance (kN)")
    axes.set_xlim(left=0.0)


def _blows_down(stages: Sequence[Stage], axes: Axes) -> None:
    wanted = stages[0].pile.site.drivability
    assert wanted is not None
    known = [(stage.count, stage.penetration) for stage in stages if stage.count is not None]
    stuck = [stage.penetration for stage in stages if stage.count is None]
    count = [count for count, _ in known]
    axes.plot(count, [depth for _, depth in known], "o-", color=TRANSMITTED, markersize=3.0)
    if stuck:
        axes.plot([wanted.refusal] * len(stuck), stuck, ">", color=ROCK, label="refusal")
    if stuck or max(count, default=0.0) > 0.5 * wanted.refusal:
        axes.axvline(wanted.refusal, color=ROCK, linestyle=":", linewidth=1.0)
    axes.set(xlabel=f"blows / {wanted.per:g} m")
    axes.set_xlim(left=0.0)


def _stresses_down(stages: Sequence[Stage], axes: Axes) -> None:
    limits = stages[0].pile.site.limits
    struck = [(stage.penetration, stage.blow) for stage in stages if stage.blow]
    depth = [depth for depth, _ in struck]
    for kind, colour in (("compression", TRANSMITTED), ("tension", ROCK)):
        largest = [getattr(blow, kind).max() / MPa for _, blow in struck]
        axes.plot(largest, depth, "-", color=colour, label=kind)
        limit = getattr(limits, kind)
        if limit is not None:
            axes.axvline(limit / MPa, color=colour, linestyle=":", linewidth=1.0)
    axes.set(xlabel="stress (MPa)")
    axes.set_xlim(left=0.0)


def _time_down(stages: Sequence[Stage], axes: Axes) -> None:
    known = [stage for stage in stages if stage.driven is not None]
    depth = [stage.penetration for stage in known]
    if stages[0].pile.site.hammer.rate is None:
        axes.plot([stage.driven or 0.0 for stage in known], depth, "-", color=BEAM)
        axes.set(xlabel="blows so far")
    else:
        minutes = [(stage.time or 0.0) / _MINUTE for stage in known]
        axes.plot(minutes, depth, "-", color=BEAM)
        axes.set(xlabel="time so far (min)")
    axes.set_xlim(left=0.0)


_MINUTE = 60.0


def _layers_down(stages: Sequence[Stage], panels: Sequence[Axes]) -> None:
    """Draw the bounds of the layers, and their names in the first panel."""
    ground = stages[0].pile.site.ground
    assert ground is not None
    top, deepest = 0.0, stages[-1].penetration
    for layer in ground.layers:
        for axes in panels:
            axes.axhline(layer.bottom, color=GREY, linewidth=0.6)
        if top < deepest:
            place = (0.98, top + 0.02 * deepest)
            axes = panels[-1]
            axes.text(
                *place,
                literal(layer.soil),
                transform=axes.get_yaxis_transform(),
                ha="right",
                va="top",
                fontsize=7.5,
                color=GREY,
            )
        top = layer.bottom

"""Pictures of a pile: traces of a blow, envelopes of the stresses, several blows, bearing graph."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

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
from .blows import Blow

if TYPE_CHECKING:
    from .result import PileResult

MPa = 1e6
"""Pascal in a megapascal."""
_WIDE = 50.0
"""Largest over smallest blow count from which on the scale of a bearing graph is logarithmic."""
_TRAVELS = 8.0
"""Travel times of a wave that the traces show at least."""
_PRESSING = 0.05
"""Part of the largest head force below which a blow is over."""


def caption(pile: PreparedPile) -> list[str]:
    """Return in short lines what was computed for a pile."""
    site = pile.site
    length = sum(section.length for section in site.rod)
    shaft = pile.resistance - site.toe.resistance
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
            for layer in pile.site.shaft:
                axes.axhspan(layer.top, layer.bottom, color=SAND, alpha=0.18, linewidth=0.0)
            legend(axes)
        stress.set(xlabel="stress (MPa), tension to the left", ylabel="depth below the head (m)")
        stress.set_ylim(pile.depths[-1], 0.0)
        left.set(xlabel="residual force (kN)")
    return figure


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


def bearing(pile: PreparedPile, graph: Sequence[Blow]) -> Figure:
    """Draw the bearing graph.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    graph : sequence of Blow
        One for each ultimate resistance.

    Returns
    -------
    matplotlib.figure.Figure
        Ultimate resistance and largest stresses over the blow count.
    """
    shown = [blow for blow in graph if blow.count is not None]
    words = "First blow each; the soil of the file scaled to R_u."
    if refused := len(graph) - len(shown):
        words += f" {refused} without a set are not shown."
    count = [blow.count or 0.0 for blow in shown]
    wide = bool(count) and max(count) > _WIDE * min(count)
    if wide:
        words += " Blow counts on a logarithmic scale."
    with drawn([*caption(pile), words], WIDTH, 5.8) as figure:
        resistance, stress = figure.subplots(2, 1, sharex=True, height_ratios=[1.3, 1])
        values = [blow.resistance / kN for blow in shown]
        resistance.plot(count, values, "o-", color=INK, markersize=4.0)
        resistance.set(ylabel="ultimate resistance R_u (kN)")
        resistance.set_ylim(bottom=0.0)
        _stresses_over(count, shown, stress)
        stress.set_ylim(0.0, 1.15 * max(blow.compression.max() / MPa for blow in graph))
        if wide:
            stress.set_xscale("log")
            plain_powers(stress.xaxis)
        else:
            stress.set_xlim(left=0.0)
        legend(stress)
    return figure


def _stresses_over(count: Sequence[float], blows: Sequence[Blow], axes: Axes) -> None:
    pressed = [blow.compression.max() / MPa for blow in blows]
    pulled = [blow.tension.max() / MPa for blow in blows]
    axes.plot(count, pressed, "o-", color=TRANSMITTED, markersize=3.5, label="compression")
    axes.plot(count, pulled, "o-", color=ROCK, markersize=3.5, label="tension")
    axes.set(ylabel="largest stress (MPa)", xlabel="blows per 0.3 m")

"""Pictures of a pile: traces of a blow, envelopes of the stresses, bearing graph, several blows."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rockshed.components.common.units import kJ, kN, mm, ms

from ...pictures.style import BEAM, GREY, INK, ROCK, SAND, TRANSMITTED, WIDTH, captioned, legend
from .blows import Blow
from .preparation import Prepared

MPa = 1e6
_TRAVELS = 8.0
"""Travel times of a wave that the traces show at least."""
_PRESSING = 0.05
"""Part of the largest head force below which a blow is over."""


def caption(made: Prepared) -> list[str]:
    """What was computed, in short lines."""
    site = made.site
    length, shaft = (
        sum(section.length for section in site.rod),
        made.resistance - site.toe.resistance,
    )
    cushion = (
        f"cushion {site.cushion.stiffness / kN:.4g} kN/m, restitution {site.cushion.restitution:g}"
        if site.cushion
        else "no cushion"
    )
    return [
        f"{made.name}: {site.description}".removesuffix(": "),
        f"ram {site.hammer.mass:g} kg x {site.hammer.drop:g} m, efficiency {site.hammer.efficiency:g}, {cushion}; "
        f"rod {length:g} m in {len(site.rod)} section(s), {site.segments} segments; R_u {shaft / kN:g} kN at the shaft, "
        f"{site.toe.resistance / kN:g} kN at the toe",
    ]


def draw_all(
    made: Prepared, blows: Sequence[Blow], graph: Sequence[Blow], folder: Path
) -> list[Path]:
    """All pictures, as files in ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "traces.png", folder / "envelopes.png"]
    _traces(made, blows[0], files[0])
    _envelopes(made, blows, files[1])
    if len(blows) > 1:
        files.append(folder / "blows.png")
        _blows(made, blows, files[-1])
    if graph:
        files.append(folder / "bearing.png")
        _bearing(made, graph, files[-1])
    return files


def _traces(made: Prepared, blow: Blow, file: Path) -> None:
    """Force and Z v at head and gauge, force at the toe, displacements, of the first blow."""
    time = blow.traces["time"] / ms
    changing = np.abs(np.diff(blow.traces["toe.set"], prepend=0.0)) > 1e-6 * abs(blow.set)
    last = np.flatnonzero(
        (np.abs(blow.traces["head.contact_force"]) > _PRESSING * blow.head_force) | changing
    )
    end = max(1.3 * time[last[-1]], _TRAVELS * made.travel_time / ms) if last.size else time[-1]
    words = "First blow. Forces are compression positive, displacements downwards."
    with captioned([*caption(made), words], file, WIDTH, 6.6) as drawn:
        head, toe, way = drawn.subplots(3, 1, sharex=True)
        head.plot(
            time, blow.traces["head.contact_force"] / kN, color=ROCK, label="force at the head"
        )
        head.plot(
            time,
            blow.traces["head.zv"] / kN,
            "--",
            color=ROCK,
            linewidth=1.0,
            label="Z v at the head",
        )
        if made.site.gauge > 0.0:
            head.plot(
                time,
                blow.traces["gauge.force"] / kN,
                color=INK,
                linewidth=1.0,
                label=f"force {made.site.gauge:g} m below",
            )
            head.plot(
                time,
                blow.traces["gauge.zv"] / kN,
                "--",
                color=INK,
                linewidth=0.9,
                label="Z v there",
            )
        toe.plot(
            time, blow.traces["toe.contact_force"] / kN, color=TRANSMITTED, label="force at the toe"
        )
        for name, colour, words in (
            ("head.position", ROCK, "head"),
            ("toe.position", TRANSMITTED, "toe"),
        ):
            way.plot(time, blow.traces[name] / mm, color=colour, label=words)
        way.plot(
            time, blow.traces["toe.set"] / mm, ":", color=INK, label=f"set, {blow.set / mm:.2f} mm"
        )
        for axes, label in ((head, "force (kN)"), (toe, "force (kN)"), (way, "displacement (mm)")):
            axes.set(ylabel=label)
            axes.axhline(0.0, color=GREY, linewidth=0.7)
            for arrival in np.arange(2.0, end * ms / made.travel_time, 2.0):
                axes.axvline(
                    arrival * made.travel_time / ms, color=GREY, linewidth=0.5, linestyle=":"
                )
            legend(axes, loc="upper right", ncols=2)
        way.invert_yaxis()
        way.set(xlabel="time (ms); dotted: back from the toe", xlim=(0.0, min(end, time[-1])))


def _envelopes(made: Prepared, blows: Sequence[Blow], file: Path) -> None:
    """Largest stresses along the rod and what is left in it, first and last blow."""
    middle = 0.5 * (made.depths[1:] + made.depths[:-1])
    words = "Largest stresses in each segment; right: mean force at the end of the blow (residual), compression positive."
    with captioned([*caption(made), words], file, WIDTH, 5.2) as drawn:
        stress, left = drawn.subplots(1, 2, sharey=True, width_ratios=[1.6, 1])
        chosen = {1: blows[0]} | ({len(blows): blows[-1]} if len(blows) > 1 else {})
        for number, dashes in zip(chosen, ("-", "--")):
            blow = chosen[number]
            stress.plot(
                blow.compression / MPa,
                middle,
                dashes,
                color=TRANSMITTED,
                label=f"compression, blow {number}",
            )
            stress.plot(
                -blow.tension / MPa, middle, dashes, color=ROCK, label=f"tension, blow {number}"
            )
            left.plot(blow.residual / kN, middle, dashes, color=INK, label=f"after blow {number}")
        for axes in (stress, left):
            axes.axvline(0.0, color=GREY, linewidth=0.7)
            for layer in made.site.shaft:
                axes.axhspan(layer.top, layer.bottom, color=SAND, alpha=0.18, linewidth=0.0)
            legend(axes, loc="best")
        stress.set(
            xlabel="stress (MPa), tension to the left",
            ylabel="depth below the head (m)",
            ylim=(made.depths[-1], 0.0),
        )
        left.set(xlabel="residual force (kN)")


def _blows(made: Prepared, blows: Sequence[Blow], file: Path) -> None:
    """Set and transferred energy from blow to blow."""
    with captioned(caption(made), file, WIDTH, 3.6) as drawn:
        axes = drawn.subplots()
        numbers = np.arange(1, len(blows) + 1)
        axes.plot(
            numbers,
            [blow.set / mm for blow in blows],
            "o-",
            color=TRANSMITTED,
            label="set per blow",
        )
        axes.set(xlabel="blow", ylabel="set (mm)", xticks=numbers[:: max(1, len(blows) // 12)])
        axes.set_ylim(0.0, 1.2 * max(blow.set / mm for blow in blows) or 1.0)
        energy = axes.twinx()
        energy.plot(
            numbers,
            [blow.transferred / kJ for blow in blows],
            "s--",
            color=BEAM,
            linewidth=1.0,
            label="transferred energy",
        )
        energy.set(ylabel="transferred energy (kJ)")
        energy.set_ylim(0.0, 1.2 * max(blow.transferred / kJ for blow in blows))
        energy.grid(False)
        lines = [*axes.get_lines(), *energy.get_lines()]
        axes.legend(lines, [str(line.get_label()) for line in lines], loc="lower right")


def _bearing(made: Prepared, graph: Sequence[Blow], file: Path) -> None:
    """R_u over the blow count, and the largest stresses."""
    shown = [blow for blow in graph if blow.count is not None]
    refused = len(graph) - len(shown)
    words = "First blow each; the soil of the file scaled to R_u." + (
        f" {refused} without a set are not shown." if refused else ""
    )
    with captioned([*caption(made), words], file, WIDTH, 5.8) as drawn:
        resistance, stress = drawn.subplots(2, 1, sharex=True, height_ratios=[1.3, 1])
        count = [blow.count or 0.0 for blow in shown]
        resistance.plot(
            count, [blow.resistance / kN for blow in shown], "o-", color=INK, markersize=4.0
        )
        resistance.set(ylabel="ultimate resistance R_u (kN)")
        resistance.set_ylim(bottom=0.0)
        for name, colour in (("compression", TRANSMITTED), ("tension", ROCK)):
            stress.plot(
                count,
                [getattr(blow, name).max() / MPa for blow in shown],
                "o-",
                color=colour,
                markersize=3.5,
                label=name,
            )
        stress.set(ylabel="largest stress (MPa)", xlabel="blows per 0.3 m")
        stress.set_ylim(0.0, 1.15 * max(blow.compression.max() / MPa for blow in graph))
        stress.set_xlim(left=0.0)
        legend(stress, loc="center right")

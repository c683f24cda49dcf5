"""Curves over time: forces, penetration, beam, energy balance; of a static test the load over the penetration."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from rockshed.components.common.units import cm, kgf, kN, mm, ms

from ..core.results.reading import Run
from ..metrics import headlines as h
from ..metrics.load_curve import DEPTH, load_curve
from .style import (
    BEAM,
    GREY,
    INK,
    ROCK,
    TRANSMITTED,
    WIDTH,
    figure,
    over_time,
    reference_line,
    second_scale,
)

Known = Mapping[str, h.Known]


def forces(run: Run, known: Known, file: Path) -> None:
    """Transmitted force and force on the rock, with the measured peak."""
    with figure(run, file, WIDTH, 3.6) as made:
        axes = made.subplots()
        force_axes(run, known, axes)
        _settled_forces(run, axes)
        on_rock = known.get(h.SETTLED_ROCK, h.Known())
        _references(axes, on_rock, kN, "kN", "force on the rock")
        axes.set_ylim(
            top=max(
                [
                    axes.get_ylim()[1],
                    *(1.2 * reference.value / kN for reference in on_rock.by().values()),
                ]
            )
        )


def force_axes(run: Run, known: Known, axes: Axes) -> None:
    """Both forces in kN, kgf at the right."""
    sand, time = h.roles(run).sand, run.series["time"] / ms
    for column, colour, name in (
        (f"{sand}.transmitted_force", TRANSMITTED, "transmitted to the base"),
        (f"{sand}.rock.force.y", ROCK, "on the rock"),
    ):
        peak, at = h.extreme(run, column)
        axes.plot(
            time,
            run.series[column] / kN,
            color=colour,
            label=f"{name}, peak {peak / kN:.2f} kN at {at / ms:.1f} ms",
        )
        axes.plot(at / ms, peak / kN, "o", color=colour, markersize=3.5)
    _references(axes, known.get(h.PEAK_TRANSMITTED, h.Known()), kN, "kN", "peak transmitted force")
    axes.set(xlabel="time (ms)", ylabel="force (kN)")
    over_time(axes, time)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]), top=1.12 * axes.get_ylim()[1])
    second_scale(axes, kN / kgf, "(kgf)")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)


def _settled_forces(run: Run, axes: Axes) -> None:
    """Both forces without their spikes."""
    sand = h.roles(run).sand
    for column, colour in (
        (f"{sand}.transmitted_force", TRANSMITTED),
        (f"{sand}.rock.force.y", ROCK),
    ):
        curve = h.settled(run, column)
        if curve is None:
            return
        axes.plot(
            run.series["time"] / ms, curve / kN, color=colour, linewidth=0.9, linestyle=(0, (3, 2))
        )
    axes.annotate(
        f"dashed: settled, below {h.cut_off(run):.0f} Hz",
        (1.0, 1.0),
        xycoords="axes fraction",
        xytext=(-2, -3),
        textcoords="offset points",
        ha="right",
        va="top",
        fontsize=8,
        color=GREY,
    )


def _references(axes: Axes, known: h.Known, scale: float, unit: str, what: str) -> None:
    """Lines at what others found."""
    if known.experiment:
        about = "≈ " if known.experiment.note else ""
        value = known.experiment.value / scale
        reference_line(axes, value, f"{what} measured, {about}{value:.2f} {unit}")
    if known.paper:
        about = "≈ " if known.paper.note else ""
        value = known.paper.value / scale
        reference_line(
            axes, value, f"{what} in the paper's analysis, {about}{value:.2f} {unit}", ":"
        )
    if known.handbook:
        value = known.handbook.value / scale
        reference_line(axes, value, f"{what} by the handbook's formula, {value:.0f} {unit}", "-.")


def penetration(run: Run, known: Known, file: Path) -> None:
    """Depth of the rock's lowest point under the surface, downwards, and where the base lies."""
    sand, time = h.roles(run).sand, run.series["time"] / ms
    depth = run.series[f"{sand}.penetration"]
    with figure(run, file, WIDTH, 3.2) as made:
        axes = made.subplots()
        axes.plot(time, depth / cm, color=ROCK)
        most, at = h.extreme(run, f"{sand}.penetration")
        axes.annotate(
            f"{most / cm:.2f} cm at {at / ms:.1f} ms",
            (at / ms, most / cm),
            xytext=(0, 6),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8.5,
            color=ROCK,
        )
        clearance = next((float(f.value) for f in h.headlines(run) if f.name == h.CLEARANCE), None)
        if clearance is not None:
            reference_line(axes, (most + clearance) / cm, "base", "-")
        _references(axes, known.get(h.PENETRATION, h.Known()), cm, "cm", "largest")
        axes.axhline(0.0, color=GREY, linewidth=0.7)
        axes.set(xlabel="time (ms)", ylabel="penetration (cm)")
        over_time(axes, time)
        axes.invert_yaxis()


def load(run: Run, known: Known, file: Path) -> None:
    """Load on a driven rock over its penetration, with the secant at 4 cm and the paper's."""
    curve = load_curve(run.series, str(h.roles(run).sand))
    assert curve is not None
    with figure(run, file, WIDTH, 3.6) as made:
        axes = made.subplots()
        axes.plot(curve.depth / cm, curve.load / kN, color=ROCK, linewidth=0.5, alpha=0.45)
        axes.plot(
            curve.depth / cm, curve.at(curve.depth) / kN, color=ROCK, label="load, mean over 0.5 mm"
        )
        if curve.reaches(DEPTH):
            secant = float(curve.at(DEPTH)) / DEPTH
            _secant(
                axes,
                secant,
                INK,
                "-",
                f"secant, k = {secant / kN:.1f} kN/m = {secant * cm / kgf:.1f} kgf/cm",
            )
        paper = known.get(h.STATIC_STIFFNESS, h.Known()).paper
        if paper:
            _secant(
                axes,
                paper.value,
                GREY,
                "--",
                f"paper, {paper.value / kN:.1f} kN/m = {paper.value * cm / kgf:.1f} kgf/cm",
            )
        axes.axhline(0.0, color=GREY, linewidth=0.7)
        axes.set(xlabel="penetration (cm)", ylabel="load (kN)")
        axes.set_xlim(left=0.0)
        second_scale(axes, kN / kgf, "(kgf)")
        axes.legend(loc="upper left")


def _secant(axes: Axes, stiffness: float, colour: str, dashes: str, name: str) -> None:
    """A line from the origin to 4 cm with a spring constant (N/m)."""
    axes.plot(
        [0.0, DEPTH / cm],
        [0.0, stiffness * DEPTH / kN],
        dashes,
        color=colour,
        linewidth=1.0,
        marker="o",
        markevery=[1],
        markersize=3.5,
        label=name,
    )


def beam(run: Run, known: Known, file: Path) -> None:
    """Deflection and energy of the beam."""
    name, time = h.roles(run).beam, run.series["time"] / ms
    energies = (
        ("energy.elastic", "elastic, all: the paper's eqs (5), (6)", INK, "-"),
        ("energy.bending", "of it in bending", "#8cc28a", (0, (3, 3))),
        ("energy.axial", "of it axial", ROCK, "-"),
        ("energy.strain_estimate", "from the midspan strain: its eq. (7)", TRANSMITTED, "-"),
    )
    with figure(run, file, WIDTH, 4.8) as made:
        upper, lower = made.subplots(2, sharex=True, height_ratios=(2, 3))
        deflection = run.series[f"{name}.midspan.deflection"] / mm
        upper.plot(time, deflection, color=BEAM)
        upper.axhline(0.0, color=GREY, linewidth=0.7)
        upper.set(ylabel="deflection (mm)\ndownwards")
        upper.invert_yaxis()
        for output, label, colour, dashes in energies:
            if f"{name}.{output}" in run.series:
                lower.plot(
                    time,
                    run.series[f"{name}.{output}"],
                    color=colour,
                    linestyle=dashes,
                    label=label,
                    linewidth=1.2,
                )
        _references(
            lower, known.get(h.BEAM_ENERGY_FROM_STRAIN, h.Known()), 1.0, "J", "peak by eq. (7),"
        )
        lower.set(xlabel="time (ms)", ylabel="energy of the beam (J)")
        over_time(lower, time)
        lower.set_ylim(bottom=0.0)
        second_scale(lower, 1.0 / (kgf * cm), "(kgf cm)")
        lower.legend(loc="center right")


# ------------------------------------------------------------------ energy balance

_PARTS = (
    ("rock, kinetic", "#2f5d8a", (("rock", "energy.kinetic"),)),
    ("sand, kinetic", "#8fb3d4", (("sand", "energy.kinetic"),)),
    (
        "gravity, above its least",
        "#c9cfd4",
        (("rock", "energy.gravity"), ("sand", "energy.gravity"), ("beam", "energy.gravity")),
    ),
    (
        "sand, elastic and capillary",
        "#7fae7a",
        (("sand", "energy.elastic"), ("sand", "energy.capillary")),
    ),
    (
        "beam, kinetic and elastic",
        "#3d7d3f",
        (("beam", "energy.kinetic"), ("beam", "energy.elastic")),
    ),
    ("lost in normal dashpots", "#f2cf96", (("sand", "energy.normal_dashpot"),)),
    ("lost in tangential dashpots", "#e3a857", (("sand", "energy.tangential_dashpot"),)),
    ("lost in yielding contacts", "#d98e73", (("sand", "energy.plastic"),)),
    ("lost in sliding", "#c0561a", (("sand", "energy.sliding"),)),
    ("lost in rolling", "#8c2f12", (("sand", "energy.rolling"),)),
    ("lost in the beam", "#5c3a2e", (("beam", "energy.damping"),)),
    (
        "lost on the slope, in the run",
        "#3b2b52",
        (
            ("rock", "energy.impact"),
            ("rock", "energy.friction"),
            ("rock", "energy.roughness"),
            ("rock", "energy.resistance"),
        ),
    ),
)
"""Name, colour and energies of each layer; the components by their role."""
_OF_PILES: tuple[tuple[str, str, tuple[tuple[str, str], ...]], ...] = (
    (
        "hammer",
        "#55708c",
        (("Hammer", "energy.kinetic"), ("Hammer", "energy.gravity"), ("Hammer", "energy.cushion")),
    ),
    (
        "rods, kinetic and elastic",
        "#b7a6c9",
        (("PileRod", "energy.kinetic"), ("PileRod", "energy.elastic")),
    ),
    (
        "ground, kinetic and elastic",
        "#a9b59a",
        (
            ("PileRod", "energy.soil"),
            ("ImpulsiveGround", "energy.kinetic"),
            ("ImpulsiveGround", "energy.elastic"),
            ("ImpulsiveGround", "energy.preload"),
        ),
    ),
    (
        "lost at shaft and toe",
        "#8a6d4b",
        (
            ("PileRod", "energy.plastic"),
            ("PileRod", "energy.damping"),
            ("PileRod", "energy.contact"),
            ("ImpulsiveGround", "energy.plastic"),
            ("ImpulsiveGround", "energy.damping"),
        ),
    ),
    (
        "lost in the hammer",
        "#5c3a2e",
        (("Hammer", "energy.cushion_loss"), ("Hammer", "energy.contact")),
    ),
)
"""The same for what may be there several times; the components by their model."""
_SHOWN = 1e-4
"""A layer is left out if it never reaches this part of the sum."""


def energy(run: Run, file: Path) -> None:
    """Where the energy of the impact, or what a machine has put in, is at each time, and the error of the balance."""
    time, layers, put_in = run.series["time"] / ms, list(_layers(run)), h.machine_work(run)
    residual, whole, name = h.system_residual(run), h.impact_energy(run), "impact\nenergy"
    if put_in is not None:
        whole, name = float(abs(put_in[-1])), "work of\nthe machine"
    with figure(run, file, WIDTH, 5.2) as made:
        upper, lower = made.subplots(2, sharex=True, height_ratios=(4, 1))
        if layers:  # no part may have any energy
            upper.stackplot(
                time,
                [values for _, _, values in layers],
                colors=[colour for _, colour, _ in layers],
                labels=[name for name, _, _ in layers],
                edgecolor="white",
                linewidth=0.3,
            )
        start = np.full(time.size, sum(float(values[0]) for _, _, values in layers))
        works = {"work of the machine": put_in, "work of the loads at rest": h.carried_work(run)}
        given = {words: work for words, work in works.items() if work is not None and work.any()}
        upper.plot(
            time,
            sum(given.values(), start),
            color=INK,
            linewidth=0.9,
            linestyle="--",
            label="\nand ".join(["all energy at the start", *given]),
        )
        upper.set(ylabel="energy (J)")
        over_time(upper, time)
        handles, labels = upper.get_legend_handles_labels()
        upper.legend(handles[::-1], labels[::-1], loc="center left", bbox_to_anchor=(1.0, 0.5))
        if residual is not None and whole:
            lower.plot(time, 100.0 * residual / whole, color=INK, linewidth=1.0)
            lower.set_ylabel(f"error of the balance\n(% of the {name})", fontsize=8)
        lower.axhline(0.0, color=GREY, linewidth=0.7)
        lower.set_xlabel("time (ms)")


def _layers(run: Run) -> Iterator[tuple[str, str, NDArray[np.float64]]]:
    """Name, colour and energy (J) of the layers that there are. Gravity, capillary energy and what a rock has lost on its slope
    count from their least value, so that they stack."""
    role = {key: name for key, name in vars(h.roles(run)).items() if name}
    found = []
    for name, colour, members in _PARTS:
        columns = [
            run.series[f"{role[r]}.{output}"]
            for r, output in members
            if r in role and f"{role[r]}.{output}" in run.series
        ]
        if columns:
            from_least = name.startswith(("gravity", "lost on the slope"))
            parts = [
                values - (values.min() if from_least else min(float(values.min()), 0.0))
                for values in columns
            ]
            found.append((name, colour, np.sum(parts, axis=0)))
    for name, colour, several in _OF_PILES:
        columns = [
            run.series[f"{owner}.{output}"]
            for model, output in several
            for owner in h.named(run, model)
            if f"{owner}.{output}" in run.series
        ]
        if columns:
            summed = np.sum(columns, axis=0)
            found.append((name, colour, summed - min(float(summed.min()), 0.0)))
    total = max((float(values.max()) for _, _, values in found), default=0.0)
    yield from (layer for layer in found if layer[2].max() > _SHOWN * total)

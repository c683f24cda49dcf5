"""Figures 10 and 11: 50 m in ten segments at the critical step: a stiff spring under the toe, and the total energy."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rockshed.components.common.units import ms

from ..study import Outcomes, Row, Study, verdict
from .struck_rod import SOURCE, Traces, alpha, reflecting, strike

LENGTH, SEGMENTS = 50.0, 10
PRINTED_TIMES = 5.0
"""Of the wave that arrives: the reflection in figure 10, as the text has it."""
STIFFNESSES = (1.0, 2.0, 2.05, 5.0)
MANY = 100
"""Segments with which the growth is measured: with ten, the head holds the slowest growths."""
DIVERGED = 10.0
"""Forces above this part of Z V0 cannot be of this blow."""
FINER = (10, 100, 1000)


@cache
def stiff(ratio: float, segments: int = SEGMENTS, times: float = 8.0) -> Traces:
    """k2 = ratio k1."""
    return strike(LENGTH, segments, ("toe.contact_force",), times, **reflecting(alpha(ratio)))


@cache
def energy(segments: int) -> Traces:
    """Fixed toe, until the front arrives there twice."""
    return strike(
        LENGTH, segments, ("energy.naive", "energy.residual"), 2.0, toe__condition="fixed"
    )


def first(run: Traces) -> float:
    """First force on the toe over Z V0."""
    forces = run.relative("toe.contact_force")
    return float(forces[np.flatnonzero(np.abs(forces) > 1e-9)[0]])


def diverges(run: Traces) -> bool:
    """Whether the run cannot be of this blow."""
    return not run.ended or bool(np.abs(run.relative("toe.contact_force")).max() > DIVERGED)


def limit() -> float:
    """Ratio k2/k1 above which a long rod diverges at dx/c, between two that were computed."""
    low, high = 1.0, 3.0
    while high - low > 0.02:
        middle = 0.5 * (low + high)
        if diverges(stiff(middle, MANY, 12.0)):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def excess(segments: int) -> float:
    """Total energy as printed, over the start, until the front arrives at the toe (%)."""
    run = energy(segments)
    return 100.0 * float(run["energy.naive"][:segments].max() / run.rod["energy.start"] - 1.0)


def rows(found: Outcomes) -> list[Row]:
    """What is said of both figures."""
    five = first(stiff(5.0))
    kept = {
        n: float(np.abs(energy(n)["energy.residual"]).max() / energy(n).rod["energy.start"])
        for n in FINER
    }
    return [
        Row(
            "fig. 10: the reflection is five times what arrives, then it diverges",
            "1",
            PRINTED_TIMES,
            computed=five,
            verdict=verdict(abs(five / PRINTED_TIMES - 1.0) < 0.01 and diverges(stiff(5.0))),
            note="the first force on the toe is k2/k1 times what arrives: five times needs alpha = -2/3. First forces: "
            + ", ".join(f"{first(stiff(r)):.2f} for k2/k1 = {r:g}" for r in STIFFNESSES),
        ),
        Row(
            "largest k2/k1 that is stable at dt = dx/c",
            "1",
            computed=limit(),
            verdict="found",
            note="by bisection with 100 segments; 2, i.e. alpha = -1/3: the force on the toe is multiplied by 1 - k2/k1 each step",
        ),
        Row(
            "total energy with 10 segments",
            "%",
            20.0,
            computed=excess(10),
            verdict=verdict(abs(excess(10) - 20.0) < 5.0),
            note="an artefact of the account: kinetic and elastic energy of times dt/2 apart. The half-step energy is conserved, "
            f"largest error {kept[10]:.0e} of the start",
        ),
        Row(
            "total energy with 100 segments, less than",
            "%",
            1.0,
            computed=excess(100),
            verdict=verdict(excess(100) < 1.0),
            note=f"for 50 m; with 1,000 segments {excess(1000):.2f} %. Half-step energy: {kept[100]:.0e}",
        ),
    ]


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Forces on the toe; total energies."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, WIDTH, captioned

    forces, energies = folder / "figure10.png", folder / "figure11.png"
    words = f"rod {LENGTH:g} m, {SEGMENTS} segments, dt = dx/c, Smith's scheme. "
    with captioned(
        [f"Figure 10 of Uto et al.: {words}Force on a toe on one spring k2. {SOURCE}"],
        forces,
        WIDTH,
        3.6,
    ) as made:
        axes = made.subplots()
        for ratio, colour in zip(STIFFNESSES, (TRANSMITTED, INK, "#8cc28a", ROCK), strict=True):
            run = stiff(ratio)
            axes.plot(
                run.time / ms,
                run.relative("toe.contact_force"),
                ".-",
                color=colour,
                linewidth=1.0,
                markersize=3,
                label=f"k2/k1 = {ratio:g}, alpha = {alpha(ratio):.2f}",
            )
        axes.set_yscale("symlog", linthresh=5.0)
        axes.set(
            xlabel="time (ms)",
            ylabel="force on the toe / Z V0\n(linear up to 5)",
            xlim=(0.0, 25.0),
            ylim=(-1e4, 1e4),
            yticks=[-1e4, -1e3, -1e2, -1e1, 0.0, 1e1, 1e2, 1e3, 1e4],
        )
        axes.legend(loc="upper left")
    words = (
        f"Figure 11 of Uto et al., taken to be its total energy: {words}Toe fixed. As printed: velocities and displacements "
        f"as they come out of the step. Half-step: 1/2 D(t) K D(t + dt) for the springs. {SOURCE}"
    )
    with captioned([words], energies, WIDTH, 3.6) as made:
        axes = made.subplots()
        for segments, colour in ((10, ROCK), (100, TRANSMITTED)):
            run = energy(segments)
            axes.plot(
                run.time / ms,
                run["energy.naive"] / run.rod["energy.start"],
                color=colour,
                linewidth=1.0,
                label=f"as printed, {segments} segments",
                marker="." if segments == 10 else None,
            )
        whole = 1.0 + energy(10)["energy.residual"] / energy(10).rod["energy.start"]
        axes.plot(
            energy(10).time / ms,
            whole,
            color=INK,
            linewidth=1.0,
            label="half-step energy, 10 segments",
        )
        axes.set(
            xlabel="time (ms)",
            ylabel="total energy / that of the hammer",
            xlim=(0.0, energy(10).time[-1] / ms),
        )
        axes.legend()
    return [forces, energies]


STUDY = Study(
    "figures10-11",
    "Figures 10 and 11: stiff springs, and the total energy",
    10.0,
    rows,
    draw=draw,
    notes=(
        "What figure 11 shows is not known here beyond its setting; the text's total energy is drawn.",
        "In figure 10 the paper's alpha is not stated: several are computed.",
    ),
)

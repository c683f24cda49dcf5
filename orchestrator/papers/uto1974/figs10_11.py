"""Figures 10 and 11: 50 m in ten segments at the critical step.

A stiff spring under the toe, and the total energy.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockshed.components.common.units import ms

from ..study import Outcomes, Row, Study, verdict
from .struck_rod import SOURCE, Traces, alpha, reflecting, strike

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LENGTH = 50.0
"""Length of the rod (m)."""
SEGMENTS = 10
PRINTED_TIMES = 5.0
"""Reflection in figure 10 over the wave that arrives, as the text has it."""
STIFFNESSES = (1.0, 2.0, 2.05, 5.0)
"""Ratios k2/k1 that are drawn."""
MANY = 100
"""Segments with which the growth is measured: with ten, the head holds the slowest growths."""
DIVERGED = 10.0
"""Forces above this part of Z V0 cannot be of this blow."""
FINER = (10, 100, 1000)
"""Numbers of segments with which the energy is computed."""


@cache
def stiff(ratio: float, segments: int = SEGMENTS, times: float = 8.0) -> Traces:
    """Return a blow on a toe with a spring k2 = ratio k1."""
    return strike(LENGTH, segments, ("toe.contact_force",), times, **reflecting(alpha(ratio)))


@cache
def energy(segments: int) -> Traces:
    """Return a blow on a fixed toe, until the front has arrived there twice."""
    return strike(
        LENGTH, segments, ("energy.naive", "energy.residual"), 2.0, toe__condition="fixed"
    )


def first(run: Traces) -> float:
    """Return the first force on the toe over Z V0."""
    forces = run.relative("toe.contact_force")
    return float(forces[np.flatnonzero(np.abs(forces) > 1e-9)[0]])


def diverges(run: Traces) -> bool:
    """Tell whether the forces are larger than this blow can make them."""
    return not run.ended or bool(np.abs(run.relative("toe.contact_force")).max() > DIVERGED)


def limit() -> float:
    """Return the ratio k2/k1 above which a long rod diverges at dx/c, by bisection."""
    low, high = 1.0, 3.0
    while high - low > 0.02:
        middle = 0.5 * (low + high)
        if diverges(stiff(middle, MANY, 12.0)):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def excess(segments: int) -> float:
    """Return the gain (%) of the total energy as printed, until the front arrives at the toe."""
    run = energy(segments)
    return 100.0 * float(run["energy.naive"][:segments].max() / run.rod["energy.start"] - 1.0)


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the claims about both figures."""
    return [_reflection(), _largest_stable(), _energy_of_ten(), _energy_of_hundred()]


def _reflection() -> Row:
    five = first(stiff(5.0))
    listed = ", ".join(f"{first(stiff(r)):.2f} for k2/k1 = {r:g}" for r in STIFFNESSES)
    return Row(
        "fig. 10: the reflection is five times what arrives, then it diverges",
        "1",
        PRINTED_TIMES,
        computed=five,
        verdict=verdict(abs(five / PRINTED_TIMES - 1.0) < 0.01 and diverges(stiff(5.0))),
        note="the first force on the toe is k2/k1 times what arrives: five times needs alpha = "
        f"-2/3. First forces: {listed}",
    )


def _largest_stable() -> Row:
    return Row(
        "largest k2/k1 that is stable at dt = dx/c",
        "1",
        computed=limit(),
        verdict="found",
        note="by bisection with 100 segments; 2, i.e. alpha = -1/3: the force on the toe is "
        "multiplied by 1 - k2/k1 each step",
    )


def _energy_of_ten() -> Row:
    return Row(
        "total energy with 10 segments",
        "%",
        20.0,
        computed=excess(10),
        verdict=verdict(abs(excess(10) - 20.0) < 5.0),
        note="an artefact of the account: kinetic and elastic energy of times dt/2 apart. The "
        f"half-step energy is conserved, largest error {kept(10):.0e} of the start",
    )


def _energy_of_hundred() -> Row:
    return Row(
        "total energy with 100 segments, less than",
        "%",
        1.0,
        computed=excess(100),
        verdict=verdict(excess(100) < 1.0),
        note=f"for 50 m; with 1,000 segments {excess(1000):.2f} %. Half-step energy: "
        f"{kept(100):.0e}",
    )


def kept(segments: int) -> float:
    """Return the largest error of the half-step energy, over the energy at the start."""
    run = energy(segments)
    return float(np.abs(run["energy.residual"]).max() / run.rod["energy.start"])


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the forces on the toe, and the total energies."""
    from ...pictures.style import WIDTH, captioned

    forces = folder / "figure10.png"
    setting = f"rod {LENGTH:g} m, {SEGMENTS} segments, dt = dx/c, Smith's scheme. "
    words = f"Figure 10 of Uto et al.: {setting}Force on a toe on one spring k2. {SOURCE}"
    with captioned([words], forces, WIDTH, 3.6) as made:
        _draw_forces(made.subplots())
    energies = folder / "figure11.png"
    words = (
        f"Figure 11 of Uto et al., taken to be its total energy: {setting}Toe fixed. As printed: "
        "velocities and displacements as they come out of the step. Half-step: 1/2 D(t) K D(t + "
        f"dt) for the springs. {SOURCE}"
    )
    with captioned([words], energies, WIDTH, 3.6) as made:
        _draw_energies(made.subplots())
    return [forces, energies]


def _draw_forces(axes: "Axes") -> None:
    """Draw the force on the toe for every stiffness of its spring."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, legend, plain_powers

    for ratio, colour in zip(STIFFNESSES, (TRANSMITTED, INK, "#8cc28a", ROCK), strict=True):
        run = stiff(ratio)
        label = f"k2/k1 = {ratio:g}, alpha = {alpha(ratio):.2f}"
        form: dict[str, Any] = {"color": colour, "linewidth": 1.0, "markersize": 3, "label": label}
        axes.plot(run.time / ms, run.relative("toe.contact_force"), ".-", **form)
    axes.set_yscale("symlog", linthresh=5.0)
    axes.set(
        xlabel="time (ms)",
        ylabel="force on the toe / Z V0\n(linear up to 5)",
        xlim=(0.0, 25.0),
        ylim=(-1e4, 1e4),
        yticks=[-1e4, -1e3, -1e2, -1e1, 0.0, 1e1, 1e2, 1e3, 1e4],
    )
    plain_powers(axes.yaxis)
    legend(axes)


def _draw_energies(axes: "Axes") -> None:
    """Draw the total energy as printed, and the half-step energy."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, legend

    for segments, colour, marker in ((10, ROCK, "."), (100, TRANSMITTED, None)):
        run = energy(segments)
        total = run["energy.naive"] / run.rod["energy.start"]
        label = f"as printed, {segments} segments"
        form: dict[str, Any] = {"color": colour, "linewidth": 1.0, "marker": marker}
        axes.plot(run.time / ms, total, label=label, **form)
    ten = energy(10)
    half_step = 1.0 + ten["energy.residual"] / ten.rod["energy.start"]
    label = "half-step energy, 10 segments"
    axes.plot(ten.time / ms, half_step, color=INK, linewidth=1.0, label=label)
    axes.set(xlabel="time (ms)", ylabel="total energy / that of the hammer")
    axes.set(xlim=(0.0, ten.time[-1] / ms))
    legend(axes)


STUDY = Study(
    "figures10-11",
    "Figures 10 and 11: stiff springs, and the total energy",
    10.0,
    rows,
    draw=draw,
    notes=(
        "Of figure 11 no more than its setting is known here; the text's total energy is drawn.",
        "In figure 10 the paper's alpha is not stated: several are computed.",
    ),
)

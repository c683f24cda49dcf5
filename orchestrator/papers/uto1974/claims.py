"""Claims that belong to no single figure.

The step; the resistance that follows the number of segments; tension and separation.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rockshed.components.common.units import cm, kN, mm, standard_gravity

from ..study import Outcomes, Row, Study, verdict
from .figs10_11 import limit
from .struck_rod import (
    AREA,
    DENSITY,
    DROP,
    MASS,
    QUAKE,
    SOURCE,
    SPEED,
    Traces,
    closed_form,
    kappa,
    reflecting,
    strike,
)

LENGTH = 5.0
"""Length of the rod (m)."""
SEGMENTS = 1000
ENERGY = 4762.5
"""Energy of a blow as printed (kgf cm)."""
DIVISIONS = (10, 100, 1000)
RESISTING = 0.5
"""Reflection for which the resistance is listed."""
MODULUS = DENSITY * SPEED**2
"""Young's modulus of the rod (Pa)."""


@cache
def front(parts: int) -> Traces:
    """Return the blow until the front is on its way down, in steps of 1/parts of the critical."""
    outputs = ("head.contact_force",)
    return strike(LENGTH, SEGMENTS, outputs, 0.9, parts=parts, toe__condition="fixed")


def overshoot(parts: int) -> float:
    """Return the largest force in the rod over Z V0, less 1."""
    run = front(parts)
    return float(run.rod["stress.compression"].max() * AREA / run.front - 1.0)


def resistance(segments: int, reflection: float, length: float = 50.0) -> float:
    """Return R_u = k2 Q (N) with k2 = kappa k1 and k1 = E A / (length of a segment).

    Parameters
    ----------
    segments : int
        Number of segments of the rod.
    reflection : float
        Reflection coefficient alpha of the toe.
    length : float
        Length of the rod (m).
    """
    return kappa(reflection) * MODULUS * AREA * segments / length * QUAKE


@cache
def parted(reflection: float = 0.5) -> Traces:
    """Return a blow in which hammer and rod separate."""
    outputs = ("head.contact_force", "ram.speed", "energy.residual")
    return strike(10.0, SEGMENTS, outputs, 6.0, scheme="repaired", **reflecting(reflection))


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the claims one by one."""
    return [_energy(), _small_step(), _resistance_of_segments(), _separation()]


def _energy() -> Row:
    return Row(
        "table 1: energy of a blow",
        "kgf cm",
        ENERGY,
        computed=MASS * DROP / cm,
        verdict=verdict(MASS * DROP / cm == ENERGY),
        note=f"63.5 kg x 75 cm = {MASS * DROP * standard_gravity:.0f} J",
    )


def _small_step() -> Row:
    return Row(
        "a step smaller than dx/c oscillates: overshoot of the front at dx/c / 5",
        "1",
        computed=overshoot(5),
        verdict=verdict(abs(overshoot(1)) < 1e-10 < 0.1 < overshoot(5)),
        note=f"inside the rod yes: at dx/c exact to {abs(overshoot(1)):.0e}. At the toe no: there "
        f"one spring k2 diverges at dx/c from k2/k1 = {limit():.2f} on, and a smaller step would "
        "be stable",
    )


def _resistance_of_segments() -> Row:
    each = {n: resistance(n, RESISTING) / kN for n in DIVISIONS}
    listed = ", ".join(f"{value:.4g} kN with {n}" for n, value in each.items())
    return Row(
        "R_u = k2 Q with k2 = (1 - alpha)/(1 + alpha) k1 changes with the number of segments: R_u "
        "with 1,000 over that with 10",
        "1",
        computed=each[1000] / each[10],
        verdict=verdict(each[1000] > 99.0 * each[10]),
        note=f"50 m, alpha = {RESISTING:g}, Q = {QUAKE / mm:g} mm (assumed): {listed}: a "
        "resistance of the ground cannot depend on how the rod is divided",
    )


def _separation() -> Row:
    run = parted()
    exact = closed_form(run, 0.5)
    rebound = exact.rebound()
    time = exact.separation()
    left = run.first_without("head.contact_force")
    assert rebound is not None
    assert time is not None
    assert left is not None
    tension = float(np.min(run["head.contact_force"]))
    error = np.abs(run["energy.residual"]).max() / run.rod["energy.start"]
    return Row(
        "zeroed tension is wrong; hammer and rod must be treated apart after the separation: "
        "velocity of the hammer over the exact one",
        "1",
        1.0,
        computed=float(run["ram.speed"][-1] / rebound),
        verdict=verdict(False),
        note="unilateral contact max(0, k C) with the displacements kept is that treatment: "
        f"smallest force {tension:g} N, separation at {left / time:.4f} of the exact time, error "
        f"of the energy {error:.0e}",
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw R_u over the number of segments."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, WIDTH, captioned, legend, plain_powers

    file = folder / "resistance.png"
    words = (
        "Ultimate resistance R_u = k2 Q of Uto et al.'s (6) with k2 from (9), for a rod of 50 m: "
        f"it grows with the number of segments. Q = {QUAKE / mm:g} mm (assumed). {SOURCE}"
    )
    with captioned([words], file, WIDTH, 3.2) as made:
        axes = made.subplots()
        segments = np.array([5, 10, 20, 50, 100, 200, 500, 1000])
        for reflection, colour in ((-0.5, ROCK), (0.0, INK), (0.5, TRANSMITTED)):
            values = [resistance(int(n), reflection) / kN for n in segments]
            axes.loglog(segments, values, ".-", color=colour, label=f"alpha = {reflection:g}")
        axes.set(xlabel="segments", ylabel="R_u (kN)")
        plain_powers(axes.xaxis)
        plain_powers(axes.yaxis)
        legend(axes)
    return [file]


STUDY = Study("claims", "Claims beyond the figures", 1.0, rows, draw=draw)

"""Figure 7: a measurement, computed with what the paper tells of it: rod 33.94 m, gauge 2.58 m below the head, sand with N > 50."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rockshed.components.common.units import kN, mm, ms

from ..study import Outcomes, Row, Study
from .struck_rod import QUAKE, SOURCE, Traces, closed_form, strike

LENGTH, GAUGE, BLOWS = 33.94, 2.58, 50
SEGMENTS = 1697
"""Segments of 2 cm, so that the gauge lies between two of them."""
OUTPUTS = ("gauge.stress", "toe.set", "ram.touching")
DAMPING = 0.5
"""Smith's damping under the toe (s/m), his 0.15 s/ft."""
SET = 0.3 / BLOWS
"""Penetration per blow (m) at N = 50; for N > 50 it is less."""
TIMES = 7.0
_BAR = 1e6


@cache
def strike_soil(resistance: float, times: float = TIMES, segments: int = SEGMENTS) -> Traces:
    """A blow on Smith's soil with this resistance (N)."""
    return strike(
        LENGTH,
        segments,
        OUTPUTS,
        times,
        scheme="characteristics",
        gauge__depth=GAUGE,
        toe__condition="soil",
        toe__resistance=resistance,
        toe__quake=QUAKE,
        toe__damping=DAMPING,
    )


@cache
def strike_fixed() -> Traces:
    """A blow on a toe that does not move."""
    return strike(
        LENGTH,
        SEGMENTS,
        OUTPUTS,
        TIMES,
        scheme="characteristics",
        gauge__depth=GAUGE,
        toe__condition="fixed",
    )


@cache
def resistance() -> float:
    """Resistance (N) with which a blow drives the toe by the set of N = 50: by bisection, with coarser segments."""
    low, high = 5.0 * kN, 200.0 * kN
    while high - low > 0.1 * kN:
        middle = 0.5 * (low + high)
        if strike_soil(middle, 30.0, 200)["toe.set"][-1] > SET:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def arrivals(run: Traces) -> tuple[float, float]:
    """Times (s) when the front first passes the gauge and when it comes back from the toe: the first two jumps of the stress."""
    jumps = np.abs(np.diff(run["gauge.stress"], prepend=0.0))
    first, second = np.flatnonzero(jumps > 0.5 * jumps[:SEGMENTS].max())[:2]
    return float(run.time[first]), float(run.time[second])


def rows(found: Outcomes) -> list[Row]:
    """What follows from the stated numbers; the measured curve itself is not at hand in numbers."""
    soil, fixed = strike_soil(resistance()), strike_fixed()
    passes, returns = arrivals(fixed)
    stress, parted = soil["gauge.stress"], closed_form(fixed, -1.0).separation()
    not_printed = "no printed number: the measured curve has not been read off"
    return [
        Row(
            "fig. 7: the front passes the gauge",
            "ms",
            computed=passes / ms,
            note=f"{not_printed}; 2.58 m at 5120 m/s",
        ),
        Row(
            "fig. 7: it comes back from the toe",
            "ms",
            computed=returns / ms,
            note=f"{not_printed}; 2 x 31.36 m later",
        ),
        Row(
            "fig. 7: largest stress at the gauge",
            "N/mm²",
            computed=float(stress.max() / _BAR),
            note=f"{not_printed}; rho c V0 at the front, if hammer and rod meet flat and nothing lies between them",
        ),
        Row(
            "fig. 7: ultimate resistance with which a blow drives the toe by 0.3 m / 50",
            "kN",
            computed=resistance() / kN,
            note=f"assumed: Smith's soil with quake {QUAKE / mm:g} mm and damping {DAMPING:g} s/m; N > 50 means at least "
            "this much",
        ),
        Row(
            "fig. 7: largest tension at the gauge, before 4 L/c",
            "N/mm²",
            computed=float(-stress[: 4 * SEGMENTS].min() / _BAR),
            note=f"{not_printed}; on a fixed toe {float(-fixed['gauge.stress'][: 4 * SEGMENTS].min() / _BAR):.1f}",
        ),
        Row(
            "fig. 7: hammer and rod separate, on a fixed toe",
            "ms",
            computed=None if parted is None else parted / ms,
            note="St. Venant; " + not_printed,
        ),
    ]


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Stress at the gauge."""
    from ...pictures.style import GREY, ROCK, TRANSMITTED, WIDTH, captioned

    file = folder / "figure7.png"
    words = (
        f"Figure 7 of Uto et al. is a measurement; here it is computed: rod {LENGTH:g} m, gauge {GAUGE:g} m below the head. "
        f"Assumed for sand with N > 50: Smith's soil with {resistance() / kN:.0f} kN (a set of 0.3 m / 50), quake "
        f"{QUAKE / mm:g} mm, damping {DAMPING:g} s/m; and a fixed toe. No anvil, joint or cushion. Dashed: the front "
        f"at the gauge, down and back. {SOURCE}"
    )
    with captioned([words], file, WIDTH, 3.8) as made:
        axes = made.subplots()
        for run, label, colour in (
            (strike_fixed(), "fixed toe", TRANSMITTED),
            (strike_soil(resistance()), "Smith's soil", ROCK),
        ):
            axes.plot(
                run.time / ms, run["gauge.stress"] / _BAR, color=colour, linewidth=1.1, label=label
            )
        for at in arrivals(strike_fixed()):
            axes.axvline(at / ms, color=GREY, linewidth=0.8, linestyle="--")
        axes.axhline(0.0, color=GREY, linewidth=0.7)
        axes.set(
            xlabel="time (ms)",
            ylabel="stress at the gauge (N/mm²)\ncompression positive",
            xlim=(0.0, 40.0),
        )
        axes.legend()
    return [file]


STUDY = Study(
    "figure7",
    "Figure 7: the measured rod",
    7.0,
    rows,
    draw=draw,
    notes=(
        "Only the setting of the measurement is used; its curve has not been read off, so nothing is compared.",
    ),
)

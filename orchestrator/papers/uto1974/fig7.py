"""Figure 7: a measurement, computed with the setting that the paper states.

Rod of 33.94 m, gauge 2.58 m below the head, sand with N > 50.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rockshed.components.common.units import kN, mm, ms

from ..study import Outcomes, Row, Study
from .struck_rod import QUAKE, SOURCE, Traces, closed_form, strike

LENGTH = 33.94
"""Length of the rod (m)."""
GAUGE = 2.58
"""Depth of the gauge below the head (m)."""
BLOWS = 50
"""N, blows per 0.3 m."""
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
    """Return a blow on Smith's soil.

    Parameters
    ----------
    resistance : float
        Ultimate resistance (N) at the toe.
    times : float
        Travel times that are followed.
    segments : int
        Segments of the rod.
    """
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
    """Return a blow on a toe that does not move."""
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
    """Return the resistance (N) with which a blow drives the toe by the set of N = 50.

    By bisection, with coarser segments.
    """
    low, high = 5.0 * kN, 200.0 * kN
    while high - low > 0.1 * kN:
        middle = 0.5 * (low + high)
        if strike_soil(middle, 30.0, 200)["toe.set"][-1] > SET:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def arrivals(run: Traces) -> tuple[float, float]:
    """Return the times (s) when the front passes the gauge and when it comes back from the toe.

    They are the first two jumps of the stress.
    """
    jumps = np.abs(np.diff(run["gauge.stress"], prepend=0.0))
    first, second = np.flatnonzero(jumps > 0.5 * jumps[:SEGMENTS].max())[:2]
    return float(run.time[first]), float(run.time[second])


_NOT_PRINTED = "no printed number: the measured curve has not been read off"


def rows(outcomes: Outcomes) -> list[Row]:
    """Return what follows from the stated numbers; the measured curve is not at hand in numbers."""
    return [*_arrivals(), *_stresses(), _parting()]


def _arrivals() -> list[Row]:
    passes, returns = arrivals(strike_fixed())
    return [
        Row(
            "fig. 7: the front passes the gauge",
            "ms",
            computed=passes / ms,
            note=f"{_NOT_PRINTED}; 2.58 m at 5120 m/s",
        ),
        Row(
            "fig. 7: it comes back from the toe",
            "ms",
            computed=returns / ms,
            note=f"{_NOT_PRINTED}; 2 x 31.36 m later",
        ),
    ]


def _stresses() -> list[Row]:
    stress = strike_soil(resistance())["gauge.stress"]
    on_fixed = strike_fixed()["gauge.stress"]
    return [
        Row(
            "fig. 7: largest stress at the gauge",
            "N/mm²",
            computed=float(stress.max() / _BAR),
            note=f"{_NOT_PRINTED}; rho c V0 at the front, if hammer and rod meet flat and nothing "
            "lies between them",
        ),
        Row(
            "fig. 7: ultimate resistance with which a blow drives the toe by 0.3 m / 50",
            "kN",
            computed=resistance() / kN,
            note=f"assumed: Smith's soil with quake {QUAKE / mm:g} mm and damping {DAMPING:g} s/m; "
            "N > 50 means at least this much",
        ),
        Row(
            "fig. 7: largest tension at the gauge, before 4 L/c",
            "N/mm²",
            computed=float(-stress[: 4 * SEGMENTS].min() / _BAR),
            note=f"{_NOT_PRINTED}; on a fixed toe "
            f"{float(-on_fixed[: 4 * SEGMENTS].min() / _BAR):.1f}",
        ),
    ]


def _parting() -> Row:
    time = closed_form(strike_fixed(), -1.0).separation()
    return Row(
        "fig. 7: hammer and rod separate, on a fixed toe",
        "ms",
        computed=None if time is None else time / ms,
        note="St. Venant; " + _NOT_PRINTED,
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the stress at the gauge over time."""
    from ...pictures.style import GREY, ROCK, TRANSMITTED, WIDTH, captioned, legend

    file = folder / "figure7.png"
    words = (
        f"Figure 7 of Uto et al. is a measurement; here it is computed: rod {LENGTH:g} m, gauge "
        f"{GAUGE:g} m below the head. Assumed for sand with N > 50: Smith's soil with "
        f"{resistance() / kN:.0f} kN (a set of 0.3 m / 50), quake {QUAKE / mm:g} mm, damping "
        f"{DAMPING:g} s/m; and a fixed toe. No anvil, joint or cushion. Dashed: the front at the "
        f"gauge, down and back. {SOURCE}"
    )
    with captioned([words], file, WIDTH, 3.8) as made:
        axes = made.subplots()
        for run, label, colour in (
            (strike_fixed(), "fixed toe", TRANSMITTED),
            (strike_soil(resistance()), "Smith's soil", ROCK),
        ):
            stress = run["gauge.stress"] / _BAR
            axes.plot(run.time / ms, stress, color=colour, linewidth=1.1, label=label)
        for at in arrivals(strike_fixed()):
            axes.axvline(at / ms, color=GREY, linewidth=0.8, linestyle="--")
        axes.axhline(0.0, color=GREY, linewidth=0.7)
        axes.set(xlabel="time (ms)", xlim=(0.0, 40.0))
        axes.set(ylabel="stress at the gauge (N/mm²)\ncompression positive")
        legend(axes)
    return [file]


STUDY = Study(
    "figure7",
    "Figure 7: the measured rod",
    7.0,
    rows,
    draw=draw,
    notes=(
        "Only the setting of the measurement is used; its curve has not been read off, so nothing "
        "is compared.",
    ),
)

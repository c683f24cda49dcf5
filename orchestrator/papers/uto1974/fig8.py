"""Figure 8: 5 m in a hundred segments, a spring as stiff as the rod's under the toe."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rockshed.components.common.units import ms

from ..study import Outcomes, Row, Study, verdict
from .struck_rod import SOURCE, Traces, closed_form, reflecting, strike

LENGTH, SEGMENTS = 5.0, 100
OUTPUTS = ("head.contact_force", "toe.contact_force")
TIMES = 8.0


@cache
def spring() -> Traces:
    """k2 = k1."""
    return strike(LENGTH, SEGMENTS, OUTPUTS, TIMES, **reflecting(0.0))


@cache
def longer() -> Traces:
    """One more segment, on a fixed end."""
    part = 1.0 + 1.0 / SEGMENTS
    return strike(LENGTH * part, SEGMENTS + 1, OUTPUTS, TIMES / part, toe__condition="fixed")


@cache
def matched() -> Traces:
    """What alpha = 0 stands for: a toe without reflection."""
    return strike(LENGTH, SEGMENTS, OUTPUTS, TIMES, scheme="characteristics", **reflecting(0.0))


def rows(found: Outcomes) -> list[Row]:
    """What is said of the figure."""
    count = min(spring().time.size, longer().time.size)
    apart = (
        np.abs(spring()["toe.contact_force"][:count] - longer()["toe.contact_force"][:count]).max()
        / spring().front
    )
    times = _at(spring(), 1.9) / _at(matched(), 1.9)
    return [
        Row(
            "k2 = k1 behaves like a fixed toe: force on the toe, over that of a rod one segment longer with a fixed end, largest "
            "difference over Z V0",
            "1",
            0.0,
            computed=float(apart),
            verdict=verdict(apart < 1e-9),
            note="reproduced, and right: a spring k1 to fixed ground is one more segment with a fixed end",
        ),
        Row(
            "k2 = (1 - alpha)/(1 + alpha) k1, (8) and (9), for one spring to fixed ground: force on the toe at 1.9 L/c over that "
            "of the matched toe it should be",
            "1",
            1.0,
            computed=times,
            verdict=verdict(abs(times - 1.0) < 0.01),
            note="alpha = 0 should not reflect; the spring's reflection depends on the frequency. (8), (9) are true of a rod that "
            "continues, k = Z/dt",
        ),
    ]


def _at(run: Traces, times: float) -> float:
    return float(np.interp(times * run.travel_time, run.time, run["toe.contact_force"]))


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Forces at the toe and under the hammer."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, WIDTH, captioned

    file, exact = folder / "figure8.png", closed_form(spring(), -1.0)
    words = (
        f"Figure 8 of Uto et al.: rod {LENGTH:g} m, {SEGMENTS} segments, dt = dx/c, Smith's scheme with k2 = k1. "
        "It is a fixed toe, not one without reflection. " + SOURCE
    )
    with captioned([words], file, WIDTH, 4.6) as made:
        upper, lower = made.subplots(2, sharex=True)
        upper.plot(
            spring().time / ms,
            spring().relative("head.contact_force"),
            color=ROCK,
            label="Smith, k2 = k1",
        )
        at = np.linspace(0.0, min(float(exact.separation() or 1.0), spring().time[-1]), 800)
        upper.plot(
            at / ms,
            exact.force(at) / exact.first_force,
            "--",
            color=INK,
            linewidth=1.0,
            label="St. Venant, alpha = -1",
        )
        lower.plot(
            spring().time / ms,
            spring().relative("toe.contact_force"),
            color=ROCK,
            label="Smith, k2 = k1",
        )
        lower.plot(
            longer().time / ms,
            longer().relative("toe.contact_force"),
            "--",
            color=INK,
            linewidth=1.0,
            label="one segment more, fixed",
        )
        lower.plot(
            matched().time / ms,
            matched().relative("toe.contact_force"),
            color=TRANSMITTED,
            label="toe without reflection",
        )
        upper.set(ylabel="force under the\nhammer / Z V0")
        lower.set(
            xlabel="time (ms)",
            ylabel="force on the\ntoe / Z V0",
            xlim=(0.0, spring().time[-1] / ms),
        )
        upper.legend()
        lower.legend()
    return [file]


STUDY = Study(
    "figure8", "Figure 8: a spring as stiff as the rod's under the toe", 8.0, rows, draw=draw
)

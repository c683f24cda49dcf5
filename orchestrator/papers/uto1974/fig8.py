"""Figure 8: 5 m in a hundred segments, a spring as stiff as the rod's under the toe."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockshed.components.common.units import ms

from ..study import Outcomes, Row, Study, verdict
from .struck_rod import SOURCE, Traces, closed_form, reflecting, strike

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LENGTH = 5.0
"""Length of the rod (m)."""
SEGMENTS = 100
OUTPUTS = ("head.contact_force", "toe.contact_force")
TIMES = 8.0
"""Travel times that are followed."""


@cache
def spring() -> Traces:
    """Return a blow on a toe with a spring k2 = k1."""
    return strike(LENGTH, SEGMENTS, OUTPUTS, TIMES, **reflecting(0.0))


@cache
def longer() -> Traces:
    """Return a blow on a rod of one more segment with a fixed end."""
    part = 1.0 + 1.0 / SEGMENTS
    return strike(LENGTH * part, SEGMENTS + 1, OUTPUTS, TIMES / part, toe__condition="fixed")


@cache
def matched() -> Traces:
    """Return a blow on a toe without reflection, which alpha = 0 stands for."""
    return strike(LENGTH, SEGMENTS, OUTPUTS, TIMES, scheme="characteristics", **reflecting(0.0))


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the claims about the figure."""
    return [_like_a_fixed_toe(), _not_matched()]


def _like_a_fixed_toe() -> Row:
    count = min(spring().time.size, longer().time.size)
    forces = [run["toe.contact_force"][:count] for run in (spring(), longer())]
    apart = np.abs(forces[0] - forces[1]).max() / spring().front
    return Row(
        "k2 = k1 behaves like a fixed toe: force on the toe, over that of a rod one segment longer "
        "with a fixed end, largest difference over Z V0",
        "1",
        0.0,
        computed=float(apart),
        verdict=verdict(apart < 1e-9),
        note="reproduced, and right: a spring k1 to fixed ground is one more segment with a fixed "
        "end",
    )


def _not_matched() -> Row:
    times = _at(spring(), 1.9) / _at(matched(), 1.9)
    return Row(
        "k2 = (1 - alpha)/(1 + alpha) k1, (8) and (9), for one spring to fixed ground: force on "
        "the toe at 1.9 L/c over that of the matched toe it should be",
        "1",
        1.0,
        computed=times,
        verdict=verdict(abs(times - 1.0) < 0.01),
        note="alpha = 0 should not reflect; the spring's reflection depends on the frequency. (8), "
        "(9) are true of a rod that continues, k = Z/dt",
    )


def _at(run: Traces, times: float) -> float:
    return float(np.interp(times * run.travel_time, run.time, run["toe.contact_force"]))


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the forces at the toe and under the hammer."""
    from ...pictures.style import WIDTH, captioned

    file = folder / "figure8.png"
    words = (
        f"Figure 8 of Uto et al.: rod {LENGTH:g} m, {SEGMENTS} segments, dt = dx/c, Smith's scheme "
        "with k2 = k1. It is a fixed toe, not one without reflection. "
    )
    with captioned([words + SOURCE], file, WIDTH, 4.6) as made:
        upper, lower = made.subplots(2, sharex=True)
        _draw_head(upper)
        _draw_toe(lower)
        lower.set(xlabel="time (ms)", xlim=(0.0, spring().time[-1] / ms))
    return [file]


def _draw_head(axes: "Axes") -> None:
    """Draw the force under the hammer beside St. Venant's."""
    from ...pictures.style import INK, ROCK, legend

    run = spring()
    exact = closed_form(run, -1.0)
    at = np.linspace(0.0, min(float(exact.separation() or 1.0), run.time[-1]), 800)
    form: dict[str, Any] = {"color": INK, "linewidth": 1.0, "label": "St. Venant, alpha = -1"}
    axes.plot(run.time / ms, run.relative("head.contact_force"), color=ROCK, label="Smith, k2 = k1")
    axes.plot(at / ms, exact.force(at) / exact.first_force, "--", **form)
    axes.set(ylabel="force under the\nhammer / Z V0")
    legend(axes)


def _draw_toe(axes: "Axes") -> None:
    """Draw the force on the toe of all three rods."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, legend

    for run, look, colour, label in (
        (spring(), "-", ROCK, "Smith, k2 = k1"),
        (longer(), "--", INK, "one segment more, fixed"),
        (matched(), "-", TRANSMITTED, "toe without reflection"),
    ):
        force = run.relative("toe.contact_force")
        axes.plot(run.time / ms, force, look, color=colour, linewidth=1.2, label=label)
    axes.set(ylabel="force on the\ntoe / Z V0")
    legend(axes)


STUDY = Study(
    "figure8", "Figure 8: a spring as stiff as the rod's under the toe", 8.0, rows, draw=draw
)

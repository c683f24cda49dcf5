"""Figure 6: 50 m in ten segments, a fifth of the critical step."""

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

LENGTH = 50.0
"""Length of the rod (m)."""
SEGMENTS = 10
PARTS = 5
"""Steps in a critical step."""
SOON = 0.01
"""Part of the striking velocity above which the toe is said to move."""
OUTPUTS = ("head.contact_force", "toe.velocity", "toe.contact_force")


@cache
def coarse() -> Traces:
    """Return a blow in the paper's setting; k2 = k1 assumed."""
    return strike(LENGTH, SEGMENTS, OUTPUTS, 3.0, parts=PARTS, **reflecting(0.0))


@cache
def critical() -> Traces:
    """Return a blow with ten segments at the critical step."""
    return strike(LENGTH, SEGMENTS, OUTPUTS, 3.0, **reflecting(0.0))


@cache
def fine() -> Traces:
    """Return a blow with a thousand segments at a fifth of the critical step."""
    return strike(LENGTH, 1000, OUTPUTS, 3.0, parts=PARTS, **reflecting(0.0))


def before_arrival(run: Traces) -> float:
    """Return the largest speed (m/s) of the toe before the wave can be there."""
    early = run.time < coarse().travel_time * (1 - 1e-9)
    return float(np.abs(run["toe.velocity"][early]).max())


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the claims about the figure."""
    return [_toe_moves_early(), _parts_early()]


def _toe_moves_early() -> Row:
    early = before_arrival(coarse()) / coarse().rod["ram.velocity"]
    return Row(
        "ten segments and dt/5: the toe moves before the wave arrives, part of the striking "
        "velocity",
        "1",
        computed=float(early),
        verdict=verdict(early > SOON),
        note="reproduced: a coarse-grid artefact; at the critical step the toe rests until L/c "
        f"(largest {before_arrival(critical()):.1g} m/s)",
    )


def _parts_early() -> Row:
    arrival = coarse().travel_time
    parted = coarse().first_without("head.contact_force")
    exact = closed_form(coarse(), -1.0).separation()
    fine_parted = fine().first_without("head.contact_force")
    assert parted is not None
    assert exact is not None
    assert fine_parted is not None
    return Row(
        "ten segments and dt/5: hammer and rod separate too early, time over L/c",
        "1",
        computed=parted / arrival,
        verdict=verdict(parted < 0.9 * exact),
        note="reproduced: a coarse-grid artefact; exact for this spring, a fixed end to this "
        f"order: {exact / arrival:.3f}; with 1,000 segments and dt/5 the waves behind the front "
        f"part them at {fine_parted / arrival:.2f}",
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the force under the hammer and the velocity of the toe."""
    from ...pictures.style import GREY, WIDTH, captioned, legend

    file = folder / "figure6.png"
    words = (
        f"Figure 6 of Uto et al.: rod {LENGTH:g} m, {SEGMENTS} segments, dt = dx/c / {PARTS}, "
        "Smith's scheme. Spring under the toe: k2 = k1 (assumed). Dashed: the wave arrives at the "
        "toe, and comes back. "
    )
    with captioned([words + SOURCE], file, WIDTH, 4.6) as made:
        upper, lower = made.subplots(2, sharex=True)
        _draw_force(upper)
        _draw_velocity(lower)
        for axes in (upper, lower):
            for n in (1, 2):
                at = n * coarse().travel_time / ms
                axes.axvline(at, color=GREY, linewidth=0.8, linestyle="--")
            legend(axes)
        lower.set(xlabel="time (ms)", xlim=(0.0, coarse().time[-1] / ms))
    return [file]


def _draw_force(axes: "Axes") -> None:
    """Draw the force under the hammer beside the exact one."""
    from ...pictures.style import ROCK, TRANSMITTED

    run = coarse()
    exact = closed_form(run, -1.0)
    at = np.linspace(0.0, float(exact.separation() or 0.0), 400)
    label = "exact (fixed toe), until they separate"
    axes.plot(run.time / ms, run.relative("head.contact_force"), color=ROCK, label="Smith, dt/5")
    axes.plot(at / ms, exact.force(at) / exact.first_force, color=TRANSMITTED, label=label)
    axes.set(ylabel="force under the\nhammer / Z V0")


def _draw_velocity(axes: "Axes") -> None:
    """Draw the velocity of the toe at both steps."""
    from ...pictures.style import ROCK, TRANSMITTED

    run = coarse()
    whole = critical()
    form: dict[str, Any] = {"color": TRANSMITTED, "label": "Smith, dx/c", "drawstyle": "steps-pre"}
    axes.plot(run.time / ms, run["toe.velocity"], color=ROCK, label="Smith, dt/5")
    axes.plot(whole.time / ms, whole["toe.velocity"], **form)
    axes.set(ylabel="velocity of\nthe toe (m/s)")


STUDY = Study(
    "figure6",
    "Figure 6: ten segments, a fifth of the critical step",
    6.0,
    rows,
    draw=draw,
    notes=(
        "The scheme's own kernels; no FMUs are run.",
        "The ground under the toe is not stated for this figure: k2 = k1.",
    ),
)

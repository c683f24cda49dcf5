"""Equations (2) to (7): what follows from a resistance linear in time, by closed form and by the component in time."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.common.component import Instance
from rockshed.components.common.units import cm2, kgf, mm, ms
from rockshed.components.impulsive_ground.settlement import (
    exact_settlement,
    fitted_ends,
    initial_velocity,
    printed_settlement,
    stopping_time,
)

from ..study import Outcomes, Row, Study, verdict
from .plate_tests import DENSITY, MIDDLE, PLATE, Trial, mass, radius, trials

SHAPES = {"R0 = R1": (1.0, 1.0), "R0 = 0": (0.0, 2.0), "R1 = 0": (2.0, 0.0)}
"""Ends of the resistance, in parts of its mean."""
_ROUNDING = 1e-9
_STEPS = 40


def ground(trial: Trial, r0: float, r1: float) -> Instance:
    """The component after the blow of a trial, with a resistance (N) that runs from r0 to r1 in the time of (6)."""
    made = component("ImpulsiveGround").instance()
    values = {
        "plate.radius": radius(trial.area),
        "plate.mass": PLATE * trial.area * cm2,
        "soil.density": DENSITY,
        "resistance.start": r0,
        "resistance.end": r1,
        "resistance.time": stopping_time(trial.impulse, r0, r1),
        "impulse0": trial.impulse,
    }
    for name, value in values.items():
        made[name] = value
    made.initialise()
    return made


def deviation(trial: Trial) -> float:
    """Of the component's settlement from the exact integral, for the ends of (12)."""
    r0, r1 = fitted_ends(trial.impulse, trial.area * cm2)
    made, time = ground(trial, r0, r1), 1.1 * stopping_time(trial.impulse, r0, r1)
    for number in range(_STEPS):
        made.step(number * time / _STEPS, time / _STEPS)
    return abs(made["settlement"] / exact_settlement(trial.impulse, mass(trial.area), r0, r1) - 1.0)


def rows(found: Outcomes) -> list[Row]:
    """Ratios, and what the component gives."""
    blow = (35.0, 60.0)
    made = []
    for name, (first, last) in SHAPES.items():
        ratio = exact_settlement(*blow, 4e3 * first, 4e3 * last) / printed_settlement(
            *blow, 4e3 * first, 4e3 * last
        )
        made.append(
            Row(
                f"settlement by (1) and (2) / by (7), {name}",
                "1",
                paper=1.0,
                computed=ratio,
                verdict=verdict(abs(ratio - 1.0) < _ROUNDING),
                note="(7) takes the velocity as linear, (3)",
            )
        )
    each = list(trials())
    ratios = []
    for trial in each:
        ends = fitted_ends(trial.impulse, trial.area * cm2)
        ratios.append(
            exact_settlement(trial.impulse, 1.0, *ends)
            / printed_settlement(trial.impulse, 1.0, *ends)
        )
    made.append(
        Row(
            "the same for the ends of fig. 3, 96 tests",
            "1",
            paper=1.0,
            computed=sum(ratios) / len(ratios),
            spread=float(np.std(ratios)),
            note="R0 is small there: nearly 4/3",
        )
    )
    worst = max(deviation(trial) for trial in each)
    made.append(
        Row(
            "component in time / exact integral - 1, largest of 96 tests",
            "1",
            computed=worst,
            verdict=verdict(worst < 1e-8),
            note=f"{_STEPS} steps a blow",
        )
    )
    return made


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Resistance, velocity and settlement over time in one blow."""
    from ...pictures.style import GREY, INK, ROCK, TRANSMITTED, WIDTH, captioned

    file = folder / "blow.png"
    trial = Trial(200.0, *MIDDLE)
    r0, r1 = fitted_ends(trial.impulse, trial.area * cm2)
    end = stopping_time(trial.impulse, r0, r1)
    words = (
        f"Plate of {trial.area:g} cm², {trial.weight:g} kg from {trial.drop:g} cm, I = {trial.impulse / kgf:.2f} kgf s. "
        "Solid: the component, R of (2) with the ends read from (12). Dashed: R constant, (R0 + R1)/2. Dotted: (3) and (7)."
    )
    with captioned([words], file, WIDTH, 5.4) as made:
        resistance, velocity, settlement = made.subplots(3, 1, sharex=True)
        for ends, dashes, colour in (
            ((r0, r1), "-", INK),
            ((0.5 * (r0 + r1),) * 2, "--", TRANSMITTED),
        ):
            time, values = _history(ground(trial, *ends), 1.25 * end)
            for axes, column in zip((resistance, velocity, settlement), values.T):
                axes.plot(time / ms, column, dashes, color=colour, linewidth=1.2)
        v0 = initial_velocity(trial.impulse, mass(trial.area))
        velocity.plot([0.0, end / ms], [v0, 0.0], ":", color=ROCK)
        printed = printed_settlement(trial.impulse, mass(trial.area), r0, r1) / mm
        settlement.axhline(printed, color=ROCK, linestyle=":", linewidth=1.2)
        settlement.annotate(
            "(7)",
            (0.0, printed),
            xytext=(4, 3),
            textcoords="offset points",
            color=ROCK,
            fontsize=8.5,
        )
        for axes, label in (
            (resistance, "R (kgf)"),
            (velocity, "v (m/s)"),
            (settlement, "settlement (mm)"),
        ):
            axes.set(ylabel=label)
            axes.axvline(end / ms, color=GREY, linewidth=0.8)
        settlement.set(xlabel="time (ms); line: t_f of (6)", xlim=(0.0, 1.25 * end / ms))
    return [file]


def _history(made: Instance, end: float, steps: int = 200) -> tuple["np.ndarray", "np.ndarray"]:
    """Times (s), and resistance (kgf), velocity (m/s) and settlement (mm) then."""
    times = np.linspace(0.0, end, steps + 1)
    rows = [(made["resistance"] / kgf, -made["velocity.y"], made["settlement"] / mm)]
    for before, after in pairwise(times):
        made.step(before, after - before)
        rows.append((made["resistance"] / kgf, -made["velocity.y"], made["settlement"] / mm))
    return times, np.array(rows)


STUDY = Study(
    "settlement",
    "Settlement under an impulse, (2) to (7)",
    2.0,
    rows,
    draw=draw,
    notes=("(3), a velocity that falls linearly, agrees with (1) for a constant resistance only.",),
)

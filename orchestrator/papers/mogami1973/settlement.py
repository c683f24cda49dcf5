"""Equations (2) to (7): settlement from a resistance linear in time.

Closed forms stand beside the component, stepped in time.
"""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
from .plate_tests import DENSITY, MIDDLE, PLATE, PlateTest, mass, plate_tests, radius

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHAPES = {"R0 = R1": (1.0, 1.0), "R0 = 0": (0.0, 2.0), "R1 = 0": (2.0, 0.0)}
"""Ends of the resistance, in parts of its mean."""
_ROUNDING = 1e-9
_STEPS = 40
_BLOW = (35.0, 60.0)
"""Impulse (N s) and mass (kg) for which the ratios of settlements are computed; they cancel."""
_MEAN = 4e3
"""Mean resistance (N) for the same."""


def ground(test: PlateTest, r0: float, r1: float) -> Instance:
    """Return the component after the blow of a test.

    Parameters
    ----------
    test : PlateTest
        Plate, weight and drop.
    r0, r1 : float
        Resistance (N) at the start and at the time of (6).

    Returns
    -------
    Instance
        The component, initialised.
    """
    made = component("ImpulsiveGround").instance()
    values = {
        "plate.radius": radius(test.area),
        "plate.mass": PLATE * test.area * cm2,
        "soil.density": DENSITY,
        "resistance.start": r0,
        "resistance.end": r1,
        "resistance.time": stopping_time(test.impulse, r0, r1),
        "impulse0": test.impulse,
        "impulse0.mass": test.weight,
    }
    for name, value in values.items():
        made[name] = value
    made.initialise()
    return made


def deviation(test: PlateTest) -> float:
    """Return the deviation of the component's settlement from the exact integral.

    The ends of the resistance are those of (12).
    """
    r0, r1 = fitted_ends(test.impulse, test.area * cm2)
    made = ground(test, r0, r1)
    time = 1.1 * stopping_time(test.impulse, r0, r1)
    for number in range(_STEPS):
        made.step(number * time / _STEPS, time / _STEPS)
    exact = exact_settlement(test.impulse, mass(test.area, test.weight), r0, r1)
    return abs(made["settlement"] / exact - 1.0)


def rows(outcomes: Outcomes) -> list[Row]:
    """Return ratios of settlements, and the deviation of the component."""
    return [*map(_of_shape, SHAPES), _of_tests(), _of_component()]


def _of_shape(name: str) -> Row:
    """Return the settlement by (1) and (2) over that by (7), for a shape of the resistance."""
    first, last = (_MEAN * part for part in SHAPES[name])
    ratio = exact_settlement(*_BLOW, first, last) / printed_settlement(*_BLOW, first, last)
    return Row(
        f"settlement by (1) and (2) / by (7), {name}",
        "1",
        paper=1.0,
        computed=ratio,
        verdict=verdict(abs(ratio - 1.0) < _ROUNDING),
        note="(7) takes the velocity as linear, (3)",
    )


def _of_tests() -> Row:
    """Return the same ratio over all tests, with the ends of fig. 3."""
    ratios = []
    for test in plate_tests():
        ends = fitted_ends(test.impulse, test.area * cm2)
        exact = exact_settlement(test.impulse, 1.0, *ends)
        ratios.append(exact / printed_settlement(test.impulse, 1.0, *ends))
    return Row(
        "the same for the ends of fig. 3, 96 tests",
        "1",
        paper=1.0,
        computed=sum(ratios) / len(ratios),
        spread=float(np.std(ratios)),
        note="R0 is small there: nearly 4/3",
    )


def _of_component() -> Row:
    worst = max(deviation(test) for test in plate_tests())
    return Row(
        "component in time / exact integral - 1, largest of 96 tests",
        "1",
        computed=worst,
        verdict=verdict(worst < 1e-8),
        note=f"{_STEPS} steps a blow",
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw resistance, velocity and settlement over time in one blow."""
    from ...pictures.style import WIDTH, captioned

    file = folder / "blow.png"
    test = PlateTest(200.0, *MIDDLE)
    words = (
        f"Plate of {test.area:g} cm², {test.weight:g} kg from {test.drop:g} cm, I = "
        f"{test.impulse / kgf:.2f} kgf s. Solid: the component, R of (2) with the ends read from "
        "(12). Dashed: R constant, (R0 + R1)/2. Dotted: (3) and (7)."
    )
    with captioned([words], file, WIDTH, 5.4) as made:
        _draw_blow(made, test)
    return [file]


def _draw_blow(made: "Figure", test: PlateTest) -> None:
    """Draw a blow: the component, and the printed forms beside it."""
    from ...pictures.style import GREY, INK, ROCK, TRANSMITTED

    r0, r1 = fitted_ends(test.impulse, test.area * cm2)
    end = stopping_time(test.impulse, r0, r1)
    panels = made.subplots(3, 1, sharex=True)
    constant = (0.5 * (r0 + r1),) * 2
    for ends, dashes, colour in (((r0, r1), "-", INK), (constant, "--", TRANSMITTED)):
        time, values = _history(ground(test, *ends), 1.25 * end)
        for axes, column in zip(panels, values.T, strict=True):
            axes.plot(time / ms, column, dashes, color=colour, linewidth=1.2)
    _, velocity, settlement = panels
    moving = mass(test.area, test.weight)
    v0 = initial_velocity(test.impulse, moving)
    velocity.plot([0.0, end / ms], [v0, 0.0], ":", color=ROCK)
    printed = printed_settlement(test.impulse, moving, r0, r1) / mm
    settlement.axhline(printed, color=ROCK, linestyle=":", linewidth=1.2)
    where: dict[str, Any] = {"xytext": (4, 3), "textcoords": "offset points"}
    settlement.annotate("(7)", (0.0, printed), **where, color=ROCK, fontsize=8.5)
    labels = ("R (kgf)", "v (m/s)", "settlement (mm)")
    for axes, label in zip(panels, labels, strict=True):
        axes.set(ylabel=label)
        axes.axvline(end / ms, color=GREY, linewidth=0.8)
    settlement.set(xlabel="time (ms); line: t_f of (6)", xlim=(0.0, 1.25 * end / ms))


def _history(made: Instance, end: float, steps: int = 200) -> tuple["np.ndarray", "np.ndarray"]:
    """Return times (s), and resistance (kgf), velocity (m/s) and settlement (mm) then."""
    times = np.linspace(0.0, end, steps + 1)
    rows = [_state(made)]
    for before, after in pairwise(times):
        made.step(before, after - before)
        rows.append(_state(made))
    return times, np.array(rows)


def _state(made: Instance) -> tuple[float, float, float]:
    return made["resistance"] / kgf, -made["velocity.y"], made["settlement"] / mm


STUDY = Study(
    "settlement",
    "Settlement under an impulse, (2) to (7)",
    2.0,
    rows,
    draw=draw,
    notes=("(3), a velocity that falls linearly, agrees with (1) for a constant resistance only.",),
)

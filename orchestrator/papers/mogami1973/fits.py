"""The two fits to the plate tests, and how they contradict (5) to (7).

(11) gives K over the area; (12) the lines of fig. 3, from which R0 and R1 are read. Only here are
the fits put into the model, to show that they do not agree with it.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rockshed.components.common.units import cm2, kgf, mm
from rockshed.components.impulsive_ground.settlement import (
    fitted_coefficient,
    fitted_ends,
    fitted_impulse,
    fitted_mean_resistance,
    printed_settlement,
)

from ..study import Outcomes, Row, Study, detail, verdict
from .plate_tests import (
    AREAS,
    MIDDLE,
    WEIGHTS,
    PlateTest,
    mass,
    plate_tests,
    sand_mass,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_K = kgf / mm
"""Unit of K in SI (N s/m)."""


def slope(area: float) -> float:
    """Return dI/dR_m (s) of (12) for a plate of this area (cm2)."""
    return fitted_impulse(2.0, area * cm2) - fitted_impulse(1.0, area * cm2)


def slope_of_model(area: float, weight: float = MIDDLE[0]) -> float:
    """Return dI/dR_m (s) that (5) to (7) give with K of (11).

    R_m = I2/(2 M settlement) = K I/(2 M), so it is 2 M/K.

    Parameters
    ----------
    area : float
        Area of the plate (cm2).
    weight : float
        Mass of the body that fell on it (kg).
    """
    return 2.0 * mass(area, weight) / fitted_coefficient(area * cm2)


def implied_mass(area: float) -> float:
    """Return the mass (kg) with which (11) and the slope of (12) would fit (5) to (7).

    The line passes the origin so near that R_m is in the ratio of I, as (7) with (11) has it; so
    this mass is that of every weight.

    Parameters
    ----------
    area : float
        Area of the plate (cm2).
    """
    return 0.5 * slope(area) * fitted_coefficient(area * cm2)


def rows(outcomes: Outcomes) -> list[Row]:
    """Return K, R0, R1, and the contradiction."""
    return [
        *(_coefficient(area) for area in AREAS),
        *(row for area in AREAS for row in _ends(area)),
        _slopes(),
        _rise(),
        _masses(),
        *(detail(row) for area in AREAS for row in _slope_and_mass(area)),
        _chained(),
    ]


def _coefficient(area: float) -> Row:
    return Row(
        f"(11): K, plate of {area:g} cm²",
        "kgf s/mm",
        computed=fitted_coefficient(area * cm2) / _K,
        note="the unit is not printed: the gauge reads 1/100 mm",
    )


def _ends(area: float) -> Iterator[Row]:
    """Yield R0 and R1, read from the lines of fig. 3."""
    r0, r1 = fitted_ends(PlateTest(area, *MIDDLE).impulse, area * cm2)
    weight, drop = MIDDLE
    yield Row(
        f"fig. 3: R0, plate of {area:g} cm²", "kgf", computed=r0 / kgf, note="R_m of (12) at I = 0"
    )
    yield Row(
        f"fig. 3: R1, plate of {area:g} cm²",
        "kgf",
        computed=r1 / kgf,
        note=f"2 R_m - R0 for {weight:g} kg from {drop:g} cm",
    )


def _slopes() -> Row:
    """Return whether the slope of (12) rises with the area, as (5) to (7) with (11) demand."""
    fitted = [slope(area) for area in AREAS]
    rise = _rise().computed
    return Row(
        "slope of (12), largest / smallest plate",
        "1",
        computed=fitted[-1] / fitted[0],
        verdict=verdict(fitted == sorted(fitted)),
        note=f"should rise with A as 2 M/K of (5)-(7), (11) does, by {rise:.2f}; it falls: (11) "
        "and (12) contradict each other",
    )


def _rise() -> Row:
    return Row(
        "2 M/K of (5) to (7) with (11), largest / smallest plate",
        "1",
        computed=slope_of_model(AREAS[-1]) / slope_of_model(AREAS[0]),
        note="the slope that (12) should have",
    )


def _masses() -> Row:
    """Return whether the mass that the fits imply can be that of (1): at least sand and plate."""
    implied = [implied_mass(area) for area in AREAS]
    least, most = sand_mass(AREAS[0]), sand_mass(AREAS[-1])
    return Row(
        "mass that (11) and (12) imply, smallest plate",
        "kg",
        paper=implied[0],
        computed=mass(AREAS[0], WEIGHTS[0]),
        verdict=verdict(implied[0] >= mass(AREAS[0], WEIGHTS[0])),
        note=f"implied are {min(implied):.1f} to {max(implied):.1f} kg, falling with A, the same "
        f"for every body that fell; by (1) sand alone has {least:.0f} to {most:.0f} kg, and the "
        f"four bodies make {WEIGHTS[-1] - WEIGHTS[0]:.1f} kg of difference: the sand that moved "
        "was less, or the fits do not see it",
    )


def _slope_and_mass(area: float) -> Iterator[Row]:
    yield Row(
        f"slope of (12), plate of {area:g} cm²",
        "ms",
        paper=1e3 * slope(area),
        computed=1e3 * slope_of_model(area),
        note="paper: (12); computed: 2 M/K with K of (11)",
    )
    yield Row(
        f"mass that (11) and (12) imply, plate of {area:g} cm²",
        "kg",
        paper=implied_mass(area),
        computed=mass(area, MIDDLE[0]),
        note=f"computed: (1); {mass(area, WEIGHTS[0]):.0f} to {mass(area, WEIGHTS[-1]):.0f} kg "
        "with the lightest and heaviest body",
    )


def _chained() -> Row:
    """Return the settlement with the ends of (12) in (7), over that of (11)."""
    ratios = [
        printed_settlement(t.impulse, mass(t.area, t.weight), *fitted_ends(t.impulse, t.area * cm2))
        / (t.impulse / fitted_coefficient(t.area * cm2))
        for t in plate_tests()
    ]
    return Row(
        "settlement of (12) in (7) / that of (11), 96 tests",
        "1",
        paper=1.0,
        computed=sum(ratios) / len(ratios),
        spread=float(np.std(ratios)),
        verdict=verdict(max(abs(ratio - 1.0) for ratio in ratios) < 0.1),
        note=f"{min(ratios):.2f} to {max(ratios):.2f}: never chain them",
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the lines of fig. 3, and K of (11) over the area."""
    from ...pictures.style import WIDTH, captioned

    lines = folder / "figure3.png"
    words = (
        "Lines of fig. 3 by (12), and (dashed) what (5) to (7) make of K of (11) with the mass "
        f"of (1) for a body of {MIDDLE[0]:g} kg: they should be the same lines. "
        "Inset: the foot of the lines, where R0 is read. 1600 kg/m³ and plates of 2 cm of steel "
        "assumed."
    )
    with captioned([words], lines, WIDTH, 4.4) as made:
        _draw_lines(made.subplots())
    coefficient = folder / "coefficient.png"
    words = (
        "Impulsive ground coefficient K = dI/d(settlement) by (11); circles: the paper's plates."
    )
    with captioned([words], coefficient, WIDTH, 3.0) as made:
        _draw_coefficient(made.subplots())
    return [lines, coefficient]


def _draw_lines(axes: "Axes") -> None:
    """Draw the mean resistance over the impulse, and its foot in an inset."""
    from ...pictures.style import BEAM, INK, ROCK, TRANSMITTED

    inset = axes.inset_axes((0.68, 0.12, 0.3, 0.34))
    impulse = np.linspace(0.0, 7.2, 100) * kgf
    near = np.linspace(0.0, 0.004, 2) * kgf
    for area, colour in zip(AREAS, (ROCK, TRANSMITTED, BEAM, INK), strict=True):
        fitted = _mean_resistances(impulse, area)
        modelled = impulse / slope_of_model(area) / kgf
        axes.plot(impulse / kgf, fitted, color=colour, label=f"{area:g} cm²")
        axes.plot(impulse / kgf, modelled, "--", color=colour, linewidth=1.0)
        inset.plot(near / kgf, _mean_resistances(near, area), color=colour, linewidth=1.0)
    inset.set(title="R0 (kgf) at I = 0", xlim=(0.0, 0.004))
    inset.title.set_fontsize(8.0)
    inset.tick_params(labelsize=7.0)
    axes.set(xlabel="impulse I (kgf s)", ylabel="mean resistance R_m (kgf)", xlim=(0.0, 7.2))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper left", title="plate", title_fontsize=8.5)


def _mean_resistances(impulses: np.ndarray, area: float) -> np.ndarray:
    """Return R_m (kgf) of (12) for impulses (N s) on a plate of this area (cm2)."""
    return np.array([fitted_mean_resistance(i, area * cm2) for i in impulses]) / kgf


def _draw_coefficient(axes: "Axes") -> None:
    """Draw K over the area of the plate."""
    from ...pictures.style import GREY, INK

    areas = np.linspace(50.0, 450.0, 200)
    plates = [fitted_coefficient(area * cm2) / _K for area in AREAS]
    axes.plot(areas, [fitted_coefficient(area * cm2) / _K for area in areas], color=INK)
    axes.plot(AREAS, plates, "o", color=GREY, fillstyle="none")
    axes.set(xlabel="area of the plate A (cm²)", ylabel="K (kgf s/mm)")


STUDY = Study(
    "fits",
    "Fits to the tests, (11) and (12), fig. 3",
    3.0,
    rows,
    draw=draw,
    notes=(
        "(11) and (12) are two separate fits. Put into (5) to (7) together they contradict each "
        "other, so the component takes neither; the defaults of R0 and R1 are read from (12) for "
        "one blow.",
    ),
)

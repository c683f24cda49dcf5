"""The two fits: K over the area, (11), and the lines of fig. 3, (12), with R0 and R1 read from them; how they contradict (5)-(7).

Only here are the fits put into the model, to show that they do not agree with it.
"""

from collections.abc import Sequence
from pathlib import Path

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
from .plate_tests import AREAS, MIDDLE, Trial, mass, trials

_K = kgf / mm


def slope(area: float) -> float:
    """dI/dR_m of (12) for a plate of so many cm2 (s)."""
    return (fitted_impulse(2.0, area * cm2) - fitted_impulse(1.0, area * cm2)) / 1.0


def slope_of_model(area: float) -> float:
    """dI/dR_m that (5) to (7) give with K of (11): R_m = I2/(2 M settlement) = K I/(2 M), so 2 M/K (s)."""
    return 2.0 * mass(area) / fitted_coefficient(area * cm2)


def implied_mass(area: float) -> float:
    """The mass (kg) with which (11) and the slope of (12) would fit (5) to (7)."""
    return 0.5 * slope(area) * fitted_coefficient(area * cm2)


def rows(found: Outcomes) -> list[Row]:
    """K, R0, R1, and the contradiction."""
    made = []
    for area in AREAS:
        made.append(
            Row(
                f"(11): K, plate of {area:g} cm²",
                "kgf s/mm",
                computed=fitted_coefficient(area * cm2) / _K,
                note="the unit is not printed: the gauge reads 1/100 mm",
            )
        )
    for area in AREAS:
        r0, r1 = fitted_ends(Trial(area, *MIDDLE).impulse, area * cm2)
        made.append(
            Row(
                f"fig. 3: R0, plate of {area:g} cm²",
                "kgf",
                computed=r0 / kgf,
                note="R_m of (12) at I = 0",
            )
        )
        made.append(
            Row(
                f"fig. 3: R1, plate of {area:g} cm²",
                "kgf",
                computed=r1 / kgf,
                note=f"2 R_m - R0 for {MIDDLE[0]:g} kg from {MIDDLE[1]:g} cm",
            )
        )
    fitted, model = [slope(area) for area in AREAS], [slope_of_model(area) for area in AREAS]
    made.append(
        Row(
            "slope of (12), largest / smallest plate",
            "1",
            computed=fitted[-1] / fitted[0],
            verdict=verdict(fitted == sorted(fitted)),
            note=f"should rise with A as 2 M/K of (5)-(7), (11) does, by "
            f"{model[-1] / model[0]:.2f}; it falls: (11) and (12) contradict each other",
        )
    )
    for area, one, other in zip(AREAS, fitted, model, strict=True):
        made.append(
            detail(
                Row(
                    f"slope of (12), plate of {area:g} cm²",
                    "ms",
                    paper=1e3 * one,
                    computed=1e3 * other,
                    note="paper: (12); computed: 2 M/K with K of (11)",
                )
            )
        )
        made.append(
            detail(
                Row(
                    f"mass that (11) and (12) imply, plate of {area:g} cm²",
                    "kg",
                    paper=implied_mass(area),
                    computed=mass(area),
                    note="computed: derived",
                )
            )
        )
    ratios = [
        printed_settlement(t.impulse, mass(t.area), *fitted_ends(t.impulse, t.area * cm2))
        / (t.impulse / fitted_coefficient(t.area * cm2))
        for t in trials()
    ]
    made.append(
        Row(
            "settlement of (12) in (7) / that of (11), 96 tests",
            "1",
            paper=1.0,
            computed=sum(ratios) / len(ratios),
            spread=float(np.std(ratios)),
            verdict=verdict(max(abs(r - 1.0) for r in ratios) < 0.1),
            note=f"{min(ratios):.2f} to {max(ratios):.2f}: never chain them",
        )
    )
    return made


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Fig. 3 and (11)."""
    from ...pictures.style import BEAM, GREY, INK, ROCK, TRANSMITTED, WIDTH, captioned

    files = [folder / "figure3.png", folder / "coefficient.png"]
    colours = (ROCK, TRANSMITTED, BEAM, INK)
    words = (
        "Lines of fig. 3 by (12), and (dashed) what (5) to (7) make of K of (11) with the derived mass: they should be "
        "the same lines. Inset: the foot of the lines, where R0 is read. 1600 kg/m³ and plates of 2 cm of steel assumed."
    )
    with captioned([words], files[0], WIDTH, 4.4) as made:
        axes = made.subplots()
        inset = axes.inset_axes((0.68, 0.12, 0.3, 0.34))
        impulse = np.linspace(0.0, 7.2, 100) * kgf
        for area, colour in zip(AREAS, colours, strict=True):
            mean = np.array([fitted_mean_resistance(i, area * cm2) for i in impulse]) / kgf
            axes.plot(impulse / kgf, mean, color=colour, label=f"{area:g} cm²")
            axes.plot(
                impulse / kgf,
                impulse / slope_of_model(area) / kgf,
                "--",
                color=colour,
                linewidth=1.0,
            )
            near = np.linspace(0.0, 0.004, 2) * kgf
            inset.plot(
                near / kgf,
                [fitted_mean_resistance(i, area * cm2) / kgf for i in near],
                color=colour,
                linewidth=1.0,
            )
        inset.set(title="R0 (kgf) at I = 0", xlim=(0.0, 0.004))
        inset.title.set_fontsize(8.0)
        inset.tick_params(labelsize=7.0)
        axes.set(xlabel="impulse I (kgf s)", ylabel="mean resistance R_m (kgf)", xlim=(0.0, 7.2))
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="upper left", title="plate", title_fontsize=8.5)
    areas = np.linspace(50.0, 450.0, 200)
    with captioned(
        ["Impulsive ground coefficient K = dI/d(settlement) by (11); circles: the paper's plates."],
        files[1],
        WIDTH,
        3.0,
    ) as made:
        axes = made.subplots()
        axes.plot(areas, [fitted_coefficient(a * cm2) / _K for a in areas], color=INK)
        axes.plot(
            AREAS,
            [fitted_coefficient(a * cm2) / _K for a in AREAS],
            "o",
            color=GREY,
            fillstyle="none",
        )
        axes.set(xlabel="area of the plate A (cm²)", ylabel="K (kgf s/mm)")
    return files


STUDY = Study(
    "fits",
    "Fits to the tests, (11) and (12), fig. 3",
    3.0,
    rows,
    draw=draw,
    notes=(
        "(11) and (12) are two separate fits. Put into (5) to (7) together they contradict each other, so the component takes neither; "
        "the defaults of R0 and R1 are read from (12) for one blow.",
    ),
)

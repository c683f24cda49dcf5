"""Figs 12 and 13, tables 3 and 4: the static loading test. Load over penetration, secant spring constant k, k against E_bar."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from statistics import mean, stdev
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import cm, kgf

from ...cases.sand_models import LATTICE_SHIFT
from ...cases.sonoda1993 import LAYER, STATIC_RATIO, printed_rows
from ...cases.static_loading import E_BAR, NAME, SPEED, STOP, rock_height
from ...core.system.system import Value
from ...metrics.load_curve import DEPTH, load_curve
from ...metrics.names import STATIC_DEPARTURE, STATIC_LOAD, STATIC_STIFFNESS
from ...runs.batch import COMPLETE, Task
from ...runs.job import Request
from ..statistics import line_through_origin
from ..study import Measure, Outcomes, Row, Study, origin, row_of_runs, verdict
from .laboratory import MODELS, SEEDS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

HASTE = 3
"""A quick study pushes so many times faster. The spring constants of the calibrated sand are the same within 1 % (six seeds)."""
PROPORTIONAL = 0.99
"""R2 from which on k counts as proportional to E_bar."""


@dataclass(frozen=True)
class Sand:
    """A model of the sand in a packing.

    model: one of :data:`MODELS`. values: what else is changed. step: internal step (s) at the smallest E_bar, which falls with
    its root, about 0.85 of the stable one. surface: the highest (m) that a sample may have; margin: how much lower (m) the lowest
    may be.
    """

    name: str
    model: str
    values: Mapping[str, Value]
    step: float
    surface: float = LAYER
    margin: float = 0.0


_LATTICE: Mapping[str, Value] = {"sand.lattice_shift": LATTICE_SHIFT}
_RANDOM: Mapping[str, Value] = {"sand.packing": "random", "sand.disc.spread": 0.25}
SANDS = (
    Sand("calibrated, square", "calibrated", _LATTICE, 1.38e-4),
    Sand("literal, square", "literal", _LATTICE, 7.5e-5),
    Sand("calibrated, random", "calibrated", _RANDOM, 1e-4, 14.4 * cm, 1.6 * cm),
    Sand("literal, random", "literal", _RANDOM, 5.6e-5, 11.4 * cm, 1.3 * cm),
)
"""What is pushed: models and packings. A further one is a line here."""


def pushes(sand: Sand, e_bar: float, quick: bool) -> list[Task]:
    """The static test of a sand with E_bar (kgf/cm2), one for each seed; in a quick study one, faster."""
    faster = HASTE if quick else 1
    changed: dict[str, Value] = {
        **MODELS[sand.model],
        **sand.values,
        "sand.modulus": e_bar * kgf / cm**2,
        "sand.internal_step": sand.step * (E_BAR[0] / e_bar) ** 0.5,
        "rock.position0.y": rock_height(sand.surface),
        "rock.velocity0.y": -SPEED * faster,
    }
    times = {
        "stop_time": round((STOP + sand.margin / SPEED) / faster, 2),
        "output_interval": 5e-3 if faster == 1 else 2e-3,
    }
    return [
        Task(Request(NAME, {**changed, "sand.seed": seed}, options=times), sand.name, seed)
        for seed in SEEDS[: 1 if quick else None]
    ]


def tasks(quick: bool) -> list[Task]:
    """Every sand with every E_bar."""
    return [task for sand in SANDS for e_bar in E_BAR for task in pushes(sand, e_bar, quick)]


# ------------------------------------------------------------------ rows


def rows(found: Outcomes) -> list[Row]:
    """For each sand load and k at every E_bar, then what they have in common, then table 4."""
    return [
        row
        for sand in SANDS
        for row in (*_of_each_modulus(sand, found), *_of_the_sand(sand, found))
    ]


def _of_each_modulus(sand: Sand, found: Outcomes) -> Iterator[Row]:
    for e_bar in E_BAR:
        chosen = pushes(sand, e_bar, found.quick)
        k = STATIC_RATIO * e_bar
        yield row_of_runs(
            Measure(f"k, E_bar {e_bar:.0f}", "kgf/cm", kgf / cm, STATIC_STIFFNESS),
            chosen,
            found,
            k,
            note=_PAPER,
        )
        load = row_of_runs(
            Measure(f"load at 4 cm, E_bar {e_bar:.0f}", "kgf", kgf, STATIC_LOAD),
            chosen,
            found,
            k * DEPTH / cm,
            note=_PAPER,
        )
        yield Row(**{**vars(load), "detail": True})


_PAPER = f"paper: k = {STATIC_RATIO} E_bar, table 4"


def _of_the_sand(sand: Sand, found: Outcomes) -> list[Row]:
    """k / E_bar, whether it is a constant, how straight the curves are, and E_bar of the tests of table 4."""
    chosen = [task for e_bar in E_BAR for task in pushes(sand, e_bar, found.quick)]
    where = origin(chosen, found)
    where["options"] = {
        name: value
        for name, value in where["options"].items()
        if name not in ("modulus", "internal_step")
    }
    if any(found.of(task).status != COMPLETE for task in chosen):
        return [
            Row(name, "1", model=sand.name, note="a run has no result", **where)
            for name in (_SLOPE, _R2)
        ]
    ks = spring_constants(sand, found)
    slope, r2 = line_through_origin(E_BAR, [mean(values) for values in zip(*ks, strict=True)])
    of_seeds = [line_through_origin(E_BAR, values) for values in ks]
    bent = [100.0 * found.of(task).metrics[STATIC_DEPARTURE] for task in chosen]
    spread_of_slope = _spread([a for a, _ in of_seeds])
    return [
        Row(
            _SLOPE,
            "cm",
            STATIC_RATIO,
            computed=slope,
            spread=spread_of_slope,
            model=sand.name,
            note="slope of the line through the origin and the means over the seeds; spread: of the seeds' own lines",
            **where,
        ),
        Row(
            _R2,
            "1",
            computed=r2,
            spread=_spread([r for _, r in of_seeds]),
            model=sand.name,
            verdict=verdict(r2 > PROPORTIONAL),
            note=f"holds from {PROPORTIONAL} on; of the means, about their mean",
            **where,
        ),
        Row(
            "departure of the load from the secant line / largest load",
            "%",
            model=sand.name,
            spread=_spread(bent),
            computed=mean(bent) if all(map(isfinite, bent)) else None,
            note="root mean square over the penetration, mean over all curves; the paper: nearly proportional",
            **where,
        ),
        *(
            _table_4_row(sand, printed, slope, spread_of_slope, where)
            for printed in printed_rows("table4")
        ),
    ]


def _spread(values: Sequence[float]) -> float | None:
    return stdev(values) if len(values) > 1 and all(map(isfinite, values)) else None


_SLOPE, _R2 = "k / E_bar", "k is proportional to E_bar: R²"


def _table_4_row(
    sand: Sand, printed: dict[str, str], slope: float, spread: float | None, where: dict[str, Any]
) -> Row:
    """E_bar of a test by its measured k; a detail for a sand that carries next to nothing."""
    number, k = int(printed["no"]), float(printed["k_kgf_per_cm"])
    doubt = (
        "; the printed value stands off the line of the others" if number == _OFF_THE_LINE else ""
    )
    return Row(
        f"table 4: E_bar of test {number}, from k = {k:g} kgf/cm",
        "kgf/cm2",
        float(printed["e_bar_kgf_per_cm2"]),
        computed=k / slope if slope > 0.0 else None,
        spread=k * spread / slope**2 if spread and slope > 0.0 else None,
        model=sand.name,
        note=f"k / (k / E_bar) of this sand{doubt}",
        detail=slope < 0.5 * STATIC_RATIO,
        **where,
    )


_OFF_THE_LINE = 8


def spring_constants(sand: Sand, found: Outcomes) -> list[list[float]]:
    """k (kgf/cm) of complete runs: for each seed a value for each E_bar."""
    by_modulus = [
        [
            found.of(task).metrics[STATIC_STIFFNESS] / kgf * cm
            for task in pushes(sand, e_bar, found.quick)
        ]
        for e_bar in E_BAR
    ]
    return [list(values) for values in zip(*by_modulus, strict=True)]


# ------------------------------------------------------------------ figures


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Figs 13 (a) and (b)."""
    return [_fig_13a(found, folder / "fig13a.png"), _fig_13b(listed, folder / "fig13b.png")]


def _curves(
    sand: Sand, e_bar: float, found: Outcomes
) -> "tuple[NDArray[np.float64], list[NDArray[np.float64]]]":
    """Penetrations (m) down to 4 cm and the loads (N) there, for each run."""
    import numpy as np

    places = np.linspace(0.0, DEPTH, 81)
    curves = [
        load_curve(found.of(task).series, "sand") for task in pushes(sand, e_bar, found.quick)
    ]
    return places, [
        curve.at(places) for curve in curves if curve is not None and curve.reaches(DEPTH)
    ]


def _fig_13a(found: Outcomes, file: Path) -> Path:
    import numpy as np

    from ...pictures.style import GREY, WIDTH, captioned

    lines = -(-len(SANDS) // 2)
    with captioned(
        [
            "Fig. 13 (a) of Sonoda et al. 1993: static test. Lines: mean over seeds of the load, itself the mean over 0.5 "
            "mm; bands: standard deviation. Dotted: the paper's secants, k = 1.29 E_bar. E_bar in kgf/cm²."
        ],
        file,
        WIDTH,
        2.6 * lines,
    ) as made:
        panels = made.subplots(lines, 2, squeeze=False).ravel()
        for axes, sand in zip(panels, SANDS):
            for number, e_bar in enumerate(E_BAR):
                places, loads = _curves(sand, e_bar, found)
                colour = _SHADES[number]
                axes.plot(
                    [0.0, DEPTH / cm],
                    [0.0, STATIC_RATIO * e_bar * DEPTH / cm],
                    ":",
                    color=colour,
                    linewidth=0.9,
                )
                if loads:
                    middle, width = (
                        np.mean(loads, axis=0) / kgf,
                        np.std(loads, axis=0, ddof=min(1, len(loads) - 1)) / kgf,
                    )
                    axes.plot(places / cm, middle, color=colour, linewidth=1.2)
                    axes.fill_between(
                        places / cm,
                        middle - width,
                        middle + width,
                        color=colour,
                        alpha=0.2,
                        linewidth=0,
                    )
                axes.annotate(
                    f"{e_bar:.0f}",
                    (4.0, STATIC_RATIO * e_bar * DEPTH / cm),
                    xytext=(3, 0),
                    textcoords="offset points",
                    va="center",
                    fontsize=7.5,
                    color=colour,
                )
            axes.set_title(sand.name)
            axes.set(xlim=(0.0, 4.3), xlabel="penetration (cm)", ylabel="load (kgf)")
            axes.axhline(0.0, color=GREY, linewidth=0.7)
        for axes in panels[len(SANDS) :]:
            axes.set_axis_off()
    return file


_SHADES = ("#9ecae1", "#5fa3d0", "#2f7fbc", "#155a9c", "#08306b")
"""One for each E_bar, the softest sand the lightest."""


def _fig_13b(listed: Sequence[Row], file: Path) -> Path:
    from ...pictures.style import BEAM, GREY, INK, ROCK, SAND, TRANSMITTED, WIDTH, captioned

    with captioned(
        [
            "Fig. 13 (b) of Sonoda et al. 1993: secant spring constant k at 4 cm over the fictitious modulus E_bar. Bars: "
            "standard deviation over seeds. Squares: tests of table 4."
        ],
        file,
        WIDTH,
        4.0,
    ) as made:
        axes = made.subplots()
        top = max(E_BAR)
        axes.plot(
            [0.0, top],
            [0.0, STATIC_RATIO * top],
            ":",
            color=GREY,
            label=f"paper: k = {STATIC_RATIO} E_bar",
        )
        printed = [
            (float(row["e_bar_kgf_per_cm2"]), float(row["k_kgf_per_cm"]))
            for row in printed_rows("table4")
        ]
        axes.plot(*zip(*printed), "s", color=INK, markersize=4.5, label="paper: table 4")
        colours = (TRANSMITTED, BEAM, ROCK, SAND, "#8c2f12", "#7a5195", INK)
        for sand, colour in zip(SANDS, colours * len(SANDS)):
            points = [
                (e_bar, row)
                for e_bar in E_BAR
                for row in listed
                if row.model == sand.name
                and row.quantity == f"k, E_bar {e_bar:.0f}"
                and row.computed is not None
            ]
            axes.errorbar(
                [e_bar for e_bar, _ in points],
                [row.computed for _, row in points],  # type: ignore[arg-type]
                yerr=[row.spread or 0.0 for _, row in points],
                fmt="o-",
                color=colour,
                markersize=3.5,
                linewidth=1.0,
                label=sand.name,
            )
        axes.set(
            xlabel="fictitious modulus E_bar (kgf/cm²)",
            ylabel="secant spring constant k (kgf/cm)",
            xlim=(0.0, 1.06 * top),
        )
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="upper left")
    return file


STUDY = Study(
    "static",
    "Figs 12, 13, table 4: static loading test",
    3.0,
    rows,
    tasks,
    draw,
    (
        f"Mean and standard deviation over {len(SEEDS)} seeds: of a square lattice shifted by {LATTICE_SHIFT:g} diameters, or of "
        f"random packings of discs ±25 % in size; with --quick one seed, pushed at {100 * SPEED * HASTE:g} cm/s instead of "
        f"{100 * SPEED:g}.",
        "A load is the mean over half a millimetre of penetration. calibrated: rotation locked, stiffness factor 0.37 where no other "
        "is named. literal: three freedoms a disc, factor 1.",
        "A random packing of discs that cannot turn stays so loose (height 14 cm instead of 10) that it carries nothing.",
    ),
)

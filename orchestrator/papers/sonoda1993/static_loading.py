"""Figs 12 and 13, tables 3 and 4: the static loading test.

Load over penetration, secant spring constant k, k against E_bar.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from statistics import mean, stdev
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import cm, kgf

from ...cases.sand_models import LATTICE_SHIFT
from ...cases.sonoda1993 import LAYER, STATIC_RATIO, printed_rows
from ...cases.static_loading import E_BAR, NAME, SPEED, STOP, rock_height
from ...core.system.fields import Value
from ...metrics.load_curve import DEPTH, load_curve
from ...metrics.names import STATIC_DEPARTURE, STATIC_LOAD, STATIC_STIFFNESS
from ...runs.batch import COMPLETE, Task
from ...runs.job import Request
from ..statistics import line_through_origin
from ..study import Measure, Outcomes, Row, Study, origin, row_of_runs, shortened, verdict
from .laboratory import MODELS, SEEDS

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

HASTE = 3
"""Factor by which a quick study pushes faster.

The spring constants of the calibrated sand are the same within 1 % (six seeds).
"""
PROPORTIONAL = 0.99
"""Least R2 with which k counts as proportional to E_bar."""


@dataclass(frozen=True)
class PushedSand:
    """Model of the sand in a packing.

    Attributes
    ----------
    name : str
        For the reader.
    model : str
        One of :data:`MODELS`.
    values : mapping of str to Value
        Further values.
    step : float
        Internal step (s) at the smallest E_bar, about 0.85 of the stable one; it falls with the
        root of E_bar.
    surface : float
        Highest surface (m) that a sample may have.
    margin : float
        Height (m) by which the mean level of the lowest one may be lower.
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
    PushedSand("calibrated, square", "calibrated", _LATTICE, 1.38e-4),
    PushedSand("literal, square", "literal", _LATTICE, 7.5e-5),
    PushedSand("calibrated, random", "calibrated", _RANDOM, 1e-4, 14.4 * cm, 1.9 * cm),
    PushedSand("literal, random", "literal", _RANDOM, 5.6e-5, 11.4 * cm, 1.4 * cm),
)
"""Models and packings that are pushed."""


def pushes(sand: PushedSand, e_bar: float, quick: bool) -> list[Task]:
    """Return the static test of a sand, one for each seed.

    Parameters
    ----------
    sand : PushedSand
        Model and packing.
    e_bar : float
        E_bar (kgf/cm2).
    quick : bool
        One run, faster.
    """
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
    """Return the tests of every sand with every E_bar."""
    return [task for sand in SANDS for e_bar in E_BAR for task in pushes(sand, e_bar, quick)]


def _short(sand: PushedSand) -> Request:
    """Return the beginning of a static test that is thirty times as fast."""
    request = shortened(pushes(sand, E_BAR[2], True)[0], 0.04)
    return replace(request, values={**request.values, "rock.velocity0.y": -30.0 * SPEED})


SHORT_PUSHES: Mapping[str, Request] = {f"push, {sand.name}": _short(sand) for sand in SANDS}
"""Beginnings of tests; the disc does not reach random packings, which have settled by then."""


# ------------------------------------------------------------------ rows


def rows(outcomes: Outcomes) -> list[Row]:
    """Return for each sand load and k at every E_bar, their common line, and table 4."""
    return [
        row
        for sand in SANDS
        for row in (*_of_each_modulus(sand, outcomes), *_of_the_sand(sand, outcomes))
    ]


def _of_each_modulus(sand: PushedSand, outcomes: Outcomes) -> Iterator[Row]:
    for e_bar in E_BAR:
        chosen = pushes(sand, e_bar, outcomes.quick)
        k = STATIC_RATIO * e_bar
        yield row_of_runs(
            Measure(f"k, E_bar {e_bar:.0f}", "kgf/cm", kgf / cm, STATIC_STIFFNESS),
            chosen,
            outcomes,
            k,
            note=_PAPER,
        )
        load = row_of_runs(
            Measure(f"load at 4 cm, E_bar {e_bar:.0f}", "kgf", kgf, STATIC_LOAD),
            chosen,
            outcomes,
            k * DEPTH / cm,
            note=_PAPER,
        )
        yield Row(**{**vars(load), "detail": True})


_PAPER = f"paper: k = {STATIC_RATIO} E_bar, table 4"


def _of_the_sand(sand: PushedSand, outcomes: Outcomes) -> list[Row]:
    """Return k / E_bar, whether it is a constant, how straight the curves are, and table 4."""
    chosen = [task for e_bar in E_BAR for task in pushes(sand, e_bar, outcomes.quick)]
    where = {"model": sand.name, **origin(chosen, outcomes)}
    where["options"] = {
        name: value
        for name, value in where["options"].items()
        if name not in ("modulus", "internal_step")
    }
    if any(outcomes.of(task).status != COMPLETE for task in chosen):
        return [Row(name, "1", note="a run has no result", **where) for name in (_SLOPE, _R2)]
    bent = [100.0 * outcomes.of(task).metrics[STATIC_DEPARTURE] for task in chosen]
    line = _line(sand, outcomes, where)
    return [*line, _departure(bent, where), *_table_4(line[0], where)]


def _line(sand: PushedSand, outcomes: Outcomes, where: dict[str, Any]) -> tuple[Row, Row]:
    """Return slope and R2 of the line through the origin, with the spread of the seeds' own."""
    ks = spring_constants(sand, outcomes)
    slope, r2 = line_through_origin(E_BAR, [mean(values) for values in zip(*ks, strict=True)])
    of_seeds = [line_through_origin(E_BAR, values) for values in ks]
    return (
        Row(
            _SLOPE,
            "cm",
            STATIC_RATIO,
            computed=slope,
            spread=_spread([a for a, _ in of_seeds]),
            note="slope of the line through the origin and the means over the seeds; spread: of "
            "the seeds' own lines",
            **where,
        ),
        Row(
            _R2,
            "1",
            computed=r2,
            spread=_spread([r for _, r in of_seeds]),
            verdict=verdict(r2 > PROPORTIONAL),
            note=f"holds from {PROPORTIONAL} on; of the means, about their mean",
            **where,
        ),
    )


def _departure(bent: Sequence[float], where: dict[str, Any]) -> Row:
    """Return how far the curves are from their secants (%)."""
    return Row(
        "departure of the load from the secant line / largest load",
        "%",
        spread=_spread(bent),
        computed=mean(bent) if all(map(isfinite, bent)) else None,
        note="root mean square over the penetration, mean over all curves; the paper: nearly "
        "proportional",
        **where,
    )


def _spread(values: Sequence[float]) -> float | None:
    return stdev(values) if len(values) > 1 and all(map(isfinite, values)) else None


_SLOPE = "k / E_bar"
_R2 = "k is proportional to E_bar: R²"


def _table_4(line: Row, where: dict[str, Any]) -> list[Row]:
    """Return E_bar of the tests by their measured k.

    They are details for a sand that carries almost nothing.
    """
    slope = line.computed or 0.0
    return [
        Row(
            f"table 4: E_bar of test {number}, from k = {k:g} kgf/cm",
            "kgf/cm2",
            e_bar,
            computed=k / slope if slope > 0.0 else None,
            spread=k * line.spread / slope**2 if line.spread and slope > 0.0 else None,
            note="k / (k / E_bar) of this sand" + (_DOUBT if number == _OFF_THE_LINE else ""),
            detail=slope < 0.5 * STATIC_RATIO,
            **where,
        )
        for number, k, e_bar in _printed()
    ]


def _printed() -> list[tuple[int, float, float]]:
    """Return number, k (kgf/cm) and E_bar (kgf/cm2) of the rows of table 4."""
    return [
        (int(row["no"]), float(row["k_kgf_per_cm"]), float(row["e_bar_kgf_per_cm2"]))
        for row in printed_rows("table4")
    ]


_DOUBT = "; the printed value stands off the line of the others"
_OFF_THE_LINE = 8
"""Test whose printed E_bar stands off the line of the others."""


def spring_constants(sand: PushedSand, outcomes: Outcomes) -> list[list[float]]:
    """Return k (kgf/cm) of complete runs: for each seed a value for each E_bar."""
    by_modulus = [
        [
            outcomes.of(task).metrics[STATIC_STIFFNESS] / kgf * cm
            for task in pushes(sand, e_bar, outcomes.quick)
        ]
        for e_bar in E_BAR
    ]
    return [list(values) for values in zip(*by_modulus, strict=True)]


# ------------------------------------------------------------------ figures


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw figs 13 (a) and (b)."""
    return [_fig_13a(outcomes, folder / "fig13a.png"), _fig_13b(listed, folder / "fig13b.png")]


def _curves(
    sand: PushedSand, e_bar: float, outcomes: Outcomes
) -> "tuple[NDArray[np.float64], list[NDArray[np.float64]]]":
    """Return penetrations (m) down to 4 cm and the loads (N) there, for each run."""
    import numpy as np

    places = np.linspace(0.0, DEPTH, 81)
    curves = [
        load_curve(outcomes.of(task).series, "sand") for task in pushes(sand, e_bar, outcomes.quick)
    ]
    return places, [
        curve.at(places) for curve in curves if curve is not None and curve.reaches(DEPTH)
    ]


def _fig_13a(outcomes: Outcomes, file: Path) -> Path:
    from ...pictures.style import WIDTH, captioned

    lines = -(-len(SANDS) // 2)
    words = (
        "Fig. 13 (a) of Sonoda et al. 1993: static test. Lines: mean over seeds of the load, "
        "itself the mean over 0.5 mm; bands: standard deviation. Dotted: the paper's secants, k = "
        "1.29 E_bar. E_bar in kgf/cm²."
    )
    with captioned([words], file, WIDTH, 2.6 * lines) as made:
        panels = made.subplots(lines, 2, squeeze=False).ravel()
        for axes, sand in zip(panels, SANDS, strict=False):
            _draw_sand(axes, sand, outcomes)
        for axes in panels[len(SANDS) :]:
            axes.set_axis_off()
    return file


def _draw_sand(axes: "Axes", sand: PushedSand, outcomes: Outcomes) -> None:
    """Draw load over penetration of a sand, for every E_bar."""
    from ...pictures.style import GREY

    for e_bar, colour in zip(E_BAR, _SHADES, strict=True):
        secant = STATIC_RATIO * e_bar * DEPTH / cm
        axes.plot([0.0, DEPTH / cm], [0.0, secant], ":", color=colour, linewidth=0.9)
        places, loads = _curves(sand, e_bar, outcomes)
        if loads:
            _draw_band(axes, places, loads, colour)
        axes.annotate(
            f"{e_bar:.0f}",
            (4.0, secant),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=7.5,
            color=colour,
        )
    axes.set_title(sand.name)
    axes.set(xlim=(0.0, 4.3), xlabel="penetration (cm)", ylabel="load (kgf)")
    axes.axhline(0.0, color=GREY, linewidth=0.7)


def _draw_band(
    axes: "Axes", places: "NDArray[np.float64]", loads: "list[NDArray[np.float64]]", colour: str
) -> None:
    """Draw mean and standard deviation of loads (N) over penetrations (m)."""
    import numpy as np

    middle = np.mean(loads, axis=0) / kgf
    width = np.std(loads, axis=0, ddof=min(1, len(loads) - 1)) / kgf
    axes.plot(places / cm, middle, color=colour, linewidth=1.2)
    axes.fill_between(
        places / cm, middle - width, middle + width, color=colour, alpha=0.2, linewidth=0
    )


_SHADES = ("#9ecae1", "#5fa3d0", "#2f7fbc", "#155a9c", "#08306b")
"""Colours by E_bar, the softest sand the lightest."""


def _fig_13b(listed: Sequence[Row], file: Path) -> Path:
    from ...pictures.style import GREY, INK, WIDTH, captioned, legend

    top = max(E_BAR)
    words = (
        "Fig. 13 (b) of Sonoda et al. 1993: secant spring constant k at 4 cm over the fictitious "
        "modulus E_bar. Bars: standard deviation over seeds. Squares: tests of table 4."
    )
    with captioned([words], file, WIDTH, 4.0) as made:
        axes = made.subplots()
        label = f"paper: k = {STATIC_RATIO} E_bar"
        axes.plot([0.0, top], [0.0, STATIC_RATIO * top], ":", color=GREY, label=label)
        e_bars = [e_bar for _, _, e_bar in _printed()]
        ks = [k for _, k, _ in _printed()]
        axes.plot(e_bars, ks, "s", color=INK, markersize=4.5, label="paper: table 4")
        _draw_constants(axes, listed)
        axes.set(xlabel="fictitious modulus E_bar (kgf/cm²)", xlim=(0.0, 1.06 * top))
        axes.set(ylabel="secant spring constant k (kgf/cm)")
        axes.set_ylim(bottom=0.0)
        legend(axes)
    return file


def _draw_constants(axes: "Axes", listed: Sequence[Row]) -> None:
    """Draw k over E_bar for every sand, with its spread."""
    from ...pictures.style import BEAM, ROCK, SAND, TRANSMITTED

    rows_by = {(row.model, row.quantity): row for row in listed}
    for sand, colour in zip(SANDS, (TRANSMITTED, BEAM, ROCK, SAND), strict=True):
        each = [(e_bar, rows_by[sand.name, f"k, E_bar {e_bar:.0f}"]) for e_bar in E_BAR]
        points = [
            (e_bar, row.computed, row.spread or 0.0)
            for e_bar, row in each
            if row.computed is not None
        ]
        if points:
            x, y, spread = zip(*points, strict=True)
            form: dict[str, Any] = {"fmt": "o-", "markersize": 3.5, "linewidth": 1.0}
            axes.errorbar(x, y, yerr=spread, color=colour, label=sand.name, **form)


STUDY = Study(
    "static",
    "Figs 12, 13, table 4: static loading test",
    3.0,
    rows,
    tasks,
    draw,
    (
        f"Mean and standard deviation over {len(SEEDS)} seeds: of a square lattice shifted by "
        f"{LATTICE_SHIFT:g} diameters, or of random packings of discs ±25 % in size; in a quick "
        f"reproduction one seed, pushed at {100 * SPEED * HASTE:g} cm/s instead of "
        f"{100 * SPEED:g}.",
        "A load is the mean over half a millimetre of penetration. calibrated: rotation locked, "
        "stiffness factor 0.342 where no other is named. literal: three freedoms a disc, factor 1.",
        "A random packing of discs that cannot turn stays so loose (height 14 cm instead of 10) "
        "that it carries nothing.",
    ),
    stands_on=SHORT_PUSHES,
)

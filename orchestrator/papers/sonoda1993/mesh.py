"""How far the size of the discs and of the beam's elements decides what is computed.

Discs of a half and a quarter of the size, and beams of more and fewer elements, under test 4; discs
of half the size on the girders.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import cm, kgf, mm

from ...cases import full_scale, sonoda1993
from ...cases.sand_models import SandLayer, discs_of
from ...cases.sonoda1993 import (
    BALL_RADIUS,
    BOX_WIDTH,
    DEFAULT_TEST,
    DISC_RADIUS,
    ELEMENTS,
    LAYER,
)
from ...core.system.fields import Value
from ...metrics.names import (
    BEAM_ENERGY_FROM_STRAIN,
    PEAK_TRANSMITTED,
    PENETRATION,
)
from ...runs.batch import Task
from ..study import Measure, Outcomes, Row, Study, row_of_runs
from . import full_scale as at_full_scale
from .laboratory import ALL_MODELS, MODELS, ONE_LAW, SHORT_IMPACTS, impact

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DIVISIONS = (1, 2, 4)
"""Parts into which the shipped radius of the discs is divided."""
BEAMS = (12, 24, 48, 96)
"""Numbers of elements of the beam in the laboratory."""
SEEDS = range(1, 6)
FINEST_SEEDS = 3
"""Number of seeds of the finest discs, a run of which takes up to a minute."""
_GAP = 0.5 * mm
_STEP = 1e-5
"""Internal step (s) of the sand with the shipped discs; it falls with their radius."""
_BEAM_STEP = 1e-6
"""Internal step (s) of the shipped beam; it falls with the square of an element's length."""
MEASURES = (
    Measure("peak transmitted force", "kgf", kgf, PEAK_TRANSMITTED),
    Measure("penetration", "cm", cm, PENETRATION),
    Measure("peak beam energy, eq. (7)", "kgf cm", kgf * cm, BEAM_ENERGY_FROM_STRAIN),
)
"""Quantities of the laboratory that are compared."""
_SPANS = [impact for impact in full_scale.impacts().values() if impact.span]


@dataclass(frozen=True)
class Mesh:
    """A discretisation of one system with one model of the sand.

    Attributes
    ----------
    words : str
        The discretisation for the reader.
    model : str
        Model of the sand.
    size : float
        Radius of the discs (mm), or number of elements.
    tasks : sequence of Task
        A run for each seed.
    """

    words: str
    model: str
    size: float
    tasks: Sequence[Task] = field(default_factory=tuple)


def with_discs(model: str, division: int, quick: bool) -> Mesh:
    """Return test 4 with discs of a part of the size.

    Parameters
    ----------
    model : str
        Model of the sand.
    division : int
        Number by which the radius is divided.
    quick : bool
        One seed only.
    """
    radius = DISC_RADIUS / division
    words = f"discs of radius {radius / mm:g} mm"
    changes: dict[str, Value] = {}
    sizes: dict[str, int] = {}
    if division > 1:
        changes = {"sand.disc.radius": radius, "sand.internal_step": _STEP / division}
        sizes = {"sand.discs": _discs(model, radius)}
        if model != ONE_LAW:
            changes["rock.position0.y"] = LAYER + BALL_RADIUS + _GAP
    made = _impacts(model, changes, sizes, quick)
    if division == DIVISIONS[-1]:
        made = made[:FINEST_SEEDS]
    return Mesh(words, model, radius / mm, made)


def with_elements(model: str, elements: int, quick: bool) -> Mesh:
    """Return test 4 with a beam of so many elements.

    Parameters
    ----------
    model : str
        Model of the sand.
    elements : int
        Number of elements.
    quick : bool
        One seed only.
    """
    words = f"beam of {elements} elements"
    if elements == ELEMENTS:
        return Mesh(words, model, elements, _impacts(model, {}, {}, quick))
    step = _BEAM_STEP * min(1.0, (ELEMENTS / elements) ** 2)
    sizes = {"beam.elements": elements, "sand.elements": elements}
    return Mesh(words, model, elements, _impacts(model, {"beam.internal_step": step}, sizes, quick))


def _discs(model: str, radius: float) -> int:
    """Return the number of discs of a radius (m) that make the layer of test 4."""
    test = sonoda1993.tests()[DEFAULT_TEST]
    if model == ONE_LAW:
        return _filling(sonoda1993.layer(test), radius)
    return round(BOX_WIDTH[test.box] / (2 * radius)) * round(LAYER / (2 * radius))


def _filling(layer: SandLayer, radius: float) -> int:
    return discs_of(replace(layer, disc_radius=radius), layer.soil.solid_fraction)


def _impacts(
    model: str, changes: Mapping[str, Value], sizes: Mapping[str, int], quick: bool
) -> list[Task]:
    """Return test 4 with few exchanges, a run for each seed."""
    made = [
        impact(DEFAULT_TEST, model, changes, seed, "impulse")
        for seed in SEEDS[: 1 if quick else None]
    ]
    return [replace(task, request=replace(task.request, sizes=sizes)) for task in made]


def on_girders(impact_on: full_scale.Impact, division: int, quick: bool) -> Mesh:
    """Return the one law on girders with discs of a part of the size.

    Parameters
    ----------
    impact_on : Impact
        The impact.
    division : int
        Number by which the radius is divided.
    quick : bool
        One packing only.
    """
    radius = full_scale.DISC_RADIUS / division
    model = next(model for model in at_full_scale.MODELS if model.name == ONE_LAW)
    words = f"girders of {impact_on.span:g} m, discs of radius {radius / cm:g} cm"
    made = at_full_scale.impacts(impact_on.name, model, quick, _GIRDERS_STOP)[: len(SEEDS)]
    if division > 1:
        sizes = {"sand.discs": _filling(full_scale.layer(impact_on), radius)}
        changes = {
            "sand.disc.radius": radius,
            "sand.internal_step": impact_on.steps["paper"] / division,
        }
        made = [_refined(task, changes, sizes) for task in made]
    return Mesh(words, ONE_LAW, radius / mm, made)


_GIRDERS_STOP = 0.16


def _refined(task: Task, changes: Mapping[str, Value], sizes: Mapping[str, int]) -> Task:
    values = {**task.request.values, **changes}
    return replace(task, request=replace(task.request, values=values, sizes=sizes))


def sands(quick: bool) -> list[list[Mesh]]:
    """Return the divisions of the discs, for each model; the finest not if quick."""
    divisions = DIVISIONS[:2] if quick else DIVISIONS
    return [[with_discs(model, part, quick) for part in divisions] for model in ALL_MODELS]


def beams(quick: bool) -> list[list[Mesh]]:
    """Return the divisions of the beam, for each model of the paper's sand."""
    return [[with_elements(model, number, quick) for number in BEAMS] for model in MODELS]


def girders(quick: bool) -> list[list[Mesh]]:
    """Return the divisions of the discs, for each span."""
    return [[on_girders(each, part, quick) for part in DIVISIONS[:2]] for each in _SPANS]


def tasks(quick: bool) -> list[Task]:
    """Return the runs of all discretisations."""
    every = [*sands(quick), *beams(quick), *girders(quick)]
    return [task for meshes in every for mesh in meshes for task in mesh.tasks]


# ------------------------------------------------------------------ rows


def rows(outcomes: Outcomes) -> list[Row]:
    """Return what every discretisation gives, and how far the shipped one is from the finest."""
    quick = outcomes.quick
    listed = []
    for meshes in sands(quick):
        listed += _compared(meshes, meshes[0], MEASURES, outcomes)
    for meshes in beams(quick):
        listed += _compared(meshes, meshes[BEAMS.index(ELEMENTS)], MEASURES, outcomes)
    for meshes in girders(quick):
        listed += _compared(meshes, meshes[0], (_ENERGY,), outcomes)
    return listed


_ENERGY = Measure(
    "girders' energy / rock's by eq. (7)",
    "%",
    0.01,
    at_full_scale.share(BEAM_ENERGY_FROM_STRAIN),
)


def _compared(
    meshes: Sequence[Mesh], shipped: Mesh, measures: Sequence[Measure], outcomes: Outcomes
) -> list[Row]:
    """Return a row for each discretisation, and one for the shipped against the finest."""
    made = []
    for measure in measures:
        each = [_row(measure, mesh, outcomes) for mesh in meshes]
        made += [*each, _difference(measure, each[meshes.index(shipped)], each[-1], meshes)]
    return made


def _row(measure: Measure, mesh: Mesh, outcomes: Outcomes) -> Row:
    named = replace(measure, quantity=f"{measure.quantity}, {mesh.words}")
    return row_of_runs(named, mesh.tasks, outcomes)


def _difference(measure: Measure, shipped: Row, finest: Row, meshes: Sequence[Mesh]) -> Row:
    """Return the shipped discretisation over the finest, less 1 (%).

    Its spread is that of the difference of two means of independent samples.
    """
    quantity = f"{measure.quantity}, shipped size over the finest ({meshes[-1].words})"
    where: dict[str, Any] = {
        "model": shipped.model,
        "runs": [*shipped.runs, *finest.runs],
        "seeds": shipped.seeds,
        "fmus": finest.fmus,
    }
    if not shipped.computed or not finest.computed:
        return Row(quantity, "%", note="a size has no result", **where)
    ratio = shipped.computed / finest.computed
    return Row(
        quantity,
        "%",
        computed=100.0 * (ratio - 1.0),
        spread=_of_the_means(shipped, finest, ratio),
        note="spread: standard error of the two means",
        **where,
    )


def _of_the_means(shipped: Row, finest: Row, ratio: float) -> float | None:
    """Return the standard error (%) of the ratio of two means; None without spreads."""
    if shipped.spread is None or finest.spread is None:
        return None
    assert shipped.computed
    assert finest.computed
    parts = [
        (row.spread or 0.0) / (row.computed or 1.0) / len(row.seeds) ** 0.5
        for row in (shipped, finest)
    ]
    return 100.0 * ratio * (parts[0] ** 2 + parts[1] ** 2) ** 0.5


# ------------------------------------------------------------------ figure


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the quantities over the radius of the discs, and over the number of elements."""
    from ...pictures.style import WIDTH, captioned, legend

    file = folder / "mesh.png"
    words = (
        "Test 4 of Sonoda et al. 1993 with discs and beam elements of other sizes, over the value "
        "with the shipped size (discs of 5 mm, 24 elements). Bars: standard deviation over seeds."
    )
    values = {(row.model, row.quantity): row for row in listed}
    with captioned([words], file, WIDTH, 4.6) as made:
        grid = made.subplots(2, len(MEASURES), sharey=True, squeeze=False)
        for axes, measure in zip(grid[0], MEASURES, strict=True):
            _draw(axes, measure, sands(outcomes.quick), 0, values)
            axes.set(title=measure.quantity, xlabel="radius of the discs (mm)", xscale="log")
            axes.set_xticks([1.25, 2.5, 5.0], ["1.25", "2.5", "5"], minor=False)
        for axes, measure in zip(grid[1], MEASURES, strict=True):
            _draw(axes, measure, beams(outcomes.quick), BEAMS.index(ELEMENTS), values)
            axes.set(xlabel="elements of the beam", xscale="log")
            axes.set_xticks(BEAMS, [str(number) for number in BEAMS], minor=False)
        for axes in grid.ravel():
            axes.xaxis.set_minor_formatter("")
        legend(grid[0][0])
    return [file]


def _draw(
    axes: "Axes",
    measure: Measure,
    lines: Sequence[Sequence[Mesh]],
    shipped: int,
    values: Mapping[tuple[str, str], Row],
) -> None:
    """Draw a quantity over the size, in parts of that of the shipped size, a line a model."""
    from ...pictures.style import BEAM, GREY, ROCK, TRANSMITTED

    for meshes, colour in zip(lines, (TRANSMITTED, ROCK, BEAM), strict=False):
        each = [values[mesh.model, f"{measure.quantity}, {mesh.words}"] for mesh in meshes]
        unit = each[shipped].computed
        if not unit:
            continue
        known = [(m.size, row) for m, row in zip(meshes, each, strict=True) if row.computed]
        axes.errorbar(
            [size for size, _ in known],
            [(row.computed or 0.0) / unit for _, row in known],
            [(row.spread or 0.0) / unit for _, row in known],
            color=colour,
            label=meshes[0].model,
            marker="o",
            markersize=3,
            linewidth=1.0,
        )
    axes.axhline(1.0, color=GREY, linewidth=0.7)


STUDY = Study(
    "mesh",
    "Size of the discs and of the beam's elements",
    5.3,
    rows,
    tasks,
    draw,
    (
        f"Test 4, {len(SEEDS)} seeds for each size ({FINEST_SEEDS} of the finest discs), exchange "
        "every 0.1 ms; internal steps of sand and beam fall with the size. In a quick "
        "reproduction one seed, and not the finest discs.",
        "Shipped are discs of 5 mm, 24 elements, and discs of 5 cm on the girders.",
    ),
    stands_on={
        **SHORT_IMPACTS,
        **{
            name: request
            for name, request in at_full_scale.SHORT_GIRDERS.items()
            if name.endswith(ONE_LAW)
        },
    },
)

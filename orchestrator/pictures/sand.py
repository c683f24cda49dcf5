"""The sand at several instants: discs, rock, beam, and the forces in the contacts as lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from rockshed.components.common.roles import Role
from rockshed.components.common.units import cm, kN, ms

from ..core.results.reading import StoredRun
from ..metrics.caption import caption
from ..metrics.contents import decoded
from ..metrics.energy import structures
from ..metrics.roles import column, elements, members
from ..metrics.values import extreme
from .cushion import force_axes
from .references import KnownMetrics
from .style import BEAM, GREY, INK, captioned

FRAMES = 6
_READ_AS = (
    "lines: forces in the contacts, by width and colour; deep: the rock's lowest point below "
    "the surface that the sand had at the start; transmitted: vertical force of the sand on its "
    "base"
)
_BARS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Lengths of the scale bar (cm): the largest of these that is at most a quarter of the box."""
DEFLECTION_SCALES = (30.0, 20.0, 10.0, 5.0, 3.0, 2.0, 1.0)
"""Deflections of the beam's axis are drawn so many times too large: the largest of these that keeps
them within a disc."""
_INTERESTING = 0.25
"""The frames end when the transmitted force has fallen below this part of its peak for good."""
_CHAINS = LinearSegmentedColormap.from_list("chains", ["#e8c98f", "#e08a2e", "#c23b22", "#5a0f3c"])
_SHOWN = 0.01
"""Contacts with less than this part of the largest force are not drawn."""
_SAND_FACE, _SAND_EDGE, _ROCK_FACE, _BEAM_FACE = "#f4ecdc", "#d9c9a8", "#6b6b6b", "#dfe6df"


@dataclass(frozen=True)
class Frame:
    """The sand at an instant.

    Attributes
    ----------
    time : float
        In s.
    state : Any
        Geometry that the reader of the cushion gives: discs, rock, beam, box and contacts.
    """

    time: float
    state: Any


def frames(run: StoredRun, cushion: str, wanted: Sequence[float]) -> list[Frame]:
    """Return the recorded states nearest to the times that are wanted, each once.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    wanted : sequence of float
        Times (s).
    """
    recorded = list(run.states(cushion))
    times = np.array([at for at, _ in recorded])
    chosen = sorted({int(abs(times - at).argmin()) for at in wanted}) if recorded else []
    return [Frame(float(times[i]), decoded(run, cushion, recorded[i][1])) for i in chosen]


def _evenly(run: StoredRun, cushion: str) -> list[float]:
    """Return times (s) evenly over that part of the run in which something happens."""
    force = run.series[str(column(run, cushion, Role.TRANSMITTED))]
    time = run.series["time"]
    end = time[np.flatnonzero(force >= _INTERESTING * force.max())[-1]]
    return list(np.linspace(time[0], end, FRAMES))


def _moments(run: StoredRun, cushion: str) -> list[float]:
    """Return the times (s) of half the peak force, of the peak, and of the greatest depth."""
    transmitted = str(column(run, cushion, Role.TRANSMITTED))
    force = run.series[transmitted]
    half = float(run.series["time"][np.flatnonzero(force >= 0.5 * force.max())[0]])
    deepest = extreme(run, str(column(run, cushion, Role.PENETRATION)))
    return [half, extreme(run, transmitted)[1], deepest[1]]


def snapshots(run: StoredRun, cushion: str, file: Path) -> None:
    """Draw six instants side by side, with one scale of colours.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    file : Path
        File of the picture.
    """
    shown = frames(run, cushion, _evenly(run, cushion))
    columns = min(3, len(shown))
    lines = -(-len(shown) // columns)
    width = 3.5 * columns + 0.6
    height = (3.5 * _shape(shown) + 0.3) * lines + 0.6
    with captioned([_READ_AS, *caption(run)], file, width, height) as made:
        panels = list(made.subplots(lines, columns, squeeze=False).ravel())
        for axes in panels[len(shown) :]:
            axes.set_axis_off()
        draw(run, cushion, shown, made, panels[: len(shown)])


def overview(run: StoredRun, cushion: str, known: KnownMetrics, file: Path) -> None:
    """Draw three instants and the forces over time in one wide picture.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    known : mapping of str to Known
        References by the name of the metric.
    file : Path
        File of the picture.
    """
    shown = frames(run, cushion, _moments(run, cushion))
    above = 9.3 / len(shown) * _shape(shown) + 0.3
    with captioned([_READ_AS, *caption(run)], file, 10.0, above + 3.8) as made:
        grid = made.add_gridspec(2, len(shown), height_ratios=(above, 3.2))
        upper = [made.add_subplot(grid[0, i]) for i in range(len(shown))]
        draw(run, cushion, shown, made, upper)
        axes = made.add_subplot(grid[1, :])
        force_axes(run, cushion, known, axes)
        for frame in shown:
            axes.axvline(frame.time / ms, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))


def _shape(shown: Sequence[Frame]) -> float:
    """Height of a panel / its width."""
    left, right, bottom, top = _window(shown)
    return (top - bottom) / (right - left)


def draw(
    run: StoredRun, cushion: str, shown: Sequence[Frame], made: Figure, panels: Sequence[Axes]
) -> None:
    """Draw one frame in each panel, with one scale of the forces and its colour bar.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    shown : sequence of Frame
        What to draw.
    made : Figure
        The figure.
    panels : sequence of Axes
        As many as there are frames.
    """
    strongest = [float(frame.state.contacts.normal_force.max(initial=0.0)) for frame in shown]
    largest = max(strongest, default=0.0) or 1.0
    structure = next(iter(structures(run)), None)
    view = _View(run, cushion, structure, _window(shown), _deflection_scale(run, structure, shown))
    for frame, axes in zip(shown, panels):
        _panel(view, frame, axes, largest / kN)
    if structure is not None:
        _name_axis(panels[0], view.deflection_scale)
    _scale_bar(panels[0], shown[0].state.box.width / cm)
    bar = made.colorbar(
        ScalarMappable(Normalize(0.0, largest / kN), _CHAINS),
        ax=list(panels),
        shrink=0.8,
        aspect=25,
        pad=0.01,
    )
    bar.set_label("contact force (kN)", fontsize=8)
    bar.outline.set_linewidth(0.5)


@dataclass(frozen=True)
class _View:
    """Geometry and scales that all panels have in common.

    StoredRun, cushion, structure under it, window (m), enlargement of deflections.
    """

    run: StoredRun
    cushion: str
    structure: str | None
    window: tuple[float, float, float, float]
    deflection_scale: float


def _deflection_scale(run: StoredRun, structure: str | None, shown: Sequence[Frame]) -> float:
    """Return how many times too large the deflections of the structure are drawn."""
    deflection = column(run, structure, Role.DEFLECTION) if structure else None
    if deflection is None:
        return DEFLECTION_SCALES[-1]
    diameter = 2.0 * max(float(frame.state.beam.radius.max(initial=0.0)) for frame in shown)
    most = float(abs(run.series[deflection]).max())
    fitting = (scale for scale in DEFLECTION_SCALES if scale * most <= diameter)
    return next(fitting, DEFLECTION_SCALES[-1])


def _name_axis(axes: Axes, scale: float) -> None:
    axes.annotate(
        f"beam axis, deflections × {scale:g}",
        (0.0, 0.0),
        xycoords="axes fraction",
        xytext=(2, 1),
        textcoords="offset points",
        fontsize=6.5,
        color=BEAM,
        zorder=5,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.75},
    )


def _scale_bar(axes: Axes, box: float) -> None:
    """Draw a length (cm) to measure by, in the upper right corner, where the rock leaves room."""
    length = max((bar for bar in _BARS if bar <= 0.25 * box), default=0.25 * box)
    (_, right), (_, top) = axes.get_xlim(), axes.get_ylim()
    end = right - 0.12 * (right - axes.get_xlim()[0])
    axes.annotate(
        "",
        (end - length, 0.94 * top),
        (end, 0.94 * top),
        arrowprops={
            "arrowstyle": "|-|,widthA=0.25,widthB=0.25",
            "color": INK,
            "linewidth": 0.9,
            "shrinkA": 0,
            "shrinkB": 0,
        },
        zorder=5,
    )
    axes.annotate(
        f"{length:g} cm",
        (end - 0.5 * length, 0.94 * top),
        xytext=(0, -3),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=7.5,
        zorder=5,
    )


def _window(shown: Sequence[Frame]) -> tuple[float, float, float, float]:
    """Left, right, bottom, top (m) of what all panels show.

    That is the sand with what carries it, however far that gives way, and the rock; of things that
    are farther off than the box is wide, nothing.
    """
    box = shown[0].state.box
    margin = max(0.06 * box.width, 0.0 if math.isinf(box.wall_top) else 1.2 * box.wall_thickness)
    beam = max(float(frame.state.beam.radius.max(initial=0.0)) for frame in shown)
    top = max(
        float(disc.y.max() + disc.radius.max())
        for frame in shown
        for disc in (frame.state.rock, frame.state.discs)
    )
    lowest = min(
        float((discs.y - discs.radius).min(initial=box.base))
        for frame in shown
        for discs in (frame.state.beam, frame.state.rock, frame.state.discs)
    )
    bottom = min(box.base - max(2.2 * beam, margin), lowest - 0.1 * margin)
    return (
        box.left - margin,
        box.left + box.width + margin,
        max(bottom, box.base - 1.2 * box.width),
        min(top, box.base + 1.2 * box.width) + 0.3 * margin,
    )


def _panel(view: _View, frame: Frame, axes: Axes, largest: float) -> None:
    left, right, bottom, top = (value / cm for value in view.window)
    state = frame.state
    axes.set(aspect="equal", xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    _discs(axes, state.discs, _SAND_FACE, _SAND_EDGE, 1)
    _chains(axes, state, largest)
    _discs(axes, state.beam, _BEAM_FACE, BEAM, 3)
    _discs(axes, state.rock, _ROCK_FACE, INK, 3)
    _walls(axes, state.box, top)
    axes.axhline(state.box.base / cm, color=GREY, linewidth=0.5, zorder=2)
    _axis_of_structure(view, frame, axes)
    axes.set_title(f"{frame.time / ms:g} ms")
    axes.set_title(_words(view, frame), loc="right", fontsize=6.5, color=GREY)


def _walls(axes: Axes, box: Any, top: float) -> None:
    """Draw the inner faces of the side walls; those of a finite height as thick as they are."""
    for face, outwards in ((box.left, -1.0), (box.left + box.width, 1.0)):
        if math.isinf(box.wall_top):
            axes.plot(
                [face / cm, face / cm], [box.base / cm, top], color=GREY, linewidth=1.0, zorder=2
            )
        else:
            axes.add_patch(
                Rectangle(
                    (face / cm, box.base / cm),
                    outwards * box.wall_thickness / cm,
                    (box.wall_top - box.base) / cm,
                    facecolor=_BEAM_FACE,
                    edgecolor=GREY,
                    linewidth=0.7,
                    zorder=2,
                )
            )


def _discs(axes: Axes, discs: Any, face: str, edge: str, order: int) -> None:
    size = 2.0 * discs.radius / cm
    axes.add_collection(
        EllipseCollection(
            size,
            size,
            np.zeros_like(size),
            units="xy",
            offset_transform=axes.transData,
            offsets=np.column_stack((discs.x, discs.y)) / cm,
            facecolors=face,
            edgecolors=edge,
            linewidths=0.5,
            zorder=order,
        )
    )


def _chains(axes: Axes, state: Any, largest: float) -> None:
    """Draw a line from centre to centre for each contact, the strongest on top.

    Width and colour follow from the force / ``largest`` (kN).
    """
    contacts = state.contacts
    share = contacts.normal_force / kN / largest
    order = [i for i in np.argsort(share) if share[i] > _SHOWN]
    ends = (
        np.stack(
            (
                np.column_stack((contacts.x1, contacts.y1)),
                np.column_stack((contacts.x2, contacts.y2)),
            ),
            axis=1,
        )
        / cm
    )
    axes.add_collection(
        LineCollection(
            list(ends[order]),
            colors=_CHAINS(share[order]),
            linewidths=0.4 + 3.6 * share[order],
            capstyle="round",
            zorder=2,
        )
    )


def _axis_of_structure(view: _View, frame: Frame, axes: Axes) -> None:
    """Draw the axis of the structure, its deflections since the start enlarged."""
    heights = [
        values
        for member in members(view.run, Role.STRUCTURE)
        if member.component == view.structure
        for values in elements(view.run, member.column)
    ]
    if not heights or len(heights) != frame.state.beam.x.size:
        return
    row = int(abs(view.run.series["time"] - frame.time).argmin())
    start = np.array([values[0] for values in heights])
    moved = np.array([values[row] for values in heights]) - start
    axes.plot(
        frame.state.beam.x / cm,
        (start + view.deflection_scale * moved) / cm,
        color=BEAM,
        linewidth=1.4,
        zorder=4,
    )


def _words(view: _View, frame: Frame) -> str:
    """Return the place of the rock and the transmitted force at the time of the frame."""
    run = view.run
    row = int(abs(run.series["time"] - frame.time).argmin())
    above = run.series[str(column(run, view.cushion, Role.ABOVE_SURFACE))][row]
    force = run.series[str(column(run, view.cushion, Role.TRANSMITTED))][row]
    place = f"{abs(above) / cm:.1f} cm {'above' if above >= 0.0 else 'deep'}"
    return f"rock {place}, {force / kN:.{2 if abs(force) < 10.0 * kN else 0}f} kN transmitted"

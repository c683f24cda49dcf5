"""The sand at several instants: discs, rock, beam, and the forces in the contacts as lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from rockshed.components.common.units import cm, kN, ms
from rockshed.components.sand_cushion.reader import Box, Discs, SandState, read, sizes_of
from rockshed.fmus.python.slave import component_state

from ..core.results.reading import Run
from ..metrics import headlines as h
from ..metrics.comparison import caption
from .curves import Known, force_axes
from .style import BEAM, GREY, INK, captioned

FRAMES = 6
_READ_AS = (
    "lines: forces in the contacts, by width and colour; deep: the rock's lowest point below the surface that the sand had "
    "at the start; transmitted: vertical force of the sand on its base"
)
_BARS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Lengths of the scale bar (cm): the largest of these that is at most a quarter of the box."""
DEFLECTION_SCALES = (30.0, 20.0, 10.0, 5.0, 3.0, 2.0, 1.0)
"""Deflections of the beam's axis are drawn so many times too large: the largest of these that keeps them within a disc."""
_INTERESTING = 0.25
"""The frames end when the transmitted force has fallen below this part of its peak for good."""
_CHAINS = LinearSegmentedColormap.from_list("chains", ["#e8c98f", "#e08a2e", "#c23b22", "#5a0f3c"])
_SHOWN = 0.01
"""Contacts with less than this part of the largest force are not drawn."""
_SAND_FACE, _SAND_EDGE, _ROCK_FACE, _BEAM_FACE = "#f4ecdc", "#d9c9a8", "#6b6b6b", "#dfe6df"


@dataclass(frozen=True)
class Frame:
    """The sand at a time (s)."""

    time: float
    state: SandState


def frames(run: Run, wanted: Sequence[float]) -> list[Frame]:
    """The recorded states nearest to the times (s) that are wanted, each once."""
    name = h.roles(run).sand
    recorded = list(run.states(name)) if name else []
    times = np.array([at for at, _ in recorded])
    chosen = sorted({int(abs(times - at).argmin()) for at in wanted}) if recorded else []
    return [Frame(float(times[i]), _decoded(recorded[i][1])) for i in chosen]


def _decoded(content: bytes) -> SandState:
    state = component_state(content)
    return read(state, sizes_of(state))


def _evenly(run: Run) -> list[float]:
    """Times (s) evenly over that part of the run in which something happens."""
    force, time = run.series[f"{h.roles(run).sand}.transmitted_force"], run.series["time"]
    return list(
        np.linspace(time[0], time[np.flatnonzero(force >= _INTERESTING * force.max())[-1]], FRAMES)
    )


def _moments(run: Run) -> list[float]:
    """Times (s) of half the peak of the transmitted force, of the peak, and of the greatest depth."""
    sand, time = h.roles(run).sand, run.series["time"]
    force = run.series[f"{sand}.transmitted_force"]
    half = float(time[np.flatnonzero(force >= 0.5 * force.max())[0]])
    return [
        half,
        h.extreme(run, f"{sand}.transmitted_force")[1],
        h.extreme(run, f"{sand}.penetration")[1],
    ]


def snapshots(run: Run, file: Path) -> None:
    """Six instants side by side, with one scale of colours."""
    shown = frames(run, _evenly(run))
    columns = min(3, len(shown))
    lines = -(-len(shown) // columns)
    width = 3.5 * columns + 0.6
    with captioned(
        [_READ_AS, *caption(run)], file, width, (3.5 * _shape(shown) + 0.3) * lines + 0.6
    ) as made:
        panels = list(made.subplots(lines, columns, squeeze=False).ravel())
        for axes in panels[len(shown) :]:
            axes.set_axis_off()
        draw(run, shown, made, panels[: len(shown)])


def overview(run: Run, known: Known, file: Path) -> None:
    """Three instants and the forces over time in one wide picture."""
    shown = frames(run, _moments(run))
    above = 9.3 / len(shown) * _shape(shown) + 0.3
    with captioned([_READ_AS, *caption(run)], file, 10.0, above + 3.8) as made:
        grid = made.add_gridspec(2, len(shown), height_ratios=(above, 3.2))
        draw(run, shown, made, [made.add_subplot(grid[0, i]) for i in range(len(shown))])
        axes = made.add_subplot(grid[1, :])
        force_axes(run, known, axes)
        for frame in shown:
            axes.axvline(frame.time / ms, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))


def _shape(shown: Sequence[Frame]) -> float:
    """Height of a panel / its width."""
    left, right, bottom, top = _window(shown)
    return (top - bottom) / (right - left)


def draw(run: Run, shown: Sequence[Frame], made: Figure, panels: Sequence[Axes]) -> None:
    """One frame in each panel; the scale of the forces, and their colour bar, are common to all."""
    largest = (
        max(
            (float(frame.state.contacts.normal_force.max(initial=0.0)) for frame in shown),
            default=0.0,
        )
        or 1.0
    )
    window = _window(shown)
    for frame, axes in zip(shown, panels):
        _panel(run, frame, axes, largest / kN, window)
    if h.roles(run).beam:
        _name_axis(panels[0], deflection_scale(run))
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


def deflection_scale(run: Run) -> float:
    """How many times too large the deflections of the beam are drawn."""
    column = f"{h.roles(run).beam}.midspan.deflection"
    if column not in run.series:
        return DEFLECTION_SCALES[-1]
    diameter = 2.0 * float(
        run.provenance["components"][h.roles(run).sand]["parameters"]["beam.radius"]["value"]
    )
    most = float(abs(run.series[column]).max())
    return next(
        (scale for scale in DEFLECTION_SCALES if scale * most <= diameter), DEFLECTION_SCALES[-1]
    )


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
    """A length (cm) to measure by, in the upper right corner, where the rock leaves room."""
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
    """Left, right, bottom, top (m) of what all panels show."""
    box = shown[0].state.box
    margin = max(0.06 * box.width, 0.0 if math.isinf(box.wall_top) else 1.2 * box.wall_thickness)
    beam = max(float(frame.state.beam.radius.max(initial=0.0)) for frame in shown)
    top = max(
        float(disc.y.max() + disc.radius.max())
        for frame in shown
        for disc in (frame.state.rock, frame.state.discs)
    )
    highest = min(top, box.base + 1.2 * box.width)
    return (
        box.left - margin,
        box.left + box.width + margin,
        box.base - max(2.2 * beam, margin),
        highest + 0.3 * margin,
    )


def _panel(
    run: Run, frame: Frame, axes: Axes, largest: float, window: tuple[float, float, float, float]
) -> None:
    left, right, bottom, top = (value / cm for value in window)
    state = frame.state
    axes.set(aspect="equal", xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    _discs(axes, state.discs, _SAND_FACE, _SAND_EDGE, 1)
    _chains(axes, state, largest)
    if not _on_floor(run):
        _discs(axes, state.beam, _BEAM_FACE, BEAM, 3)
    _discs(axes, state.rock, _ROCK_FACE, INK, 3)
    _walls(axes, state.box, top)
    axes.axhline(state.box.base / cm, color=GREY, linewidth=0.5, zorder=2)
    _axis_of_beam(run, frame, axes)
    axes.set_title(f"{frame.time / ms:g} ms")
    axes.set_title(_words(run, frame), loc="right", fontsize=6.5, color=GREY)


def _walls(axes: Axes, box: Box, top: float) -> None:
    """The inner faces of the side walls; those of a finite height as thick as they are."""
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


def _on_floor(run: Run) -> bool:
    """Whether the sand lies on a rigid floor; the places of beam discs then mean nothing."""
    return (
        str(run.provenance["components"][h.roles(run).sand]["parameters"]["base"]["value"])
        == "floor"
    )


def _discs(axes: Axes, discs: Discs, face: str, edge: str, order: int) -> None:
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


def _chains(axes: Axes, state: SandState, largest: float) -> None:
    """A line from centre to centre for each contact, width and colour by force / ``largest`` (kN); the strongest lie on top."""
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


def _axis_of_beam(run: Run, frame: Frame, axes: Axes) -> None:
    """The beam's axis, its deflections since the start enlarged."""
    name = h.roles(run).beam
    count = frame.state.beam.x.size
    columns = [f"{name}.position.y[{i + 1}]" for i in range(count)]
    if not count or any(column not in run.series for column in columns):
        return
    row = int(abs(run.series["time"] - frame.time).argmin())
    start = np.array([run.series[column][0] for column in columns])
    moved = np.array([run.series[column][row] for column in columns]) - start
    axes.plot(
        frame.state.beam.x / cm,
        (start + deflection_scale(run) * moved) / cm,
        color=BEAM,
        linewidth=1.4,
        zorder=4,
    )


def _words(run: Run, frame: Frame) -> str:
    """Depth of the rock and transmitted force at the time of the frame."""
    sand, row = h.roles(run).sand, int(abs(run.series["time"] - frame.time).argmin())
    depth, force = (
        run.series[f"{sand}.penetration"][row],
        run.series[f"{sand}.transmitted_force"][row],
    )
    place = f"{abs(depth) / cm:.1f} cm {'deep' if depth > 0.0 else 'above'}"
    return f"rock {place}, {force / kN:.{2 if abs(force) < 10.0 * kN else 0}f} kN transmitted"

"""The sand at several instants: discs, rock, beam, and the forces in the contacts as lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
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
from ..tables import digits
from .cushion import force_axes
from .references import KnownMetrics
from .style import BEAM, GREY, INK, captioned, legend, literal

FRAMES = 6
_READ_AS = (
    "to scale; lines: forces in the contacts, by width and colour; deep: the rock's lowest point "
    "below the surface that the sand had at the start; transmitted: vertical force of the sand on "
    "its base"
)
_BARS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Lengths of the scale bar (cm): the largest of these that is at most a quarter of the box."""
DEFLECTION_SCALES = (30.0, 20.0, 10.0, 5.0, 3.0, 2.0, 1.0)
"""Deflections of the beam's axis are drawn so many times too large: the largest of these that keeps
them within a disc."""
_MOMENTS = 3
"""Instants of the overview."""
_APART = 0.1
"""Distance of two of them at least, as a part of the time in which something happens."""
_INTERESTING = 0.25
"""The frames end when the transmitted force has fallen below this part of its peak for good."""
_CHAINS = LinearSegmentedColormap.from_list("chains", ["#e8c98f", "#e08a2e", "#c23b22", "#5a0f3c"])
_WIDE = 10.0
"""Width (inch) of the overview."""
_TITLE = 0.4
"""Height (inch) of the words above a panel."""
_STRIP = 0.06
"""Height of the strip with the scale / width of a panel."""
_HIGHEST = 3.0
"""Height of a panel / its width, at most."""
_DEEPEST = 6.0
"""Depth below the base of the sand to which the beam is shown / width of the box."""
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
    force = np.abs(run.series[str(column(run, cushion, Role.TRANSMITTED))])
    time = run.series["time"]
    end = time[np.flatnonzero(force >= _INTERESTING * force.max())[-1]]
    return list(np.linspace(time[0], end, FRAMES))


def _moments(run: StoredRun, cushion: str) -> list[float]:
    """Return the times (s) of three instants that differ.

    Of the peak forces on base and rock, the greatest depth, half of the peak before and after it,
    and the end of what happens, in this order.
    """
    time = run.series["time"]
    transmitted, on_body, depth = (
        str(column(run, cushion, role))
        for role in (Role.TRANSMITTED, Role.ON_BODY, Role.PENETRATION)
    )
    force = np.abs(run.series[transmitted])
    high = force >= 0.5 * force.max()
    end = _evenly(run, cushion)[-1]
    wanted = [extreme(run, name)[1] for name in (transmitted, on_body, depth)]
    before, after = time[high][:1], time[~high & (time > wanted[0])][:1]
    chosen: list[float] = []
    for at in map(float, (*wanted, *before, *after, end)):
        if all(abs(at - other) >= _APART * (end - time[0]) for other in chosen):
            chosen.append(at)
    return chosen[:_MOMENTS]


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
    height = (3.5 * shape_of(shown) + _TITLE) * lines
    words = [read_as(run, shown), *caption(run)]
    with captioned(words, file, width, height) as made:
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
    above = 9.3 / len(shown) * shape_of(shown) + _TITLE
    words = [read_as(run, shown), *caption(run)]
    with captioned(words, file, _WIDE, above + 3.2) as made:
        grid = made.add_gridspec(2, len(shown), height_ratios=(above, 3.2))
        upper = [made.add_subplot(grid[0, i]) for i in range(len(shown))]
        draw(run, cushion, shown, made, upper)
        axes = made.add_subplot(grid[1, :])
        force_axes(run, cushion, known, axes)
        for frame in shown:
            axes.axvline(frame.time / ms, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        legend(axes)


def shape_of(shown: Sequence[Frame]) -> float:
    """Return height / width of a panel; what is higher still is drawn smaller.

    Parameters
    ----------
    shown : sequence of Frame
        What is drawn.
    """
    left, right, bottom, top = _window(shown)
    return min((top - bottom) / (right - left), _HIGHEST)


def read_as(run: StoredRun, shown: Sequence[Frame]) -> str:
    """Say how the pictures of the sand are read.

    Parameters
    ----------
    run : StoredRun
        The run.
    shown : sequence of Frame
        What is drawn.
    """
    structure = next(iter(structures(run)), None)
    if structure is None:
        return _READ_AS
    scale = _deflection_scale(run, structure, shown)
    larger = f" with deflections × {scale:g}" if scale != 1.0 else ""
    return f"{_READ_AS}; green line: axis of {literal(structure)}{larger}"


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
    view = view_of(run, cushion, shown)
    for frame, axes in zip(shown, panels):
        draw_still(view, frame, axes)
        draw_moving(view, frame, axes)
        axes.set_title(in_words(view, frame), fontsize=8)
    _scale_bar(panels[0], shown[0].state.box.width / cm)
    bar = made.colorbar(
        ScalarMappable(Normalize(0.0, view.largest), _CHAINS),
        ax=list(panels),
        shrink=0.8,
        aspect=25,
        pad=0.01,
    )
    bar.set_label("contact force (kN)", fontsize=8)
    bar.outline.set_linewidth(0.5)


@dataclass(frozen=True)
class View:
    """Geometry and scales that all panels have in common.

    Attributes
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    structure : str or None
        What carries the sand.
    window : tuple of float
        Left, right, bottom and top (m).
    deflection_scale : float
        Enlargement of the deflections.
    largest : float
        Largest force in a contact (kN).
    """

    run: StoredRun
    cushion: str
    structure: str | None
    window: tuple[float, float, float, float]
    deflection_scale: float
    largest: float


def view_of(run: StoredRun, cushion: str, shown: Sequence[Frame]) -> View:
    """Return the view of all frames that are drawn.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    shown : sequence of Frame
        What is drawn.
    """
    strongest = [float(frame.state.contacts.normal_force.max(initial=0.0)) for frame in shown]
    structure = next(iter(structures(run)), None)
    scale = _deflection_scale(run, structure, shown)
    largest = (max(strongest, default=0.0) or 1.0) / kN
    return View(run, cushion, structure, _window(shown), scale, largest)


def _deflection_scale(run: StoredRun, structure: str | None, shown: Sequence[Frame]) -> float:
    """Return how many times too large the deflections of the structure are drawn."""
    deflection = column(run, structure, Role.DEFLECTION) if structure else None
    if deflection is None:
        return DEFLECTION_SCALES[-1]
    diameter = 2.0 * max(float(frame.state.beam.radius.max(initial=0.0)) for frame in shown)
    most = float(abs(run.series[deflection]).max())
    fitting = (scale for scale in DEFLECTION_SCALES if scale * most <= diameter)
    return next(fitting, DEFLECTION_SCALES[-1])


def _scale_bar(axes: Axes, box: float) -> None:
    """Draw a length (cm) to measure by, in the strip below the beam."""
    length = max((bar for bar in _BARS if bar <= 0.25 * box), default=0.25 * box)
    (left, right), (bottom, _) = axes.get_xlim(), axes.get_ylim()
    end = right - 0.01 * (right - left)
    height = bottom + 0.5 * _STRIP * (right - left)
    axes.annotate(
        "",
        (end - length, height),
        (end, height),
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
        (end - length, height),
        xytext=(-4, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize=7.5,
        zorder=5,
    )


def _window(shown: Sequence[Frame]) -> tuple[float, float, float, float]:
    """Left, right, bottom, top (m) of what all panels show.

    That is the sand with what carries it, however far that gives way, the rock, and a strip for
    the scale; of rock and sand that are farther off than the box is wide, and of a beam that is
    farther off than six times that, nothing.
    """
    box = shown[0].state.box
    margin = max(0.06 * box.width, 0.0 if math.isinf(box.wall_top) else 1.2 * box.wall_thickness)
    beam = max(float(frame.state.beam.radius.max(initial=0.0)) for frame in shown)
    top = max(
        float(disc.y.max() + disc.radius.max())
        for frame in shown
        for disc in (frame.state.rock, frame.state.discs)
    )
    lowest, beam_lowest = (
        min(
            float((discs.y - discs.radius).min(initial=box.base))
            for frame in shown
            for discs in parts(frame.state)
        )
        for parts in (lambda state: (state.rock, state.discs), lambda state: (state.beam,))
    )
    bottom = min(
        box.base - max(2.2 * beam, margin),
        max(lowest - 0.1 * margin, box.base - 1.2 * box.width),
        max(beam_lowest - 0.1 * margin, box.base - _DEEPEST * box.width),
    )
    width = box.width + 2.0 * margin
    return (
        box.left - margin,
        box.left + box.width + margin,
        bottom - _STRIP * width,
        min(top, box.base + 1.2 * box.width) + 0.3 * margin,
    )


def draw_still(view: View, frame: Frame, axes: Axes) -> None:
    """Draw the walls of the box and the base of the sand.

    Parameters
    ----------
    view : View
        Of all frames.
    frame : Frame
        What is drawn.
    axes : Axes
        Where to draw.
    """
    left, right, bottom, top = (value / cm for value in view.window)
    axes.set(aspect="equal", xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    _walls(axes, frame.state.box, top)
    axes.axhline(frame.state.box.base / cm, color=GREY, linewidth=0.5, zorder=2)


def draw_moving(view: View, frame: Frame, axes: Axes) -> list[Artist]:
    """Draw sand, force chains, beam and rock.

    Parameters
    ----------
    view : View
        Of all frames.
    frame : Frame
        What is drawn.
    axes : Axes
        Where to draw.

    Returns
    -------
    list of Artist
        What has been drawn, from below upwards.
    """
    state = frame.state
    return [
        _discs(axes, state.discs, _SAND_FACE, _SAND_EDGE, 1),
        _chains(axes, state, view.largest),
        _discs(axes, state.beam, _BEAM_FACE, BEAM, 3),
        _discs(axes, state.rock, _ROCK_FACE, INK, 3),
        *_axis_of_structure(view, frame, axes),
    ]


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


def _discs(axes: Axes, discs: Any, face: str, edge: str, order: int) -> Artist:
    size = 2.0 * discs.radius / cm
    return axes.add_collection(
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


def _chains(axes: Axes, state: Any, largest: float) -> Artist:
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
    return axes.add_collection(
        LineCollection(
            list(ends[order]),
            colors=_CHAINS(share[order]),
            linewidths=0.4 + 3.6 * share[order],
            capstyle="round",
            zorder=2,
        )
    )


def _axis_of_structure(view: View, frame: Frame, axes: Axes) -> Sequence[Artist]:
    """Draw the axis of the structure, its deflections since the start enlarged."""
    heights = [
        values
        for member in members(view.run, Role.STRUCTURE)
        if member.component == view.structure
        for values in elements(view.run, member.column)
    ]
    if not heights or len(heights) != frame.state.beam.x.size:
        return []
    row = int(abs(view.run.series["time"] - frame.time).argmin())
    start = np.array([values[0] for values in heights])
    moved = np.array([values[row] for values in heights]) - start
    return axes.plot(
        frame.state.beam.x / cm,
        (start + view.deflection_scale * moved) / cm,
        color=BEAM,
        linewidth=1.4,
        zorder=4,
    )


def in_words(view: View, frame: Frame) -> str:
    """Return time, place of the rock and transmitted force of a frame.

    Parameters
    ----------
    view : View
        Of all frames.
    frame : Frame
        What is drawn.
    """
    run = view.run
    row = int(abs(run.series["time"] - frame.time).argmin())
    above = run.series[str(column(run, view.cushion, Role.ABOVE_SURFACE))][row]
    force = run.series[str(column(run, view.cushion, Role.TRANSMITTED))][row]
    place = f"{abs(above) / cm:.1f} cm {'above' if above >= 0.0 else 'deep'}"
    load = f"{force / kN:.{2 if abs(force) < 10.0 * kN else 0}f} kN"
    words = f"rock {place}, {load} transmitted"
    return f"{digits(frame.time / ms, 4)} ms: {words}"

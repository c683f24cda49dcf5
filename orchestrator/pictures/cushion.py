"""Curves of a cushion: forces, penetration; of a static test the load over the penetration."""

from pathlib import Path

from matplotlib.axes import Axes

from rockshed.components.common.roles import Role
from rockshed.components.common.units import cm, kgf, kN, ms

from ..core.results.reading import StoredRun
from ..metrics import names
from ..metrics.cushion import both_forces, curve_of, cut_off, settled, thickness_at_start
from ..metrics.load_curve import DEPTH
from ..metrics.practice import with_handbook
from ..metrics.roles import column
from ..metrics.screen_units import is_shown_in
from ..metrics.values import extreme
from ..references import Known
from ..tables import digits
from .references import KnownMetrics, draw_references
from .style import (
    GREY,
    INK,
    ROCK,
    TRANSMITTED,
    WIDTH,
    figure,
    legend,
    over_time,
    reference_line,
    second_scale,
)


def forces(run: StoredRun, cushion: str, known: KnownMetrics, file: Path) -> None:
    """Draw transmitted force and force on the rock, with the measured peak.

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
    with figure(run, file, WIDTH, 3.6) as made:
        axes = made.subplots()
        force_axes(run, cushion, known, axes)
        _settled_forces(run, cushion, axes)
        on_rock = with_handbook(run, known.get(names.SETTLED_ROCK))
        draw_references(axes, on_rock, "kN", "force on the rock")
        highest = [1.1 * reference.value / kN for reference in on_rock.by().values()]
        axes.set_ylim(top=max([axes.get_ylim()[1], *highest]))
        legend(axes)


def force_axes(run: StoredRun, cushion: str, known: KnownMetrics, axes: Axes) -> None:
    """Draw both forces in kN, in cases of papers with kgf at the right, and lines for a legend.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    known : mapping of str to Known
        References by the name of the metric.
    axes : Axes
        Where to draw.
    """
    time = run.series["time"] / ms
    words = (("transmitted to the base", TRANSMITTED), ("on the rock", ROCK))
    for (name, colour), force in zip(words, both_forces(run, cushion) or ()):
        peak, at = extreme(run, force)
        text = f"{name}, peak {digits(peak / kN)} kN at {digits(at / ms)} ms"
        axes.plot(time, run.series[force] / kN, color=colour, label=text)
        axes.plot(at / ms, peak / kN, "o", color=colour, markersize=3.5)
    draw_references(axes, known.get(names.PEAK_TRANSMITTED), "kN", "peak transmitted force")
    axes.set(xlabel="time (ms)", ylabel="force (kN)")
    over_time(axes, time)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    _kgf_beside(run, axes)


def _kgf_beside(run: StoredRun, axes: Axes) -> None:
    """Add a scale in kgf to forces in kN, for cases of papers."""
    if is_shown_in("kgf", run):
        second_scale(axes, kN / kgf, "(kgf)")


def _settled_forces(run: StoredRun, cushion: str, axes: Axes) -> None:
    """Draw both forces without their spikes."""
    fastest = cut_off(run, cushion)
    label = f"dashed: settled, below {fastest:.0f} Hz" if fastest else ""
    for colour, force in zip((TRANSMITTED, ROCK), both_forces(run, cushion) or ()):
        curve = settled(run, cushion, force)
        if curve is None:
            return
        time = run.series["time"] / ms
        dashes = (0, (3, 2))
        axes.plot(time, curve / kN, color=colour, linewidth=0.9, linestyle=dashes, label=label)
        label = ""


def penetration(run: StoredRun, cushion: str, known: KnownMetrics, file: Path) -> None:
    """Draw the depth of the rock's lowest point under the surface, downwards, and the base.

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
    depth = str(column(run, cushion, Role.PENETRATION))
    time = run.series["time"] / ms
    with figure(run, file, WIDTH, 3.2) as made:
        axes = made.subplots()
        most, at = extreme(run, depth)
        text = f"penetration, largest {digits(most / cm)} cm at {digits(at / ms)} ms"
        axes.plot(time, run.series[depth] / cm, color=ROCK, label=text)
        axes.plot(at / ms, most / cm, "o", color=ROCK, markersize=3.5)
        thickness = thickness_at_start(run, cushion)
        if thickness is not None:
            reference_line(axes, thickness / cm, "base", "-")
        draw_references(axes, known.get(names.PENETRATION), "cm", "largest penetration")
        axes.axhline(0.0, color=GREY, linewidth=0.7)
        axes.set(xlabel="time (ms)", ylabel="penetration (cm)")
        over_time(axes, time)
        axes.invert_yaxis()
        legend(axes)


def load(run: StoredRun, cushion: str, known: KnownMetrics, file: Path) -> None:
    """Draw the load on a driven rock over its penetration, with the secant at 4 cm and the paper's.

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
    curve = curve_of(run, cushion)
    assert curve is not None
    with figure(run, file, WIDTH, 3.6) as made:
        axes = made.subplots()
        axes.plot(curve.depth / cm, curve.load / kN, color=ROCK, linewidth=0.5, alpha=0.45)
        mean = curve.at(curve.depth) / kN
        axes.plot(curve.depth / cm, mean, color=ROCK, label="load, mean over 0.5 mm")
        if curve.reaches(DEPTH):
            _secant(axes, float(curve.at(DEPTH)) / DEPTH, INK, "-", "secant, k =")
        paper = known.get(names.STATIC_STIFFNESS, Known()).paper
        if paper:
            _secant(axes, paper.value, GREY, "--", "paper,")
        axes.axhline(0.0, color=GREY, linewidth=0.7)
        axes.set(xlabel="penetration (cm)", ylabel="load (kN)")
        axes.set_xlim(left=0.0)
        _kgf_beside(run, axes)
        legend(axes)


def _secant(axes: Axes, stiffness: float, colour: str, dashes: str, words: str) -> None:
    """Draw a line from the origin to 4 cm with a spring constant (N/m)."""
    axes.plot(
        [0.0, DEPTH / cm],
        [0.0, stiffness * DEPTH / kN],
        dashes,
        color=colour,
        linewidth=1.0,
        marker="o",
        markevery=[1],
        markersize=3.5,
        label=f"{words} {digits(stiffness / kN)} kN/m = {digits(stiffness * cm / kgf)} kgf/cm",
    )

"""Pictures of a rockfall campaign: profile with envelopes, histograms at lines, ends, replays."""

from collections.abc import Callable
from functools import partial
from itertools import cycle, groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from numpy.typing import NDArray

from rockshed.components.common.units import kJ
from rockshed.components.slope_rockfall.records import (
    OUTCOME,
    PASSED_RIGHT,
    RESTED,
    STOPPED,
    UNFINISHED,
)
from rockshed.components.slope_rockfall.records import ROCK as COLUMNS

from ...animations.writing import FRAMES_PER_SECOND, write_animation
from ...campaigns.passages import QUANTITIES, LinePassages, PassageQuantity
from ...campaigns.replay import MODES, Replay, replay
from ...campaigns.statistics import fitting
from ...pictures.marks import Mark, name_marks
from ...pictures.style import (
    BEAM,
    GREY,
    INK,
    ROCK,
    SAND,
    TRANSMITTED,
    WIDTH,
    legend,
    literal,
    styled,
)
from ...sites.rockfall.profile import surface
from ...sites.rockfall.site import Barrier
from ...tables import digits
from ..drawing import drawn
from ..frame import Count, Drawing, StageProgress, counter

if TYPE_CHECKING:
    from .result import RockfallResult

PATHS = 60
"""Number of trials, from the first on, whose paths are drawn."""
_INTERVAL = 0.02
"""Time (s) between the points of a drawn path."""
_GROUNDS = ("#8c8c8c", SAND, "#a5b48a", "#c9a3a3", "#9fb3c8", "#d8cf9a")
"""Colours of the materials, in turn."""
_CURVES = {
    "max": (ROCK, "-"),
    "p99": (TRANSMITTED, "-"),
    "p95": (TRANSMITTED, "--"),
    "p90": (TRANSMITTED, ":"),
    "p50": (INK, "-"),
}
"""Colour and dashes of the envelopes."""
_SHOWN = {
    "height": ("bounce height (m)", 1.0),
    "speed": ("speed (m/s)", 1.0),
    "energy": ("kinetic energy (kJ)", kJ),
}
"""Label of each quantity along the profile, and the size of its unit."""
_ENDS = (
    (RESTED, "at rest", SAND),
    (STOPPED, "stopped by a barrier", BEAM),
    (PASSED_RIGHT, "beyond the right end", ROCK),
    (UNFINISHED, "not finished: where they were", TRANSMITTED),
)
"""Ends of trials that are drawn, with name and colour."""
_MARK: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7.5}
_MOST_FRAMES = 400
"""Number of frames above which an animation runs faster than the rock."""
_STILL = FRAMES_PER_SECOND
"""Number of frames for which the end of a replay stands still."""
_LEVEL = 0.05
"""Height of a picture of a level profile / its length."""
_FEWEST_RADII = 20.0
"""Height of a picture of a level profile / radius of the rock, at least."""
_PANEL_WIDTH = 6.2
"""Width (inch) of a panel, about."""
_PROFILE_HEIGHTS = (1.8, 7.0)
"""Heights (inch) of the panel with the profile."""
_ENVELOPE_HEIGHT = 1.5
"""Height (inch) of a panel below it."""
_SKY = 0.08
"""Part of the panel above the profile that may be cut off to draw it to scale."""
_TO_SCALE = 0.02
"""Part by which heights may be drawn larger than lengths and still be to scale."""
_ALIKE = 1e-9
"""Part of the largest value by which values may differ and still be one."""


def caption(result: "RockfallResult") -> list[str]:
    """Return in short lines what a campaign has computed."""
    site = result.slope.site
    campaign = result.campaign
    rock = _rock_in_words(result)
    chance = f"Latin hypercube of {site.hypercube}" if site.hypercube else "independent trials"
    return [
        ": ".join(filter(None, (literal(result.name), literal(site.description)))),
        f"{campaign.trials} trials, seed {campaign.seed}, {chance}; {rock}; "
        f"V_lim {digits(site.limit_speed.mean)} ± {digits(site.limit_speed.deviation)} m/s",
    ]


def _rock_in_words(result: "RockfallResult") -> str:
    """Return mass, size and shape of the rock, or their range over the trials."""
    shape = result.slope.site.rock.shape
    if result.rocks is None:
        mass, radius = result.slope.instance["mass"], result.slope.instance["radius"]
        return f"rock: r = {digits(radius)} m, m = {digits(mass, 4)} kg, {shape}"
    mass, radius = (_range(result.rocks[:, c]) for c in (COLUMNS.mass, COLUMNS.radius))
    words = f"rocks: r = {radius} m, m = {mass} kg, {shape}"
    if shape == "ellipse":
        words += f" of elongation {_range(result.rocks[:, COLUMNS.elongation])}"
    return words


def _range(values: NDArray[np.float64]) -> str:
    low, high = digits(float(values.min())), digits(float(values.max()))
    return low if low == high else f"{low} to {high}"


def drawings(result: "RockfallResult") -> dict[str, Drawing]:
    """Return a function for each figure of a campaign.

    Parameters
    ----------
    result : RockfallResult
        Of the campaign.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    figures: dict[str, Drawing] = {
        "envelopes": partial(envelopes, result),
        "ends": partial(ends, result),
    }
    if any(line.count > 1 for line in result.lines):
        figures["lines"] = partial(histograms, result)
    return figures


# --- the profile ---


def _slope(result: "RockfallResult", axes: Axes) -> None:
    """Draw the ground in the colours of its materials, search lines and barriers."""
    nodes = result.slope.nodes
    x = np.array([node.x for node in nodes])
    y = np.array([node.y for node in nodes])
    radius = result.slope.instance["radius"]
    rise = max(y.max() - y.min(), _LEVEL * (x[-1] - x[0]), _FEWEST_RADII * radius)
    bottom = y.min() - 0.04 * rise
    names = [str(node.material) for node in nodes[:-1]]
    colours = dict(zip(result.slope.materials, cycle(_GROUNDS)))
    for name, cells in groupby(range(len(names)), names.__getitem__):
        numbers = list(cells)
        part = slice(numbers[0], numbers[-1] + 2)
        axes.fill_between(
            x[part],
            y[part],
            bottom,
            color=colours[name],
            linewidth=0.0,
            zorder=1,
            label=literal(name) if names.index(name) == numbers[0] else None,
        )
    axes.plot(x, y, color=INK, linewidth=1.0, zorder=3)
    top = y.max() + 0.12 * rise
    axes.set(xlim=(x[0], x[-1]), ylim=(bottom, top), ylabel="y (m)")
    campaign = result.campaign
    for line in campaign.lines[: len(result.slope.site.line)]:
        upper = np.minimum(line[[1, 3]], top)
        axes.plot(line[[0, 2]], upper, color=GREY, linewidth=0.9, linestyle="--", zorder=2)
    for barrier in result.slope.site.barrier:
        foot = surface(nodes, barrier.x)
        ends = [foot, foot + barrier.height]
        axes.plot([barrier.x, barrier.x], ends, color=BEAM, linewidth=2.2, zorder=5)


def _marks(result: "RockfallResult") -> list[Mark]:
    """Return the names of search lines and barriers."""
    campaign = result.campaign
    lines = campaign.lines[: len(result.slope.site.line)]
    return [
        *(Mark(float(line[2]), name) for line, name in zip(lines, campaign.names)),
        *(Mark(b.x, b.name, BEAM, _limits(b)) for b in result.slope.site.barrier),
    ]


def _limits(barrier: Barrier) -> str:
    return f": {digits(barrier.height)} m, {digits(barrier.capacity / kJ)} kJ"


def envelopes(result: "RockfallResult") -> Figure:
    """Draw the profile with the first paths, and below it the envelopes along it.

    Parameters
    ----------
    result : RockfallResult
        Of the campaign.

    Returns
    -------
    matplotlib.figure.Figure
        Height, speed and energy over x.
    """
    campaign = result.campaign
    count = min(PATHS, campaign.trials)
    words = f"Above: the first {count} trials. Below: of the rocks that come by."
    height = _profile_height(result)
    with drawn([*caption(result), words], WIDTH, height + 5.4) as figure:
        ratios = [height, *[_ENVELOPE_HEIGHT] * 3]
        panels = figure.subplots(4, 1, sharex=True, height_ratios=ratios)
        _slope(result, panels[0])
        for number in range(count):
            path = replay(result.slope, campaign, number, _INTERVAL)
            panels[0].plot(path.x, path.y, color=ROCK, linewidth=0.5, alpha=0.35, zorder=4)
        legend(panels[0])
        for axes, name in zip(panels[1:], _SHOWN, strict=True):
            _envelope(result, name, axes)
        legend(panels[1])
        panels[-1].set(xlabel="x (m)")
        figure.fit()
        name_marks(panels[0], _marks(result))
        _bring_to_scale(panels[0])
        _tell_scale(panels[0])
    return figure


def _profile_height(result: "RockfallResult") -> float:
    """Return the height (inch) of a panel with the profile to scale, within what a page holds."""
    nodes = result.slope.nodes
    heights = [node.y for node in nodes]
    rise = 1.35 * (max(heights) - min(heights)) / (nodes[-1].x - nodes[0].x)
    low, high = _PROFILE_HEIGHTS
    return min(max(_PANEL_WIDTH * rise, low), high)


def _bring_to_scale(axes: Axes) -> None:
    """Draw lengths and heights at one scale, where the panel is high enough for that."""
    box = axes.get_window_extent()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    needed = (right - left) * box.height / box.width
    if needed >= (top - bottom) * (1.0 - _SKY):
        axes.set_ylim(bottom, bottom + needed)


def _tell_scale(axes: Axes) -> None:
    """Say by how much heights are drawn larger than lengths."""
    box = axes.get_window_extent()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    ratio = (box.height / (top - bottom)) / (box.width / (right - left))
    words = "to scale" if abs(ratio - 1.0) < _TO_SCALE else f"heights × {ratio:.2g}"
    place: dict[str, Any] = {
        "xycoords": "axes fraction",
        "xytext": (2, 2),
        "color": INK,
        "zorder": 6,
    }
    axes.annotate(words, (0.0, 0.0), ha="left", va="bottom", **place, **_MARK)


def _envelope(result: "RockfallResult", name: str, axes: Axes) -> None:
    label, scale = _SHOWN[name]
    for which, (colour, dashes) in _CURVES.items():
        axes.plot(
            result.campaign.stations,
            result.envelopes[name][which] / scale,
            dashes,
            color=colour,
            linewidth=1.1,
            label="largest" if which == "max" else f"{which[1:]} %",
        )
    axes.set(ylabel=label)
    axes.set_ylim(bottom=0.0)
    for barrier in result.slope.site.barrier:
        axes.axvline(barrier.x, color=BEAM, linewidth=0.8)


# --- search lines ---


def histograms(result: "RockfallResult") -> Figure:
    """Draw a row of histograms for each line that two rocks pass at least.

    Parameters
    ----------
    result : RockfallResult
        Of the campaign.

    Returns
    -------
    matplotlib.figure.Figure
        Energy, height, speed and angular speed, with the curve of a distribution that no test
        rejects.
    """
    lines = [line for line in result.lines if line.count > 1]
    words = (
        "First passage of each rock. Curves: normal or lognormal distribution, only where a test "
        "(Anderson-Darling, 5 %) does not reject it; grey bar: 95 % percentile with its 95 % "
        "confidence interval (order statistics)."
    )
    with drawn([*caption(result), words], 10.4, 2.1 * len(lines) + 0.9) as figure:
        rows = figure.subplots(len(lines), len(QUANTITIES), squeeze=False)
        for panels, line in zip(rows, lines, strict=True):
            for axes, quantity in zip(panels, QUANTITIES, strict=True):
                _histogram(axes, line.values[quantity.name] / quantity.scale)
                axes.set(xlabel=f"{quantity.words} ({quantity.shown})", yticks=[])
                _interval(axes, line, quantity)
            panels[0].set_title(f"{literal(line.name)}: {line.count} of {line.trials} rocks")
    return figure


def _histogram(axes: Axes, values: NDArray[np.float64]) -> None:
    if np.ptp(values) <= _ALIKE * np.abs(values).max():  # but for rounding, as on a level line
        values = np.full(values.size, values[0])
    bins = min(60, max(8, round(len(values) ** 0.5)))
    axes.hist(values, bins=bins, density=True, color=SAND, edgecolor="white", linewidth=0.3)
    mean = float(values.mean())
    deviation = float(values.std(ddof=1))
    axes.ticklabel_format(axis="x", useOffset=False)
    kind = fitting(values)
    if kind:
        left, right = axes.get_xlim()
        x = np.linspace(max(left, 1e-9) if kind == "lognormal" else left, right, 200)
        axes.plot(x, _density(kind, values, x), color=TRANSMITTED, linewidth=1.0)
    axes.annotate(
        f"{digits(mean)} ± {digits(deviation)}" + (f"\n{kind}" if kind else ""),
        (1.0, 1.0),
        xycoords="axes fraction",
        xytext=(-2, -2),
        ha="right",
        va="top",
        color=TRANSMITTED,
        **_MARK,
    )


def _density(kind: str, values: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the density of the normal or lognormal distribution fitted to a sample."""
    sample, place, stretch = (
        (values, x, 1.0) if kind == "normal" else (np.log(values), np.log(x), x)
    )
    deviation = sample.std(ddof=1)
    z = (place - sample.mean()) / deviation
    curve: NDArray[np.float64] = np.exp(-0.5 * z**2) / (deviation * np.sqrt(2.0 * np.pi)) / stretch
    return curve


def _interval(axes: Axes, line: LinePassages, quantity: PassageQuantity) -> None:
    """Draw a percentile and its interval, if the rocks that pass bear it."""
    scale = quantity.scale
    for found in line.percentiles(quantity.name):
        if found.share == 0.95:
            low, high = found.low / scale, found.high / scale
            axes.axvspan(low, high, color=GREY, alpha=0.35, linewidth=0.0)
            axes.axvline(found.value / scale, color=GREY, linewidth=0.9)


# --- ends ---


def ends(result: "RockfallResult") -> Figure:
    """Draw where the rocks end, and the part of them that gets beyond x.

    Parameters
    ----------
    result : RockfallResult
        Of the campaign.

    Returns
    -------
    matplotlib.figure.Figure
        Profile, and histogram of the ends over x.
    """
    x = result.records.outcomes[:, OUTCOME.x]
    with drawn([*caption(result), "Curve: rocks that get beyond x."], WIDTH, 5.2) as figure:
        slope, axes = figure.subplots(2, 1, sharex=True, height_ratios=[1, 1.2])
        _slope(result, slope)
        legend(slope)
        _end_histogram(result, x, axes)
        axes.set(xlabel="x (m)", ylabel="trials that end here")
        reached = axes.twinx()
        reached.plot(
            [result.slope.instance["position0.x"], *np.sort(x)],
            100.0 * (1.0 - np.arange(len(x) + 1) / len(x)),
            color=INK,
            linewidth=1.1,
            drawstyle="steps-post",
        )
        reached.set(ylabel="beyond x (%)", ylim=(0.0, 104.0))
        reached.grid(False)
        legend(axes)
        figure.fit()
        name_marks(slope, _marks(result))
        _tell_scale(slope)
    return figure


def _end_histogram(result: "RockfallResult", x: NDArray[np.float64], axes: Axes) -> None:
    codes = result.records.outcomes[:, OUTCOME.end]
    bins = np.linspace(result.campaign.left, result.campaign.right, 71)
    groups = [(x[codes == code], words, colour) for code, words, colour in _ENDS]
    present = [group for group in groups if len(group[0])]
    if present:
        axes.hist(
            [np.clip(values, bins[0], bins[-1]) for values, _, _ in present],
            bins=list(bins),
            stacked=True,
            color=[colour for _, _, colour in present],
            label=[f"{words}: {len(values)}" for values, words, _ in present],
        )


# --- replay ---


def animate(result: "RockfallResult", folder: Path, progress: StageProgress) -> list[Path]:
    """Write the animations of a campaign.

    Parameters
    ----------
    result : RockfallResult
        With the trials that are to be animated, and the format.
    folder : Path
        Of the pictures; it is made where it is missing.
    progress : StageProgress
        Called for each frame.

    Returns
    -------
    list of Path
        Of the files.
    """
    folder.mkdir(exist_ok=True)
    files = [folder / f"trial-{number}.{result.animation}" for number in result.animated]
    for number, file in zip(result.animated, files, strict=True):
        animate_trial(result, number, file, counter(progress, f"replay of trial {number}, frames"))
    return files


def animate_trial(
    result: "RockfallResult",
    number: int,
    file: Path,
    count: Count = lambda done, total: None,
) -> None:
    """Write a trial as an animation: in real time if it is short, else faster.

    Parameters
    ----------
    result : RockfallResult
        Of the campaign.
    number : int
        Of the trial.
    file : Path
        Ends in .mp4 or .gif.
    count : Count
        Called with the numbers of frames done and of all.
    """
    interval = 1.0 / FRAMES_PER_SECOND
    trial = replay(result.slope, result.campaign, number, interval)
    faster = -(-len(trial.time) // _MOST_FRAMES)
    if faster > 1:
        trial = replay(result.slope, result.campaign, number, faster * interval)
    pace = f"{faster} times real time" if faster > 1 else "real time"
    last = len(trial.time) - 1
    with styled([*caption(result), f"Trial {number}, {pace}."], WIDTH, 5.6) as figure:
        draw, moving = _stage(result, trial, figure)
        figure.fit()
        name_marks(figure.axes[0], _marks(result))
        frames = len(trial.time) + _STILL
        write_animation(file, figure, frames, lambda i: draw(min(i, last)), moving, count)


def _stage(
    result: "RockfallResult", trial: Replay, figure: Figure
) -> tuple[Callable[[int], None], list[Artist]]:
    """Draw the slope with the rock, and its energy over time.

    Returns
    -------
    draw : callable
        Brings the figure to an instant, by its number.
    moving : list of Artist
        Parts that it moves.
    """
    slope, energy = figure.subplots(2, 1, height_ratios=[2.4, 1])
    _slope(result, slope)
    slope.set(xlabel="x (m)", aspect="equal")
    rock = Ellipse(
        (trial.x[0], trial.y[0]),
        2.0 * trial.radius * trial.elongation**0.5,
        2.0 * trial.radius / trial.elongation**0.5,
        facecolor=ROCK,
        edgecolor=INK,
        linewidth=0.5,
        zorder=6,
    )
    (path,) = slope.plot([], [], color=ROCK, linewidth=1.0, zorder=4)
    slope.add_patch(rock)
    (spot,) = slope.plot([], [], "o", color=ROCK, markersize=3.0, zorder=5)
    slope.set_title(" ")  # keeps the place of the words
    corner = {"xycoords": "axes fraction", "textcoords": "offset points"}
    words = slope.annotate("", (0.0, 1.0), xytext=(0, 5), va="bottom", **corner)
    energy.plot(trial.time, trial.energy / kJ, color=GREY, linewidth=0.8)
    (mark,) = energy.plot([], [], "o", color=ROCK, markersize=4.0)
    end = max(trial.time[-1], 1e-3)
    energy.set(xlabel="time (s)", ylabel="kinetic energy (kJ)", xlim=(0.0, end))

    def draw(i: int) -> None:
        path.set_data(trial.x[: i + 1], trial.y[: i + 1])
        rock.set_center((trial.x[i], trial.y[i]))
        rock.set_angle(np.degrees(trial.angle[i]))
        spot.set_data(trial.x[i : i + 1], trial.y[i : i + 1])
        mark.set_data(trial.time[i : i + 1], trial.energy[i : i + 1] / kJ)
        words.set_text(_instant(trial, i))

    return draw, [path, rock, spot, mark, words]


def _instant(trial: Replay, i: int) -> str:
    is_last = i == len(trial.time) - 1
    mode = trial.end if is_last else MODES[int(trial.mode[i]) - 1]
    return (
        f"t = {trial.time[i]:.2f} s, {mode}, {trial.speed[i]:.1f} m/s, "
        f"{trial.height[i]:.2f} m above the slope"
    )

"""Pictures of a rockfall campaign: profile with paths and envelopes, histograms at the search lines, ends, replay of a trial."""

from collections.abc import Callable, Sequence
from itertools import cycle, groupby
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from rockshed.components.common.units import kN
from rockshed.components.slope_rockfall.trajectory import OUTCOME, PASSED_RIGHT, RESTED, STOPPED

from ...pictures.style import (
    BEAM,
    GREY,
    INK,
    ROCK,
    SAND,
    TRANSMITTED,
    WIDTH,
    captioned,
    legend,
    styled,
)
from ...sites.rockfall.profile import surface
from .animation import FRAMES_PER_SECOND, write_animation
from .campaign import Records
from .preparation import Prepared
from .replay import MODES, Replay, replay
from .results import QUANTITIES, Passing

kJ = kN  # noqa: N816 (a unit)
PATHS = 60
"""Trials, from the first on, whose paths are drawn."""
_INTERVAL = 0.02
"""Time (s) between the points of a drawn path."""
_GROUNDS = ("#8c8c8c", SAND, "#a5b48a", "#c9a3a3", "#9fb3c8", "#d8cf9a")
_ENVELOPES = {
    "max": (ROCK, "-"),
    "p99": (TRANSMITTED, "-"),
    "p95": (TRANSMITTED, "--"),
    "p90": (TRANSMITTED, ":"),
    "p50": (INK, "-"),
}
_SHOWN = {
    "height": ("bounce height (m)", 1.0),
    "speed": ("speed (m/s)", 1.0),
    "energy": ("kinetic energy (kJ)", kJ),
}
_MOST_FRAMES = 400
_STILL = FRAMES_PER_SECOND
"""Frames for which the end of a replay stands still."""

Envelopes = dict[str, dict[str, NDArray[np.float64]]]


def caption(made: Prepared) -> list[str]:
    """What was computed, in short lines."""
    site, given = made.site, made.campaign
    rock = (
        f"rock: r = {site.rock.radius:g} m, m = {made.instance['mass']:.0f} kg, {site.rock.shape}"
    )
    chance = f"Latin hypercube of {site.hypercube}" if site.hypercube else "independent trials"
    return [
        f"{made.name}: {site.description}".removesuffix(": "),
        f"{given.trials} trials, seed {given.seed}, {chance}; {rock}; V_lim {site.limit_speed.mean:g} ± "
        f"{site.limit_speed.deviation:g} m/s",
    ]


def draw_all(
    made: Prepared, records: Records, passed: Sequence[Passing], along: Envelopes, folder: Path
) -> list[Path]:
    """All pictures of a campaign, as files in ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "envelopes.png", folder / "ends.png"]
    _profile_and_envelopes(made, along, files[0])
    _ends(made, records, files[1])
    if found := [passing for passing in passed if passing.count > 1]:
        files.append(folder / "lines.png")
        _histograms(made, found, files[-1])
    return files


# --- the profile ---


def _slope(made: Prepared, axes: Axes) -> None:
    """Ground in the colours of its materials, search lines and barriers."""
    x, y = np.array([node.x for node in made.nodes]), np.array([node.y for node in made.nodes])
    bottom = y.min() - 0.04 * (y.max() - y.min())
    names = [str(node.material) for node in made.nodes[:-1]]
    colours = dict(zip(made.materials, cycle(_GROUNDS)))
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
            label=name if names.index(name) == numbers[0] else None,
        )
    axes.plot(x, y, color=INK, linewidth=1.0, zorder=3)
    axes.set(
        xlim=(x[0], x[-1]), ylim=(bottom, y.max() + 0.12 * (y.max() - y.min())), ylabel="y (m)"
    )
    _marks(made, axes)


def _marks(made: Prepared, axes: Axes) -> None:
    """Search lines, and barriers at their height."""
    top = axes.get_ylim()[1]
    for line, name in zip(made.campaign.lines[: len(made.site.line)], made.campaign.names):
        axes.plot(
            line[[0, 2]],
            np.minimum(line[[1, 3]], top),
            color=GREY,
            linewidth=0.9,
            linestyle="--",
            zorder=2,
        )
        axes.annotate(
            name,
            (line[2], min(line[3], top)),
            xytext=(2, -2),
            textcoords="offset points",
            rotation=90,
            ha="left",
            va="top",
            fontsize=7.5,
            color=GREY,
        )
    for barrier in made.site.barrier:
        foot = surface(list(made.nodes), barrier.x)
        axes.plot(
            [barrier.x, barrier.x],
            [foot, foot + barrier.height],
            color=BEAM,
            linewidth=2.2,
            zorder=5,
        )
        axes.annotate(
            f"{barrier.name}: {barrier.height:g} m, {barrier.capacity / kJ:g} kJ",
            (barrier.x, foot + barrier.height),
            xytext=(0, 4),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=7.5,
            color=BEAM,
        )


def _profile_and_envelopes(made: Prepared, along: Envelopes, file: Path) -> None:
    words = f"Above: the first {min(PATHS, made.campaign.trials)} trials. Below: of the rocks that come by."
    with captioned([*caption(made), words], file, WIDTH, 8.6) as drawn:
        panels = drawn.subplots(4, 1, sharex=True, height_ratios=[2.2, 1, 1, 1])
        _slope(made, panels[0])
        for number in range(min(PATHS, made.campaign.trials)):
            path = replay(made, number, _INTERVAL)
            panels[0].plot(path.x, path.y, color=ROCK, linewidth=0.5, alpha=0.35, zorder=4)
        legend(panels[0], loc="upper right")
        for axes, (name, (label, scale)) in zip(panels[1:], _SHOWN.items(), strict=True):
            for which, (colour, dashes) in _ENVELOPES.items():
                axes.plot(
                    made.campaign.stations,
                    along[name][which] / scale,
                    dashes,
                    color=colour,
                    linewidth=1.1,
                    label="largest" if which == "max" else f"{which[1:]} %",
                )
            axes.set(ylabel=label)
            axes.set_ylim(bottom=0.0)
            for barrier in made.site.barrier:
                axes.axvline(barrier.x, color=BEAM, linewidth=0.8)
        legend(panels[1], loc="upper right", ncols=len(_ENVELOPES))
        panels[-1].set(xlabel="x (m)")


# --- search lines ---


def _histograms(made: Prepared, found: Sequence[Passing], file: Path) -> None:
    """A row for each line: energy, height, speed, angular speed, with the normal curve of the same mean and deviation."""
    words = (
        "First passage of each rock. Curves: normal distribution of the same mean and standard deviation; grey bar: 95 % "
        "percentile with its 95 % confidence interval (order statistics)."
    )
    with captioned([*caption(made), words], file, 10.4, 2.1 * len(found) + 0.9) as drawn:
        rows = drawn.subplots(len(found), len(QUANTITIES), squeeze=False)
        for panels, passing in zip(rows, found, strict=True):
            for axes, quantity in zip(panels, QUANTITIES, strict=True):
                _histogram(axes, passing.values[quantity.name] / quantity.scale)
                axes.set(xlabel=f"{quantity.name.replace('_', ' ')} ({quantity.shown})", yticks=[])
                _interval(axes, passing, quantity.name, quantity.scale)
            panels[0].set_title(f"{passing.name}: {passing.count} of {made.campaign.trials} rocks")


_ALIKE = 1e-9
"""Values that differ by no more than this part of the largest are one."""


def _histogram(axes: Axes, values: NDArray[np.float64]) -> None:
    if (
        np.ptp(values) <= _ALIKE * np.abs(values).max()
    ):  # one value but for rounding, as on a level line
        values = np.full(values.size, values[0])
    axes.hist(
        values,
        bins=min(60, max(8, round(len(values) ** 0.5))),
        density=True,
        color=SAND,
        edgecolor="white",
        linewidth=0.3,
    )
    mean, deviation = float(values.mean()), float(values.std(ddof=1))
    axes.ticklabel_format(axis="x", useOffset=False)
    if deviation > 0.0:
        x = np.linspace(*axes.get_xlim(), 200)
        curve = np.exp(-0.5 * ((x - mean) / deviation) ** 2) / (deviation * np.sqrt(2.0 * np.pi))
        axes.plot(x, curve, color=TRANSMITTED, linewidth=1.0)
    axes.annotate(
        f"{mean:.3g} ± {deviation:.3g}",
        (1.0, 1.0),
        xycoords="axes fraction",
        xytext=(-2, -2),
        textcoords="offset points",
        ha="right",
        va="top",
        fontsize=7.5,
        color=TRANSMITTED,
    )


def _interval(axes: Axes, passing: Passing, quantity: str, scale: float) -> None:
    found = next(p for p in passing.percentiles(quantity) if p.share == 0.95)
    low, high = (found.value if bound is None else bound for bound in (found.low, found.high))
    axes.axvspan(low / scale, high / scale, color=GREY, alpha=0.35, linewidth=0.0)
    axes.axvline(found.value / scale, color=GREY, linewidth=0.9)


# --- ends ---


def _ends(made: Prepared, records: Records, file: Path) -> None:
    """Where the rocks end: at rest, stopped, or beyond the right end; and the share of rocks that get farther than x."""
    x, end = records.outcomes[:, OUTCOME.x], records.outcomes[:, OUTCOME.end]
    with captioned([*caption(made), "Curve: rocks that get beyond x."], file, WIDTH, 5.2) as drawn:
        slope, axes = drawn.subplots(2, 1, sharex=True, height_ratios=[1, 1.2])
        _slope(made, slope)
        legend(slope, loc="upper right")
        bins = np.linspace(made.campaign.left, made.campaign.right, 71)
        groups = [
            (x[end == code], words, colour)
            for code, words, colour in (
                (RESTED, "at rest", SAND),
                (STOPPED, "stopped by a barrier", BEAM),
                (PASSED_RIGHT, "beyond the right end", ROCK),
            )
        ]
        present = [group for group in groups if len(group[0])]
        if present:
            axes.hist(
                [np.clip(values, bins[0], bins[-1]) for values, _, _ in present],
                bins=list(bins),
                stacked=True,
                color=[colour for _, _, colour in present],
                label=[f"{words}: {len(values)}" for values, words, _ in present],
            )
        axes.set(xlabel="x (m)", ylabel="trials that end here")
        reached = axes.twinx()
        reached.plot(
            [made.site.start.x, *np.sort(x)],
            100.0 * (1.0 - np.arange(len(x) + 1) / len(x)),
            color=INK,
            linewidth=1.1,
            drawstyle="steps-post",
        )
        reached.set(ylabel="beyond x (%)", ylim=(0.0, 104.0))
        reached.grid(False)
        legend(axes, loc="center left")


# --- replay ---


def animate(
    made: Prepared, number: int, file: Path, done: Callable[[int, int], None] = lambda i, n: None
) -> None:
    """A trial as animation: in real time if it is short, else faster; the factor is shown."""
    interval = 1.0 / FRAMES_PER_SECOND
    shown = replay(made, number, interval)
    faster = -(-len(shown.time) // _MOST_FRAMES)
    if faster > 1:
        shown = replay(made, number, faster * interval)
    pace = f"{faster} times real time" if faster > 1 else "real time"
    with styled([*caption(made), f"Trial {number}, {pace}."], WIDTH, 5.6) as drawn:
        draw, moving = _stage(made, shown, drawn)
        write_animation(
            file,
            drawn,
            len(shown.time) + _STILL,
            lambda i: draw(min(i, len(shown.time) - 1)),
            moving,
            done,
        )


def _stage(
    made: Prepared, shown: Replay, drawn: Figure
) -> tuple[Callable[[int], None], list[Artist]]:
    """The slope with the rock and its path, and its energy over time; returns what brings them to an instant, and what moves."""
    slope, energy = drawn.subplots(2, 1, height_ratios=[2.4, 1])
    _slope(made, slope)
    slope.set(xlabel="x (m)", aspect="equal")
    (path,) = slope.plot([], [], color=ROCK, linewidth=1.0, zorder=4)
    rock = slope.add_patch(
        Circle(
            (shown.x[0], shown.y[0]),
            made.site.rock.radius,
            facecolor=ROCK,
            edgecolor=INK,
            linewidth=0.5,
            zorder=6,
        )
    )
    (spot,) = slope.plot([], [], "o", color=ROCK, markersize=3.0, zorder=5)
    slope.set_title(" ")  # keeps the place of the words
    words = slope.annotate(
        "",
        (0.0, 1.0),
        xycoords="axes fraction",
        xytext=(0, 5),
        textcoords="offset points",
        va="bottom",
    )
    energy.plot(shown.time, shown.energy / kJ, color=GREY, linewidth=0.8)
    (mark,) = energy.plot([], [], "o", color=ROCK, markersize=4.0)
    energy.set(
        xlabel="time (s)", ylabel="kinetic energy (kJ)", xlim=(0.0, max(shown.time[-1], 1e-3))
    )
    last = len(shown.time) - 1

    def draw(i: int) -> None:
        path.set_data(shown.x[: i + 1], shown.y[: i + 1])
        rock.set_center((shown.x[i], shown.y[i]))
        spot.set_data(shown.x[i : i + 1], shown.y[i : i + 1])
        mark.set_data(shown.time[i : i + 1], shown.energy[i : i + 1] / kJ)
        mode = shown.end if i == last else MODES[int(shown.mode[i]) - 1]
        words.set_text(
            f"t = {shown.time[i]:.2f} s, {mode}, {shown.speed[i]:.1f} m/s, {shown.height[i]:.2f} m above the slope"
        )

    return draw, [path, rock, spot, mark, words]

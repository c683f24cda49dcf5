"""An animation of a run: rock, sand with its force chains, and beam at all recorded states."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes

from rockshed.components.common.units import kN, ms

from ..animations.formats import Count, animation_format
from ..animations.writing import FRAMES_PER_SECOND, write_animation
from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.results.own_files import is_foreign_picture, own_files
from ..core.results.reading import StoredRun
from ..metrics.caption import caption
from ..metrics.contents import decoded, reader_of
from ..metrics.cushion import both_forces, cushions
from ..tables import digits
from .sand import Frame, draw_moving, draw_still, in_words, read_as, shape_of, view_of
from .style import ROCK, TRANSMITTED, legend, over_time, styled

FEWEST = 20
"""Frames below which an animation shows little of the motion."""
_STILL = FRAMES_PER_SECOND
"""Frames for which the end stands still."""
_WIDTH = 7.2
"""Width (inch)."""
_CURVES = 1.9
"""Height (inch) of the curves below the sand."""
_TITLE = 0.3
"""Height (inch) of the words above the sand."""
_CORNER: dict[str, Any] = {
    "xycoords": "axes fraction",
    "textcoords": "offset points",
    "va": "bottom",
    "fontsize": 8,
}


def animate_run(run: StoredRun, file: Path | None, count: Count) -> Path:
    """Write the animation of a run.

    Parameters
    ----------
    run : StoredRun
        The run.
    file : Path, optional
        Ends in .mp4 or .gif; by default ``figures/animation`` in the folder of the run, as MP4
        where it can be written.
    count : Count
        Called with the numbers of frames that are done, and of all.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputRefused
        There are too few states, the format is unknown or its packages are missing, or the place
        cannot be written.
    """
    cushion = _animated(run)
    wanted = None if file is None else file.suffix.removeprefix(".").lower()
    place = file or run.folder / "figures" / "animation"
    form = animation_format(wanted)
    place = place if file else place.with_suffix(f".{form}")
    _refuse_foreign(run, place)
    shown = [Frame(at, decoded(run, cushion, state)) for at, state in run.states(cushion)]
    with refusing_unwritable(place.parent):
        place.parent.mkdir(parents=True, exist_ok=True)
        _write(run, cushion, shown, place, count)
    return place


def is_coarse(run: StoredRun) -> str:
    """Return what to do if a run has so few states that its animation shows little; else nothing.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    number = sum(1 for _ in run.states(_animated(run)))
    if number >= FEWEST:
        return ""
    wished = float(run.time[-1] - run.time[0]) / 100.0
    return f"the animation has {number} frames only: state_interval={wished:.1g} of a run gives 100"


def _animated(run: StoredRun) -> str:
    """Return the first cushion whose states can be drawn and move."""
    wished = float(run.time[-1] - run.time[0]) / 100.0 if run.time.size else 0.0005
    for cushion in cushions(run):
        if reader_of(run, cushion) is None:
            continue
        states = run.states(cushion)
        if next(states, None) and next(states, None):
            return cushion
    what = "has no two recorded states of sand that could be shown"
    remedy = f"record some: state_interval={wished or 0.0005:.1g} of a run"
    raise InputRefused([Problem(str(run.folder), what, remedy)])


def _refuse_foreign(run: StoredRun, file: Path) -> None:
    own = {(run.folder / name).absolute() for name in own_files(run.folder)}
    if file.absolute() not in own and is_foreign_picture(file):
        remedy = "remove it or name another file"
        raise InputRefused([Problem(str(file), "is there already and stays", remedy)])


def _write(run: StoredRun, cushion: str, shown: Sequence[Frame], file: Path, count: Count) -> None:
    last = len(shown) - 1
    words = [_pace(shown), read_as(run, shown), *caption(run)]
    height = _WIDTH * shape_of(shown) + _TITLE
    with styled(words, _WIDTH, height + _CURVES) as figure:
        above, below = figure.subplots(2, 1, height_ratios=[height, _CURVES])
        view = view_of(run, cushion, shown)
        draw_still(view, shown[0], above)
        above.set_title(" ", fontsize=8)  # keeps the place of the words
        mark = _curves(run, cushion, below)
        moving: list[Artist] = [mark]
        figure.fit()

        def draw(number: int) -> None:
            frame = shown[min(number, last)]
            for artist in moving[1:]:
                artist.remove()
            words = above.annotate(in_words(view, frame), (0.0, 1.0), xytext=(0, 5), **_CORNER)
            moving[1:] = [*draw_moving(view, frame, above), words]
            mark.set_xdata([frame.time / ms, frame.time / ms])

        write_animation(file, figure, last + 1 + _STILL, draw, moving, count)


def _pace(shown: Sequence[Frame]) -> str:
    """Say how much slower than in truth the animation runs."""
    lasts = shown[-1].time - shown[0].time
    slower = (len(shown) - 1) / FRAMES_PER_SECOND / lasts if lasts > 0.0 else 1.0
    return f"{len(shown)} recorded states, {digits(slower)} times slower than in truth"


def _curves(run: StoredRun, cushion: str, axes: Axes) -> Any:
    """Draw the forces over time, and return a line that marks an instant."""
    time = run.series["time"] / ms
    words = (("transmitted to the base", TRANSMITTED), ("on the rock", ROCK))
    for (name, colour), force in zip(words, both_forces(run, cushion) or ()):
        axes.plot(time, run.series[force] / kN, color=colour, linewidth=1.0, label=name)
    axes.set(xlabel="time (ms)", ylabel="force (kN)")
    over_time(axes, time)
    legend(axes)
    return axes.axvline(float(time[0]), color=ROCK, linewidth=0.9)

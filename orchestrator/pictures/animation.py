"""Animations: a figure drawn again for every frame, as MP4 or GIF. The file is written as a whole or not at all."""

import os
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ..core.errors import InputRefused, Problem

FRAMES_PER_SECOND = 25
KINDS = ("mp4", "gif")
_GIF_DPI = 80
"""GIF files are large: fewer pixels."""

Draw = Callable[[int], Any]
"""Brings the figure to frame number i."""
Done = Callable[[int, int], None]
"""Told the number of frames done, and of all."""


def can_mp4() -> bool:
    """Whether the packages of the extra ``movie`` are there."""
    return all(find_spec(name) is not None for name in ("imageio", "imageio_ffmpeg"))


def kind_of(wanted: str | None, note: Callable[[str], None]) -> str:
    """``mp4`` or ``gif``: the one that is wanted, else what this installation can write.

    Raises:
        InputRefused: another kind, or MP4 without the packages for it.
    """
    if wanted is None:
        if can_mp4():
            return "mp4"
        note('animations become GIF files; pip install "rockshed[movie]" for MP4')
        return "gif"
    if wanted not in KINDS:
        raise InputRefused([Problem("--animation", f"{wanted!r} is unknown", f"choose one of {', '.join(KINDS)}")])
    if wanted == "mp4" and not can_mp4():
        raise InputRefused([Problem("--animation mp4", "needs the packages imageio and imageio-ffmpeg",
                                    'install them: pip install "rockshed[movie]", or take --animation gif')])
    return wanted


def write_animation(file: Path, figure: Figure, frames: int, draw: Draw,
                    done: Done = lambda i, n: None) -> None:
    """Draw frames 0 ... frames - 1 of a figure into an MP4 or GIF file, as its name ends.

    The figure is laid out once: axes keep their places.
    """
    canvas = FigureCanvasAgg(figure)
    draw(0)
    canvas.draw()
    figure.set_layout_engine("none")
    beside = file.with_name(f".{file.name}")
    try:
        (_write_mp4 if file.suffix == ".mp4" else _write_gif)(beside, figure, canvas, frames, draw, done)
        os.replace(beside, file)
    finally:
        beside.unlink(missing_ok=True)


def _write_mp4(file: Path, figure: Figure, canvas: FigureCanvasAgg, frames: int, draw: Draw, done: Done) -> None:
    import imageio

    writer: Any = imageio.get_writer(file, format="FFMPEG", fps=FRAMES_PER_SECOND, codec="libx264", macro_block_size=2,
                                     ffmpeg_log_level="error")
    with writer as movie:
        for i in range(frames):
            draw(i)
            canvas.draw()
            picture = np.asarray(canvas.buffer_rgba())[:, :, :3]
            movie.append_data(picture[:picture.shape[0] // 2 * 2, :picture.shape[1] // 2 * 2])
            done(i + 1, frames)


def _write_gif(file: Path, figure: Figure, canvas: FigureCanvasAgg, frames: int, draw: Draw, done: Done) -> None:
    with PillowWriter(fps=FRAMES_PER_SECOND).saving(figure, str(file), _GIF_DPI) as movie:
        for i in range(frames):
            draw(i)
            movie.grab_frame()
            done(i + 1, frames)

"""Animations as MP4 or GIF: a figure of which a few parts move."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..files import whole_file
from .formats import Count

FRAMES_PER_SECOND = 25
"""Frames in a second of an animation."""
_GIF_SIZE, _GIF_COLOURS = 0.6, 256
"""Part of the width and height, and number of colours: GIF files are large.

All frames have the colours of the first.
"""

MovieFrame = NDArray[np.uint8]
"""A frame, shape (height, width, 3)."""
Draw = Callable[[int], Any]
"""Brings the figure to a frame, by its number."""


def write_animation(
    file: Path,
    figure: Figure,
    frames: int,
    draw: Draw,
    moving: Sequence[Artist],
    count: Count = lambda done, total: None,
) -> None:
    """Write a figure as an animation; the file is whole or does not appear.

    Parameters
    ----------
    file : Path
        Ends in .mp4 or .gif.
    figure : matplotlib.figure.Figure
        With everything that stands still, which is drawn once.
    frames : int
        Number of frames.
    draw : Draw
        Called with 0 to frames - 1.
    moving : sequence of matplotlib.artist.Artist
        Parts that ``draw`` changes, in the order in which they are drawn.
    count : Count
        Called with the numbers of frames done and of all.
    """
    write = _write_mp4 if file.suffix == ".mp4" else _write_gif
    with whole_file(file) as temporary:
        write(temporary, _pictures(figure, frames, draw, moving, count))


def _pictures(
    figure: Figure, frames: int, draw: Draw, moving: Sequence[Artist], count: Count
) -> Iterator[MovieFrame]:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    figure.set_layout_engine("none")
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    for i in range(frames):
        canvas.restore_region(still)
        draw(i)
        for artist in moving:
            figure.draw_artist(artist)
        yield np.array(canvas.buffer_rgba())[:, :, :3]
        count(i + 1, frames)


def _write_mp4(file: Path, pictures: Iterator[MovieFrame]) -> None:
    import imageio

    writer: Any = imageio.get_writer(
        file,
        format="FFMPEG",
        fps=FRAMES_PER_SECOND,
        codec="libx264",
        macro_block_size=2,
        ffmpeg_log_level="error",
        output_params=["-preset", "veryfast"],
    )
    with writer as movie:
        for picture in pictures:
            movie.append_data(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])


def _write_gif(file: Path, pictures: Iterator[MovieFrame]) -> None:
    from PIL import Image

    small: list[Image.Image] = []
    for picture in pictures:
        image = Image.fromarray(picture)
        image = image.resize((round(_GIF_SIZE * image.width), round(_GIF_SIZE * image.height)))
        palette = small[0] if small else image.quantize(_GIF_COLOURS)
        small.append(image.quantize(palette=palette, dither=Image.Dither.NONE))
    small[0].save(
        file,
        format="GIF",
        save_all=True,
        append_images=small[1:],
        duration=1000 // FRAMES_PER_SECOND,
        loop=0,
    )

"""Animations as MP4 or GIF: a figure of which a few parts move. The file is written as a whole or not at all."""

from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...core.errors import InputRefused, Problem
from ...files import whole_file

FRAMES_PER_SECOND = 25
KINDS = ("mp4", "gif")
_GIF_SIZE, _GIF_COLOURS = 0.6, 256
"""GIF files are large: a part of the width and height. All frames have the colours of the first."""

Picture = NDArray[np.uint8]
"""A frame: (height, width, 3)."""

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
        raise InputRefused(
            [Problem("--animation", f"{wanted!r} is unknown", f"choose one of {', '.join(KINDS)}")]
        )
    if wanted == "mp4" and not can_mp4():
        raise InputRefused(
            [
                Problem(
                    "--animation mp4",
                    "needs the packages imageio and imageio-ffmpeg",
                    'install them: pip install "rockshed[movie]", or take --animation gif',
                )
            ]
        )
    return wanted


def write_animation(
    file: Path,
    figure: Figure,
    frames: int,
    draw: Draw,
    moving: Sequence[Artist],
    done: Done = lambda i, n: None,
) -> None:
    """Frames 0 ... frames - 1 of a figure as an MP4 or GIF file, as its name ends.

    moving: what ``draw`` changes, in the order in which it is drawn; everything else stands still and is drawn once.
    """
    write = _write_mp4 if file.suffix == ".mp4" else _write_gif
    with whole_file(file) as temporary:
        write(temporary, _pictures(figure, frames, draw, moving, done))


def _pictures(
    figure: Figure, frames: int, draw: Draw, moving: Sequence[Artist], done: Done
) -> Iterator[Picture]:
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
        done(i + 1, frames)


def _write_mp4(file: Path, pictures: Iterator[Picture]) -> None:
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


def _write_gif(file: Path, pictures: Iterator[Picture]) -> None:
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

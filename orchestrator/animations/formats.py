"""Formats of animations, and whether this installation can write them."""

from collections.abc import Callable
from importlib.util import find_spec

from ..core.errors import InputRefused, Problem

Count = Callable[[int, int], None]
"""Called with the number of pieces of work that are done, and of all."""
FORMATS = ("mp4", "gif")
"""Endings of the files."""


def can_write_mp4() -> bool:
    """Return whether the packages of the extra ``movie`` are installed."""
    return all(find_spec(name) is not None for name in ("imageio", "imageio_ffmpeg"))


def animation_format(wanted: str | None) -> str:
    """Return the format in which animations are written.

    Parameters
    ----------
    wanted : str or None
        One of :data:`FORMATS`; None for MP4 where it can be written, else GIF.

    Returns
    -------
    str
        One of :data:`FORMATS`.

    Raises
    ------
    InputRefused
        Another format, or MP4 without the packages for it.
    """
    if wanted is None:
        return "mp4" if can_write_mp4() else "gif"
    if wanted not in FORMATS:
        remedy = f"choose one of {', '.join(FORMATS)}"
        raise InputRefused([Problem("animation", f"{wanted!r} is unknown", remedy)])
    if wanted == "mp4" and not can_write_mp4():
        text = "needs the packages imageio and imageio-ffmpeg"
        remedy = 'install them: pip install "rockshed[movie]", or take gif'
        raise InputRefused([Problem("animation mp4", text, remedy)])
    return wanted

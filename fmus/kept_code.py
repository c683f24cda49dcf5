"""Compiled code that is kept under a digest of what it was made from."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from rockshed.components.common.cache import cache_directory
from rockshed.components.common.component import Component
from rockshed.components.common.kept import keep, kept
from rockshed.temporary import TemporaryFolder

from .parts import refuse_changed


def kept_or_made(
    component: Component,
    file_names: Callable[[], Mapping[str, str]],
    make: Callable[[Path], dict[str, bytes]],
) -> dict[str, bytes]:
    """Return code that is kept, or make it and keep it.

    A compiler reads the sources after the digest has been made. The digest is therefore made once
    more after it: otherwise code of new sources would be kept under the name of the old ones.

    Parameters
    ----------
    component : Component
        Whose code.
    file_names : callable
        Returns names of files, with a digest of the present sources, by the name of a piece.
    make : callable
        Makes all pieces in a temporary folder.

    Returns
    -------
    dict of str to bytes
        Code by the name of its piece.

    Raises
    ------
    BuildError
        The sources have changed while the code was made, or it cannot be made.
    """
    names, folder = file_names(), cache_directory()
    found = {piece: kept(folder / name) for piece, name in names.items()} if folder else {}
    sound = {piece: content for piece, content in found.items() if content is not None}
    if sound.keys() == names.keys():
        return sound
    with TemporaryFolder() as work:
        made = make(work)
    refuse_changed(component, names, file_names())
    if folder:
        for piece, name in names.items():
            with suppress(OSError):  # then it is compiled again next time
                keep(folder / name, made[piece])
    return made

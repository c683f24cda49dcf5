"""The frame of all analyses: a result with tables, figures and files, and its folder."""

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cached_property
from html import escape
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..animations.formats import Count
from ..core.errors import refusing_unwritable
from ..core.results.metric import Metric, Metrics
from ..core.results.own_files import refuse_foreign
from ..core.results.run_folder import RunFolder
from ..files import naming
from ..tables import Table
from ..temporary import ALIVE, TemporaryFolder

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]
"""Numbers of any shape."""
StageProgress = Callable[[str, int, int], None]
"""Called with the name of a stage, and the numbers of its pieces that are done and of all."""
Drawing = Callable[[], "Figure"]
"""Draws a figure when it is called."""


def no_progress(stage: str, done: int, total: int) -> None:
    """Show no progress of an analysis."""


def counter(progress: StageProgress, stage: str) -> Count:
    """Return a function that counts the pieces of one stage.

    Parameters
    ----------
    progress : StageProgress
        Called for each piece.
    stage : str
        Name of the stage.

    Returns
    -------
    Count
        Called with the numbers of pieces done and of all.
    """
    return lambda done, total: progress(stage, done, total)


@contextmanager
def whole_folder(folder: str | Path) -> Iterator[Path]:
    """Open a folder that appears as a whole when the block ends, and not at all if it fails.

    Parameters
    ----------
    folder : path
        Of the results; results that are there already are replaced.

    Yields
    ------
    Path
        Folder in which the files are written meanwhile.

    Raises
    ------
    InputRefused
        The folder cannot be written, or holds something other than results.
    """
    with RunFolder(Path(folder)) as place:
        yield place.running
        place.swap()


@contextmanager
def shared_folder(folder: str | Path, names: Sequence[str]) -> Iterator[Path]:
    """Open a folder whose other files stay; the new ones appear when the block ends.

    Parameters
    ----------
    folder : path
        Of the results; it is made where it is missing, and removed again if the block fails.
    names : sequence of str
        Files that may be written, relative to the folder.

    Yields
    ------
    Path
        Folder in which the files are written meanwhile.

    Raises
    ------
    InputRefused
        The folder cannot be written, or the user has files of these names in it.
    """
    target = Path(folder)
    refuse_foreign(target, names, "rename it or choose another folder")
    parents = (target, *target.parents)
    missing = [parent for parent in parents if not parent.exists()]
    with refusing_unwritable(target):
        target.mkdir(parents=True, exist_ok=True)
        place = TemporaryFolder(".rockshed-", target)
    try:
        with place as inside:
            yield inside
            written = [file for file in inside.iterdir() if file.name != ALIVE]
            for file in written:
                os.replace(file, target / file.name)
    finally:
        for parent in missing:
            with suppress(OSError):  # it is not empty
                parent.rmdir()


class Result(ABC):
    """Results of an analysis: objects for a program, tables and figures for a person.

    Attributes
    ----------
    folder : Path or None
        Where the results were saved last.
    files, pictures : sequence of Path
        Written there.
    """

    kind: ClassVar[str]
    """Name of the analysis."""
    status: ClassVar[str] = "complete"
    """End of the analysis; one that does not come to its end raises and has no result."""
    picture_folder: ClassVar[str] = "figures"
    """Folder of the pictures in that of the results."""
    animated: Sequence[int] = ()
    """Numbers of the parts of the results of which animations are written."""

    def __init__(self) -> None:
        self.folder: Path | None = None
        self._files: list[str] = []
        self._pictures: list[str] = []

    # --- each analysis has its own ---

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the site or of the measurement."""

    @abstractmethod
    def metric_list(self) -> list[Metric]:
        """Return the single values of the results, in the order of ``summary.json``."""

    @property
    @abstractmethod
    def summary(self) -> str:
        """Content of the results in one line."""

    @property
    @abstractmethod
    def notes(self) -> list[str]:
        """Remarks for the reader of the tables, a sentence each."""

    @property
    def warnings(self) -> list[str]:
        """Reasons for doubts about the metrics, a sentence each."""
        return []

    @abstractmethod
    def tables(self) -> list[Table]:
        """Return the results as tables for a person, in the order in which they are read."""

    @abstractmethod
    def to_arrow(self) -> Any:
        """Return the main table of the results.

        Returns
        -------
        pyarrow.Table
            Unit and description of each column are in the metadata of its field.
        """

    @abstractmethod
    def write_files(self, folder: Path) -> Sequence[Path]:
        """Write all files but the pictures into a folder that exists, and return them."""

    # --- all have the same ---

    @classmethod
    def pictures_module(cls) -> Any:
        """Return the module ``pictures`` of the analysis, which is loaded when it is needed.

        Its function ``drawings`` takes a result and returns a :data:`Drawing` for each figure by
        the name of its file without the ending; ``animate``, where it has one, takes a result, a
        folder and a :data:`StageProgress`, and returns the files that it has written.
        """
        package = cls.__module__.rpartition(".")[0]
        return import_module(f"{package}.pictures")

    @cached_property
    def metrics(self) -> Metrics:
        """Single values with units, by identifier."""
        return Metrics(self.metric_list())

    def to_pandas(self) -> Any:
        """Return the main table of the results for pandas, which has to be installed.

        Returns
        -------
        pandas.DataFrame
            Units by the name of the column are in ``attrs["units"]``.
        """
        table = self.to_arrow()
        frame = table.to_pandas()
        frame.attrs["units"] = {
            field.name: field.metadata[b"unit"].decode("utf-8") for field in table.schema
        }
        return frame

    def figures(self) -> "dict[str, Figure]":
        """Draw the results.

        Returns
        -------
        dict of str to matplotlib.figure.Figure
            By the name of the file that :meth:`save` writes, without its ending.
        """
        drawings: Mapping[str, Drawing] = self.pictures_module().drawings(self)
        return {name: draw() for name, draw in drawings.items()}

    def save(
        self, folder: str | Path, *, pictures: bool = True, progress: StageProgress | None = None
    ) -> Path:
        """Write the results into a folder, which appears as a whole or not at all.

        Parameters
        ----------
        folder : path
            New or empty, or with results that are replaced.
        pictures : bool
            Whether the figures are drawn and written too.
        progress : StageProgress, optional
            Called for each figure.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputRefused
            The folder cannot be written, or holds something else.
        """
        with self.opened(folder) as place:
            self.write(place, pictures, progress or no_progress)
        self.folder = Path(folder)
        return self.folder

    @classmethod
    def opened(cls, folder: str | Path) -> AbstractContextManager[Path]:
        """Open the folder of the results, see :func:`whole_folder`."""
        return whole_folder(folder)

    def write(self, place: Path, pictures: bool, progress: StageProgress) -> None:
        """Write files and pictures into an opened folder.

        Parameters
        ----------
        place : Path
            As :meth:`opened` has it.
        pictures : bool
            Whether the figures are drawn and written too.
        progress : StageProgress
            Called for each figure.
        """
        folder = place / self.picture_folder
        with naming(place):
            self._files = [file.name for file in self.write_files(place)]
        drawn = self.write_pictures(folder, progress) if pictures else []
        if self.animated:
            drawn += self.pictures_module().animate(self, folder, progress)
        self._pictures = [str(file.relative_to(place)) for file in drawn]

    def write_pictures(self, folder: Path, progress: StageProgress) -> list[Path]:
        """Draw all figures as PNG files.

        Parameters
        ----------
        folder : Path
            Of the pictures; it is made where it is missing.
        progress : StageProgress
            Called for each figure.

        Returns
        -------
        list of Path
            Of the files.
        """
        with refusing_unwritable(folder):
            folder.mkdir(parents=True, exist_ok=True)
        drawings: Mapping[str, Drawing] = self.pictures_module().drawings(self)
        files = [folder / f"{name}.png" for name in drawings]
        progress("drawing", 0, len(files))
        for number, (draw, file) in enumerate(zip(drawings.values(), files, strict=True), 1):
            with naming(file):
                draw().savefig(file, format="png", metadata={"Software": "rockshed"})
            progress("drawing", number, len(files))
        return files

    @property
    def files(self) -> list[Path]:
        """Files in :attr:`folder`, without the pictures."""
        return self._in_folder(self._files)

    @property
    def pictures(self) -> list[Path]:
        """Pictures in :attr:`folder`, animations included."""
        return self._in_folder(self._pictures)

    def _in_folder(self, names: Sequence[str]) -> list[Path]:
        return [self.folder / name for name in names] if self.folder else []

    def __repr__(self) -> str:
        place = f", in {self.folder}" if self.folder else ""
        return f"<{type(self).__name__} {self.name}: {self.summary}{place}>"

    def _repr_html_(self) -> str:
        notes = [escape(text) for text in (*self.warnings, *self.notes)]
        return "".join(
            (
                f"<p>{escape(repr(self)[1:-1])}</p>",
                *(table._repr_html_() for table in self.tables()),
                f"<p>{'<br>'.join(notes)}</p>" if notes else "",
            )
        )

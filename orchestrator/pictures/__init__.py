"""Pictures of a run, from its results alone: the same at the end of a run and later."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryFile

from rockshed.components.common.roles import Role

from ..core.errors import InputRefused, refusing_unwritable
from ..core.results.facts import table_of
from ..core.results.own_files import is_foreign_picture
from ..core.results.reading import StoredRun
from ..metrics.comparison import known_of
from ..metrics.contents import ForeignStateError, reader_of
from ..metrics.cushion import cushions
from ..metrics.divergence import until_divergence
from ..metrics.energy import driven
from ..metrics.pressure import roof_pressure
from ..metrics.roles import members
from ..metrics.slope import slope_of
from .declared import declared_pictures
from .references import KnownMetrics

Tell = Callable[[str], None]
"""Shows a line to the user."""


@dataclass(frozen=True)
class RunPicture:
    """A picture and what it needs.

    Attributes
    ----------
    name : str
        Name of its file without the ending.
    draw : callable
        Draws it into a file, ``.png`` or ``.svg``.
    columns : sequence of str
        Columns of the results without which it is not drawn.
    states_of : str or None
        Component whose recorded states are drawn.
    """

    name: str
    draw: Callable[[Path], None]
    columns: Sequence[str]
    states_of: str | None = None

    def missing(self, run: StoredRun) -> list[str]:
        """Return the columns and states that the results do not have."""
        absent = [column for column in self.columns if column not in run.series]
        if self.states_of and next(run.states(self.states_of), None) is None:
            absent.append(f"recorded states of {self.states_of}")
        return absent


def draw_all(
    run: StoredRun, folder: Path, note: Tell = lambda text: None, warn: Tell = lambda text: None
) -> list[Path]:
    """Draw every picture that the results of a run allow.

    Whatever happens to a picture, the others are drawn.

    Parameters
    ----------
    run : StoredRun
        The run.
    folder : Path
        Folder of the PNG files.
    note : callable
        Called with a line for each picture that the results have no data for.
    warn : callable
        Called with a line for each picture that could not be drawn, and why.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputRefused
        The folder cannot be written.
    """
    drawn = []
    for picture in pictures_of(run):
        file = folder / f"{picture.name}.png"
        try:
            if missing := picture.missing(run):
                note(f"no picture {picture.name}: the results have no {', '.join(missing)}")
                continue
        except InputRefused as damaged:
            warn(f"no picture {picture.name}: {damaged}")
            continue
        _make(folder)
        if is_foreign_picture(file):
            warn(f"no picture {picture.name}: {file} was not drawn by this program, and stays")
            continue
        try:
            picture.draw(file)
        except ForeignStateError as error:
            note(
                f"no picture {picture.name}: the states were recorded by another version "
                f"of the FMU ({error})"
            )
            continue
        except Exception as error:  # a run's outcome is told even if a picture of it fails
            warn(f"no picture {picture.name}: drawing it failed ({type(error).__name__}: {error})")
            continue
        drawn.append(file)
    return drawn


def pictures_of(run: StoredRun) -> list[RunPicture]:
    """Return the pictures of the components that take part, whether the results allow them or not.

    Parameters
    ----------
    run : StoredRun
        The run; of one that has failed, what comes after it has run away is not drawn.
    """
    run = until_divergence(run)
    from .energy import energy  # matplotlib is imported when something is drawn

    known = known_of(run)
    several = len(cushions(run)) > 1
    of_cushions = [
        replace(picture, name=f"{picture.name}_{cushion}" if several else picture.name)
        for cushion in cushions(run)
        for picture in _of_cushion(run, cushion, known)
    ]
    of_components = [
        RunPicture(picture.name, partial(picture.draw, run, known), picture.columns)
        for picture in declared_pictures(run)
    ]
    striking = [member.column for member in members(run, Role.STRIKING)]
    balance = [RunPicture("energy", partial(energy, run), striking)] if striking else []
    return of_cushions + of_components + balance + _of_slope(run) + _of_exchanges(run)


def _of_exchanges(run: StoredRun) -> list[RunPicture]:
    """Return the pictures of how exchanges were made: their steps, their iterations."""
    from .exchange_step import exchange_step  # matplotlib is imported when something is drawn
    from .iterations import iterations

    system = run.provenance["system"]
    made = []
    if system.get("adaptive") is not None and len(run.time) > 1:
        made.append(RunPicture("exchange_step", partial(exchange_step, run), ["coupling.step"]))
    kept = table_of(run.provenance, "iteration").get("windows")
    if system.get("master") == "implicit" and (len(run.time) > 1 or kept):
        made.append(RunPicture("iterations", partial(iterations, run), ["coupling.iterations"]))
    return made


def _of_slope(run: StoredRun) -> list[RunPicture]:
    """Return the picture of the slope that the rock comes from; none where there is none."""
    if not slope_of(run):
        return []
    from .slope import slope  # matplotlib is imported when something is drawn

    return [RunPicture("slope", partial(slope, run), [])]


def _of_cushion(run: StoredRun, cushion: str, known: KnownMetrics) -> list[RunPicture]:
    """Return the pictures of a cushion; those of its grains only where they can be read."""
    from . import cushion as curves
    from . import sand

    forces = _declared(run, cushion, Role.TRANSMITTED, Role.ON_BODY)
    depth = _declared(run, cushion, Role.PENETRATION)
    grains = []
    overview = []
    if reader_of(run, cushion) is not None:
        draw = partial(sand.snapshots, run, cushion)
        grains = [RunPicture("sand", draw, forces[:1] + depth, cushion)]
        draw = partial(sand.overview, run, cushion, known)
        overview = [RunPicture("overview", draw, forces + depth, cushion)]
    if driven(run):
        draw = partial(curves.load, run, cushion, known)
        return [RunPicture("load", draw, forces[1:] + depth), *grains]
    return [
        *overview,
        *grains,
        RunPicture("forces", partial(curves.forces, run, cushion, known), forces),
        *_pressure(run, cushion),
        RunPicture("penetration", partial(curves.penetration, run, cushion, known), depth),
    ]


def _pressure(run: StoredRun, cushion: str) -> list[RunPicture]:
    """Return the picture of the pressure; none where no structure carries the cushion."""
    if roof_pressure(run, cushion) is None:
        return []
    from . import pressure  # matplotlib is imported when something is drawn

    return [RunPicture("pressure", partial(pressure.pressure, run, cushion), [])]


def _declared(run: StoredRun, component: str, *roles: Role) -> list[str]:
    """Return the columns of a component's outputs with these roles, recorded or not."""
    return [
        member.column
        for role in roles
        for member in members(run, role)
        if member.component == component
    ]


def _make(folder: Path) -> None:
    with refusing_unwritable(folder, "name another folder: folder=..."):
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()

"""Pictures of a run, from its results alone: the same at the end of a run and later."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryFile

from rockshed.components.common.component import ComponentError

from ..core.errors import InputRefused, refusing_unwritable
from ..core.results.reading import Run
from ..metrics.comparison import known_of
from ..metrics.headlines import driven, named, roles

Tell = Callable[[str], None]
"""Shows a line to the user."""


@dataclass(frozen=True)
class _Picture:
    """A picture and what it needs: columns of the results, recorded states of a component."""

    name: str
    draw: Callable[[Path], None]
    columns: Sequence[str]
    states_of: str | None = None

    def missing(self, run: Run) -> list[str]:
        """What the results do not have."""
        absent = [column for column in self.columns if column not in run.series]
        if self.states_of and next(run.states(self.states_of), None) is None:
            absent.append(f"recorded states of {self.states_of}")
        return absent


def draw_all(
    run: Run, folder: Path, note: Tell = lambda text: None, warn: Tell = lambda text: None
) -> list[Path]:
    """Draw every picture that the results of a run allow into ``folder``; return the files.

    note: is told which pictures the results have no data for; warn: which could not be drawn, and why. Whatever happens to a
    picture, the others are drawn.

    Raises:
        InputRefused: the folder cannot be written.
    """
    drawn = []
    for picture in _pictures(run):
        file = folder / f"{picture.name}.png"
        try:
            if missing := picture.missing(run):
                note(f"no picture {picture.name}: the results have no {', '.join(missing)}")
                continue
        except InputRefused as damaged:
            warn(f"no picture {picture.name}: {damaged}")
            continue
        _make(folder)
        try:
            picture.draw(file)
        except ComponentError as error:
            note(
                f"no picture {picture.name}: the states were recorded by another version of the FMU ({error})"
            )
            continue
        except Exception as error:  # a run's outcome is told even if a picture of it fails
            warn(f"no picture {picture.name}: drawing it failed ({type(error).__name__}: {error})")
            continue
        drawn.append(file)
    return drawn


def _pictures(run: Run) -> list[_Picture]:
    """The pictures of the components that take part."""
    from . import curves, piles, sand

    known, who = known_of(run), roles(run)
    force, depth = (
        [f"{who.sand}.transmitted_force", f"{who.sand}.rock.force.y"],
        [f"{who.sand}.penetration"],
    )
    of_sand = (
        []
        if who.sand is None
        else [
            _Picture("load", partial(curves.load, run, known), [force[1], *depth]),
            _Picture("sand", partial(sand.snapshots, run), force[:1] + depth, who.sand),
        ]
        if driven(run)
        else [
            _Picture("overview", partial(sand.overview, run, known), force + depth, who.sand),
            _Picture("sand", partial(sand.snapshots, run), force[:1] + depth, who.sand),
            _Picture("forces", partial(curves.forces, run, known), force),
            _Picture("penetration", partial(curves.penetration, run, known), depth),
        ]
    )
    of_beam = (
        []
        if who.beam is None
        else [
            _Picture("beam", partial(curves.beam, run, known), [f"{who.beam}.midspan.deflection"])
        ]
    )
    striking = [who.rock] if who.rock else named(run, "Hammer")
    of_rock = (
        []
        if not striking
        else [
            _Picture(
                "energy",
                partial(curves.energy, run),
                [f"{name}.energy.kinetic" for name in striking],
            )
        ]
    )
    rods, grounds = named(run, "PileRod"), named(run, "ImpulsiveGround")
    of_piles = (
        []
        if not rods
        else [
            _Picture(
                "piles",
                partial(piles.blow, run),
                [
                    *(
                        f"{rod}.{end}"
                        for rod in rods
                        for end in ("head.contact_force", "head.zv", "toe.contact_force")
                    ),
                    *(f"{ground}.settlement" for ground in grounds),
                ],
            )
        ]
    )
    return of_sand + of_beam + of_piles + of_rock


def _make(folder: Path) -> None:
    with refusing_unwritable(folder, "name another folder with --output-dir"):
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()

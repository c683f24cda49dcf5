"""Pictures of a run, from its results alone: the same at the end of a run and later."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from ..cases.registry import known_of
from ..core.errors import InputRefused, Problem
from ..core.reading import Run
from ..headlines import roles


def draw_all(run: Run, folder: Path, note: Callable[[str], None] = lambda text: None) -> list[Path]:
    """Draw every picture that the results of a run allow into ``folder``; return the files.

    Raises:
        InputRefused: the folder cannot be written.
    """
    from . import curves

    known, who = known_of(run.provenance), roles(run)
    wanted: list[tuple[str, list[str], Callable[[Path], None]]] = [
        ("forces", [f"{who.sand}.transmitted_force", f"{who.sand}.rock.force.y"], partial(curves.forces, run, known)),
        ("penetration", [f"{who.sand}.penetration"], partial(curves.penetration, run, known)),
        ("beam", [f"{who.beam}.midspan.deflection"], partial(curves.beam, run, known)),
        ("energy", [f"{who.rock}.energy.kinetic"], partial(curves.energy, run)),
    ]
    drawn = []
    _make(folder)
    for name, columns, draw in wanted:
        if missing := [column for column in columns if column not in run.series]:
            note(f"no picture {name}: the results have no {', '.join(missing)}")
        else:
            draw(folder / f"{name}.png")
            drawn.append(folder / f"{name}.png")
    return drawn


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputRefused([Problem(str(folder), f"cannot be written: {error.strerror or error}",
                                    "name another folder with --output-dir")]) from error

"""Recorded states for ParaView: grains and rock as points, beam and contacts as lines, in VTK.

A file ``.pvd`` names the files ``.vtu`` of all instants, of each the parts ``grains``, ``beam`` and
``contacts``.
"""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ...core.errors import InputRefused, Problem
from ...core.results.reading import StoredRun
from ...metrics import contents
from ...metrics.cushion import cushions
from ...metrics.values import Samples

_POINT, _LINE, _CHAIN = 1, 3, 4
"""Kinds of cells in VTK: a vertex, a line, a line of several points."""

Vectors = tuple[Samples, Samples, Samples]
"""Components x, y, z of a vector at each point."""


def write_vtk(run: StoredRun, folder: Path) -> list[Path]:
    """Write the recorded states of all cushions.

    Parameters
    ----------
    run : StoredRun
        The run.
    folder : Path
        Of the files.

    Returns
    -------
    list of Path
        The collection of each cushion first.

    Raises
    ------
    InputRefused
        The library is missing, or the run has no states that can be read.
    """
    if find_spec("pyevtk") is None:
        remedy = 'install it: pip install "rockshed[vtk]"'
        raise InputRefused([Problem("format vtk", "needs the package pyevtk", remedy)])
    readable = [name for name in cushions(run) if contents.reader_of(run, name) is not None]
    if not any(next(run.states(name), None) for name in readable):
        what = "has no recorded states of sand"
        remedy = "record some: state_interval=0.0005 of a run"
        raise InputRefused([Problem(str(run.folder), what, remedy)])
    folder.mkdir(exist_ok=True)
    collections: list[Path] = []
    parts: list[Path] = []
    for name in readable:
        collection, files = _write_cushion(run, name, folder)
        collections.append(collection)
        parts += files
    return [*collections, *parts]


def _write_cushion(run: StoredRun, cushion: str, folder: Path) -> tuple[Path, list[Path]]:
    from pyevtk.vtk import VtkGroup

    collection = folder / f"{cushion}.pvd"
    group = VtkGroup(str(collection.with_suffix("")))
    files = []
    for number, (time, state) in enumerate(run.states(cushion)):
        shown = contents.decoded(run, cushion, state)
        stem = folder / f"{cushion}_{number:05d}"
        for part, file in _write_state(shown, stem):
            group.addFile(filepath=str(file), sim_time=time, part=part)
            files.append(file)
    group.save()
    return collection, files


def _write_state(state: Any, stem: Path) -> Iterator[tuple[str, Path]]:
    """Write the parts of a state; yield the number of each part, and its file."""
    bodies = [state.discs, state.rock]
    forces = _forces(state)
    x, y = _joined(bodies, "x"), _joined(bodies, "y")
    data = _point_data(bodies)
    data["force"] = _vectors(*(component[: x.size] for component in forces))
    data["is_rock"] = (np.arange(x.size) >= state.discs.x.size).astype(np.float64)
    yield "0", _write_grid(f"{stem}_grains", (x, y), _POINT, 1, pointData=data)
    beam = state.beam
    if beam.x.size > 1:
        place = beam.x, beam.y
        moving = _point_data([beam])
        yield "1", _write_grid(f"{stem}_beam", place, _CHAIN, beam.x.size, pointData=moving)
    contacts = state.contacts
    if contacts.x1.size:
        ends = (
            np.column_stack((contacts.x1, contacts.x2)).ravel(),
            np.column_stack((contacts.y1, contacts.y2)).ravel(),
        )
        cells = {
            "normal_force": np.ascontiguousarray(contacts.normal_force),
            "tangential_force": np.ascontiguousarray(contacts.tangential_force),
        }
        yield "2", _write_grid(f"{stem}_contacts", ends, _LINE, 2, cellData=cells)


def _write_grid(
    stem: str, place: tuple[Samples, Samples], kind: int, points_of_cell: int, **data: Any
) -> Path:
    """Write points in the plane and cells of consecutive ones; return the file."""
    from pyevtk.hl import unstructuredGridToVTK

    x, y = map(np.ascontiguousarray, place)
    connectivity = np.arange(x.size, dtype=np.int32)
    offsets = np.arange(points_of_cell, x.size + 1, points_of_cell, dtype=np.int32)
    kinds = np.full(offsets.size, kind, np.uint8)
    flat = np.zeros_like(x)
    return Path(
        unstructuredGridToVTK(
            stem,
            x,
            y,
            flat,
            connectivity=connectivity,
            offsets=offsets,
            cell_types=kinds,
            **data,
        )
    )


def _point_data(bodies: list[Any]) -> dict[str, Any]:
    """Return radii (m), angles (rad) and velocities (m/s) of discs."""
    return {
        "radius": _joined(bodies, "radius"),
        "angle": _joined(bodies, "angle"),
        "velocity": _vectors(_joined(bodies, "velocity_x"), _joined(bodies, "velocity_y")),
    }


def _joined(bodies: list[Any], name: str) -> Samples:
    return np.concatenate([getattr(discs, name) for discs in bodies])


def _vectors(x: Samples, y: Samples) -> Vectors:
    return np.ascontiguousarray(x), np.ascontiguousarray(y), np.zeros_like(x)


def _forces(state: Any) -> tuple[Samples, Samples]:
    """Return the sum (N) of the contact forces on each body, in x and in y.

    A contact pushes its first body away from the second; its tangential force turns the first body
    counter-clockwise. Bodies are numbered: discs, rock, beam, walls and base.
    """
    contacts = state.contacts
    along = np.array([contacts.x2 - contacts.x1, contacts.y2 - contacts.y1])
    along /= np.maximum(np.hypot(*along), np.finfo(float).tiny)
    across = np.array([-along[1], along[0]])
    on_first = contacts.tangential_force * across - contacts.normal_force * along
    last = max(int(side.max(initial=-1)) for side in (contacts.first, contacts.second))
    bodies = max(state.discs.x.size + 1 + state.beam.x.size, last + 1)
    sums = np.zeros((2, bodies))
    for axis in (0, 1):
        np.add.at(sums[axis], contacts.first, on_first[axis])
        np.add.at(sums[axis], contacts.second, -on_first[axis])
    return sums[0], sums[1]

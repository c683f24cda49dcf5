"""Recorded states of a cushion as numbers that a page can draw one after the other.

Places are whole numbers from 0 to 65535 over the range of the facts ``x`` and ``y`` (m), forces
from 0 to 255 over ``largest_force`` (N): the page stays small, and no eye sees the difference.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.roles import Role
from rockshed.components.common.units import cm, kN, ms

from ..core.results.reading import StoredRun
from ..metrics.energy import structures
from ..metrics.roles import column, elements, members
from ..pictures.sand import DEFLECTION_SCALES, Frame, frames
from ..tables import digits
from .form import Film

_FRAMES = 120
"""Frames of a film, at most; of more states, so many evenly spread ones."""
_FINEST = 65535
_SHOWN = 0.01
"""Contacts with less than this part of the largest force are left out."""


def film_of(run: StoredRun, cushion: str) -> Film | None:
    """Return the film of a cushion.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.

    Returns
    -------
    Film or None
        None if no state was recorded.

    Raises
    ------
    ForeignStateError
        Another version of the FMU has written the states.
    """
    times = [at for at, _ in run.states(cushion)]
    chosen = np.unique(np.linspace(0, len(times) - 1, min(len(times), _FRAMES)).round().astype(int))
    shown = frames(run, cushion, [times[i] for i in chosen])
    if not shown:
        return None
    ranges = _ranges(shown)
    largest = max(float(f.state.contacts.normal_force.max(initial=0.0)) for f in shown)
    arrays = {**_discs(shown, ranges), **_bodies(shown), **_contacts(shown, ranges, largest)}
    scale, axis = _axis(run, shown)
    facts = {
        "cushion": cushion,
        "frames": len(shown),
        "discs": int(shown[0].state.discs.x.size),
        "beam": int(shown[0].state.beam.x.size),
        "x": ranges["x"],
        "y": ranges["y"],
        "window": _window(shown),
        "box": _box(shown[0].state.box),
        "largest_force": largest,
        "deflection_scale": scale,
        "times": [frame.time / ms for frame in shown],
        "words": _words(run, cushion, shown),
    }
    return Film(cushion, facts, {**arrays, "axis": axis})


def _ranges(shown: Sequence[Frame]) -> dict[str, list[float]]:
    """Return the least and the largest coordinates (m) of discs and contacts."""
    found = {}
    for key in ("x", "y"):
        parts = [getattr(frame.state.discs, key) for frame in shown]
        for frame in shown:
            contacts = frame.state.contacts
            parts += [getattr(contacts, f"{key}1"), getattr(contacts, f"{key}2")]
        everything = np.concatenate([part[np.isfinite(part)] for part in parts])
        low = float(everything.min(initial=0.0))
        found[key] = [low, max(float(everything.max(initial=1.0)), low + 1e-9)]
    return found


def _whole(values: NDArray[np.float64], ends: Sequence[float], finest: int) -> NDArray[Any]:
    """Return numbers as whole ones from 0 to ``finest`` over a range."""
    share = (np.nan_to_num(values) - ends[0]) / (ends[1] - ends[0])
    return np.round(np.clip(share, 0.0, 1.0) * finest)


def _discs(shown: Sequence[Frame], ranges: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    x = np.concatenate([frame.state.discs.x for frame in shown])
    y = np.concatenate([frame.state.discs.y for frame in shown])
    return {
        "disc_radius": shown[0].state.discs.radius.astype("<f4"),
        "disc_x": _whole(x, ranges["x"], _FINEST).astype("<u2"),
        "disc_y": _whole(y, ranges["y"], _FINEST).astype("<u2"),
    }


def _bodies(shown: Sequence[Frame]) -> dict[str, NDArray[Any]]:
    """Return places of rock and beam discs (m), frame after frame."""
    found = {}
    for name in ("rock", "beam"):
        for key in ("x", "y", "angle"):
            values = [getattr(getattr(frame.state, name), key) for frame in shown]
            found[f"{name}_{key}"] = np.concatenate(values).astype("<f4")
        found[f"{name}_radius"] = getattr(shown[0].state, name).radius.astype("<f4")
    return found


def _contacts(
    shown: Sequence[Frame], ranges: Mapping[str, Any], largest: float
) -> dict[str, NDArray[Any]]:
    """Return ends and forces of the contacts, and where each frame begins.

    The strongest contact of a frame comes last.
    """
    parts: dict[str, list[NDArray[Any]]] = {"x1": [], "y1": [], "x2": [], "y2": [], "force": []}
    begins = [0]
    for frame in shown:
        contacts = frame.state.contacts
        order = np.argsort(contacts.normal_force)
        order = order[contacts.normal_force[order] > _SHOWN * largest]
        for key in ("x1", "y1", "x2", "y2"):
            parts[key].append(_whole(getattr(contacts, key)[order], ranges[key[0]], _FINEST))
        parts["force"].append(_whole(contacts.normal_force[order], [0.0, largest or 1.0], 255))
        begins.append(begins[-1] + order.size)
    kinds = {"force": "<u1"}
    joined = {
        f"contact_{key}": np.concatenate(values).astype(kinds.get(key, "<u2"))
        for key, values in parts.items()
    }
    return {**joined, "contact_begins": np.array(begins, "<u4")}


def _box(box: Any) -> dict[str, float | None]:
    """Return the box (m) as plain data; walls without end have no top."""
    return {
        "left": box.left,
        "right": box.left + box.width,
        "base": box.base,
        "top": box.wall_top if box.wall_top < 1e6 else None,
        "wall": box.wall_thickness,
    }


def _window(shown: Sequence[Frame]) -> list[float]:
    """Return left, right, bottom and top (m) of what all frames show.

    That is the box with its sand and what carries it, and of what lies above as much as it is wide.
    """
    box = shown[0].state.box
    margin = 0.06 * box.width
    radius = max(float(frame.state.beam.radius.max(initial=0.0)) for frame in shown)
    tops = [
        float((discs.y + discs.radius).max())
        for frame in shown
        for discs in (frame.state.rock, frame.state.discs)
    ]
    bottoms = [
        float((discs.y - discs.radius).min(initial=box.base))
        for frame in shown
        for discs in (frame.state.beam, frame.state.rock)
    ]
    lowest = max(min(bottoms), box.base - 1.2 * box.width)
    highest = min(max(tops), box.base + 1.2 * box.width)
    bottom = min(lowest, box.base - 2.2 * radius) - 0.3 * margin
    return [box.left - margin, box.left + box.width + margin, bottom, highest + 0.3 * margin]


def _axis(run: StoredRun, shown: Sequence[Frame]) -> tuple[float, NDArray[Any]]:
    """Return how many times too large deflections are drawn, and heights (m) of the beam's axis."""
    structure = next(iter(structures(run)), None)
    heights = [
        values
        for member in members(run, Role.STRUCTURE)
        if member.component == structure
        for values in elements(run, member.column)
    ]
    count = shown[0].state.beam.x.size
    if not heights or len(heights) != count:
        return 1.0, np.zeros(0, "<f4")
    rows = [_row(run, frame) for frame in shown]
    moved = np.array(heights)[:, rows].T - np.array(heights)[:, 0]
    diameter = 2.0 * float(shown[0].state.beam.radius.max(initial=0.0))
    most = float(np.abs(moved).max())
    fitting = (scale for scale in DEFLECTION_SCALES if scale * most <= diameter)
    scale = next(fitting, DEFLECTION_SCALES[-1])
    return scale, (np.array(heights)[:, 0] + scale * moved).ravel().astype("<f4")


def _row(run: StoredRun, frame: Frame) -> int:
    return int(abs(run.series["time"] - frame.time).argmin())


def _words(run: StoredRun, cushion: str, shown: Sequence[Frame]) -> list[str]:
    """Return depth of the rock and transmitted force at the time of each frame."""
    depth = column(run, cushion, Role.PENETRATION)
    force = column(run, cushion, Role.TRANSMITTED)
    texts = []
    for frame in shown:
        row = _row(run, frame)
        parts = []
        if depth is not None:
            at = float(run.series[depth][row])
            parts.append(f"rock {abs(at) / cm:.1f} cm {'deep' if at > 0.0 else 'above'}")
        if force is not None:
            parts.append(f"{digits(float(run.series[force][row]) / kN)} kN transmitted")
        texts.append(", ".join(parts))
    return texts

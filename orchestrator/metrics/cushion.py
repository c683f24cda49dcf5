"""Forces on both sides of a cushion, and the way that the striking body makes into it."""

from collections.abc import Iterator

from rockshed.components.common.roles import Role

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import contents, names
from .energy import driven
from .filtering import load_cell, low_pass
from .load_curve import DEPTH, LoadCurve, driven_curve
from .roles import column, owners, parameters, recorded
from .values import Samples, extreme, integral, least, of_each

SETTLING = 0.5
"""Cut-off of the settled forces, as a part of the natural frequency of a sand disc on one
contact."""
CONTACT_SHARE = 0.01
"""Part of its peak above which the force on the rock counts towards its duration."""


def cushions(run: StoredRun) -> list[str]:
    """Return the components that are cushions: those that transmit a force.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return owners(run, Role.TRANSMITTED)


def of_cushions(run: StoredRun) -> Iterator[Metric]:
    """Yield the metrics of each cushion.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return of_each(run, cushions(run), _of_cushion)


def _of_cushion(run: StoredRun, cushion: str) -> Iterator[Metric]:
    if driven(run):
        yield from _static(run, cushion)
    else:
        yield from _forces(run, cushion)
        yield from _through_load_cell(run, cushion)
        yield from _settled(run, cushion)
    yield from _way(run, cushion)


def both_forces(run: StoredRun, cushion: str) -> tuple[str, str] | None:
    """Return the columns of the transmitted force and of the force on the striking body.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.

    Returns
    -------
    tuple of str, or None
        None if one of them was not recorded.
    """
    transmitted = column(run, cushion, Role.TRANSMITTED)
    on_body = column(run, cushion, Role.ON_BODY)
    return (transmitted, on_body) if transmitted and on_body else None


def curve_of(run: StoredRun, cushion: str) -> LoadCurve | None:
    """Return the load on a driven body over its penetration; None if it was not recorded.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    """
    depth, load = column(run, cushion, Role.PENETRATION), column(run, cushion, Role.ON_BODY)
    return driven_curve(run.series[depth], run.series[load]) if depth and load else None


def _static(run: StoredRun, cushion: str) -> Iterator[Metric]:
    """Yield load and secant spring constant at 4 cm."""
    curve = curve_of(run, cushion)
    if curve is not None and curve.reaches(DEPTH):
        load = float(curve.at(DEPTH))
        yield Metric(names.STATIC_LOAD, load, "N")
        yield Metric(names.STATIC_STIFFNESS, load / DEPTH, "N/m")
        yield Metric(names.STATIC_DEPARTURE, curve.departure(DEPTH))


def _forces(run: StoredRun, cushion: str) -> Iterator[Metric]:
    """Yield peaks, impulses and duration."""
    columns = both_forces(run, cushion)
    if columns is None:
        return
    transmitted, on_body = columns
    peak, peak_at = extreme(run, transmitted)
    on_rock, on_rock_at = extreme(run, on_body)
    yield Metric(names.PEAK_TRANSMITTED, peak, "N")
    yield Metric(names.PEAK_TRANSMITTED_AT, peak_at, "s")
    yield Metric(names.PEAK_ROCK, on_rock, "N")
    yield Metric(names.PEAK_ROCK_AT, on_rock_at, "s")
    if on_rock > 0.0:
        yield Metric(names.RATIO, peak / on_rock)
    time, force = run.series["time"], run.series[on_body]
    yield Metric(names.IMPULSE_ROCK, integral(run, on_body), "N.s")
    at_rest = float(run.series[transmitted][0]) * float(time[-1] - time[0])
    yield Metric(names.IMPULSE_TRANSMITTED, integral(run, transmitted) - at_rest, "N.s")
    touching = time[force > CONTACT_SHARE * on_rock]
    if touching.size:
        yield Metric(names.DURATION, float(touching[-1] - touching[0]), "s")


def _through_load_cell(run: StoredRun, cushion: str) -> Iterator[Metric]:
    """Yield the peak through the load cell that the run was asked to have."""
    cut_off = run.provenance.get("load_cell")
    force = force_under_box(run, cushion)
    if cut_off and force is not None and run.series["time"].size > 1:
        shown = load_cell(run.series["time"], force, cut_off)
        yield Metric(names.PEAK_LOAD_CELL, float(shown.max()), "N")
        yield Metric(names.LOAD_CELL_CUT_OFF, cut_off, "1/s")


def force_under_box(run: StoredRun, cushion: str) -> Samples | None:
    """Return the force that passes from a cushion's box to the structure, downwards.

    It is the transmitted force without what accelerates the box that stands between them.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.

    Returns
    -------
    array of float, shape (rows,), or None
        In N; None if the transmitted force was not recorded. Boxes of several cushions cannot be
        told apart, and are left out.
    """
    transmitted = column(run, cushion, Role.TRANSMITTED)
    if transmitted is None:
        return None
    boxes = recorded(run, Role.BOX_INERTIA) if len(cushions(run)) == 1 else []
    return run.series[transmitted] - sum(run.series[box.column] for box in boxes)


def cut_off(run: StoredRun, cushion: str) -> float | None:
    """Return the cut-off frequency of the settled forces.

    Discs that meet, or are struck one by one, give spikes at the natural frequency of a disc: they
    come from the size of the discs, not from the impact, which lasts many times as long.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.

    Returns
    -------
    float or None
        In Hz; None for a cushion whose contacts are not known.
    """
    known = contents.measures(run, cushion)
    if known is None:
        return None
    return SETTLING * float(known.contact_frequency(parameters(run, cushion)))


def settled(run: StoredRun, cushion: str, name: str) -> Samples | None:
    """Return an output of a cushion without what is faster than its cut-off.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    name : str
        Column of the output.

    Returns
    -------
    array of float, shape (rows,), or None
        None where the rows cannot tell; see :func:`~rockshed.metrics.filtering.low_pass`.
    """
    fastest = cut_off(run, cushion)
    return None if fastest is None else low_pass(run.series["time"], run.series[name], fastest)


def _settled(run: StoredRun, cushion: str) -> Iterator[Metric]:
    """Yield the largest forces without their spikes."""
    columns, fastest = both_forces(run, cushion), cut_off(run, cushion)
    if columns is None or fastest is None:
        return
    curves = [settled(run, cushion, name) for name in columns]
    peaks = [float(curve.max()) for curve in curves if curve is not None]
    if len(peaks) < len(columns):
        return
    transmitted, rock = peaks
    yield Metric(names.SETTLED_TRANSMITTED, transmitted, "N")
    yield Metric(names.SETTLED_ROCK, rock, "N")
    if rock > 0.0:
        yield Metric(names.SETTLED_RATIO, transmitted / rock)
    yield Metric(names.SETTLED_CUT_OFF, fastest, "1/s")


def _way(run: StoredRun, cushion: str) -> Iterator[Metric]:
    """Yield penetration and the least distance of rock and base."""
    penetration = column(run, cushion, Role.PENETRATION)
    if penetration is None:
        return
    depth, _ = extreme(run, penetration)
    yield Metric(names.PENETRATION, depth, "m")
    clearance = column(run, cushion, Role.CLEARANCE)
    if clearance is not None:
        yield Metric(names.CLEARANCE, least(run, clearance), "m")
    thickness = thickness_at_start(run, cushion)
    if thickness and thickness > 0.0:
        yield Metric(names.PENETRATION_SHARE, depth / thickness)


def thickness_at_start(run: StoredRun, cushion: str) -> float | None:
    """Return the height of a cushion's surface over its base, where the body is at the start.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.

    Returns
    -------
    float or None
        In m, of the mean level of the surface: the depth to which the body may sink until it
        touches the base. None where it was not recorded.
    """
    above, clearance = (column(run, cushion, role) for role in (Role.ABOVE_SURFACE, Role.CLEARANCE))
    if above is None or clearance is None:
        return None
    return float(run.series[clearance][0] - run.series[above][0])


def still_in_contact(run: StoredRun) -> bool:
    """Return whether a force on a striking body has not ended with the run.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    bool
        Never of a driven body, whose force does not end as it does after an impact.
    """
    forces = [name for cushion in cushions(run) if (name := column(run, cushion, Role.ON_BODY))]
    return not driven(run) and any(
        bool(run.series[name][-1] > CONTACT_SHARE * extreme(run, name)[0]) for name in forces
    )


def still_sinking(run: StoredRun) -> bool:
    """Return whether a body had not come to a stop when the run ended.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    bool
        Of a driven body, whether it was not 4 cm deep.
    """
    if driven(run):
        return not any(
            metric.name == names.STATIC_STIFFNESS
            for cushion in cushions(run)
            for metric in _static(run, cushion)
        )
    depths = [
        run.series[name]
        for cushion in cushions(run)
        if (name := column(run, cushion, Role.PENETRATION))
    ]
    return any(
        depth.size == 0 or int(depth.argmax()) == depth.size - 1 or float(depth.max()) <= 0.0
        for depth in depths
    )

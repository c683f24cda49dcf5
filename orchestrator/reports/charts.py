"""Charts of a run: the curves of its pictures, to be moved through on a page."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.roles import Role
from rockshed.components.common.units import SCREEN_UNITS, cm, kN, ms

from ..core.results.reading import StoredRun
from ..metrics import names
from ..metrics.along import along
from ..metrics.comparison import known_of
from ..metrics.cushion import both_forces, curve_of, cushions, cut_off, settled, thickness_at_start
from ..metrics.energy import driven
from ..metrics.load_curve import DEPTH
from ..metrics.practice import with_handbook
from ..metrics.roles import column
from ..metrics.screen_units import screen_size, screen_unit
from ..pictures.declared import (
    DeclaredPanel,
    DeclaredPicture,
    curves_of,
    declared_pictures,
    known_in,
    label_of,
    loads_at_rest,
)
from ..pictures.energy import balance_error, expected, layers
from ..pictures.references import KnownMetrics, ReferenceLevel, levels
from ..pictures.style import GREY, INK, ROCK, TRANSMITTED
from .form import Chart, ChartCurve, CurveValues

_TIME = "time (ms)"
_DASHES = {"-": "solid", "--": "dash", ":": "dot", "-.": "dashdot"}


def charts_of(run: StoredRun) -> dict[str, list[Chart]]:
    """Return the charts of a run by the name of the picture that shows the same.

    Parameters
    ----------
    run : StoredRun
        With at least one row.

    Returns
    -------
    dict of str to list of Chart
        Without pictures of which there are no curves, as of grains.
    """
    known = known_of(run)
    found: dict[str, list[Chart]] = {}
    several = len(cushions(run)) > 1
    for cushion in cushions(run):
        for name, charts in _of_cushion(run, cushion, known).items():
            found[f"{name}_{cushion}" if several else name] = charts
    for picture in declared_pictures(run):
        found[picture.name] = list(_declared(run, picture, known))
    found["energy"] = list(_energy(run))
    return {name: charts for name, charts in found.items() if charts}


def _levels(run: StoredRun, found: Iterator[ReferenceLevel]) -> list[ChartCurve]:
    """Return horizontal lines over the whole time."""
    time = run.series["time"][[0, -1]] / ms
    return [
        ChartCurve(level.text, time, np.full(2, level.value), GREY, _DASHES[level.dashes])
        for level in found
    ]


def _of_cushion(run: StoredRun, cushion: str, known: KnownMetrics) -> dict[str, list[Chart]]:
    if driven(run):
        return {"load": list(_load(run, cushion, known))}
    return {
        "forces": list(_forces(run, cushion, known)),
        "penetration": list(_penetration(run, cushion, known)),
    }


def _forces(run: StoredRun, cushion: str, known: KnownMetrics) -> Iterator[Chart]:
    """Yield the forces on both sides of a cushion, as computed and settled."""
    time = run.series["time"] / ms
    words = (("transmitted to the base", TRANSMITTED), ("on the rock", ROCK))
    curves = []
    for (name, colour), force in zip(words, both_forces(run, cushion) or (), strict=False):
        curves.append(ChartCurve(name, time, run.series[force] / kN, colour))
        slow = settled(run, cushion, force)
        if slow is not None:
            text = f"{name}, settled: below {cut_off(run, cushion):.0f} Hz"
            curves.append(ChartCurve(text, time, slow / kN, colour, "dash"))
    if not curves:
        return
    for found, what in (
        (known.get(names.PEAK_TRANSMITTED), "peak transmitted force"),
        (with_handbook(run, known.get(names.SETTLED_ROCK)), "force on the rock"),
    ):
        curves += _levels(run, levels(found, "kN", what))
    yield Chart(_TIME, "force (kN)", curves)


def _penetration(run: StoredRun, cushion: str, known: KnownMetrics) -> Iterator[Chart]:
    """Yield the depth of the rock's lowest point, downwards."""
    depth = column(run, cushion, Role.PENETRATION)
    if depth is None:
        return
    time = run.series["time"] / ms
    curves = [ChartCurve("penetration", time, run.series[depth] / cm, ROCK)]
    thickness = thickness_at_start(run, cushion)
    if thickness is not None:
        base = iter([ReferenceLevel(thickness / cm, f"base, {thickness / cm:.1f} cm", "-")])
        curves += _levels(run, base)
    curves += _levels(run, levels(known.get(names.PENETRATION), "cm", "largest"))
    yield Chart(_TIME, "penetration (cm)", curves, downwards=True)


def _load(run: StoredRun, cushion: str, known: KnownMetrics) -> Iterator[Chart]:
    """Yield the load on a driven body over its penetration."""
    curve = curve_of(run, cushion)
    if curve is None:
        return
    mean = curve.at(curve.depth)
    curves = [
        ChartCurve("load", curve.depth / cm, curve.load / kN, "#d9b89b"),
        ChartCurve("mean over 0.5 mm", curve.depth / cm, mean / kN, ROCK),
    ]
    stiffnesses = {}
    if curve.reaches(DEPTH):
        stiffnesses["secant"] = (float(curve.at(DEPTH)) / DEPTH, INK, "solid")
    entry = known.get(names.STATIC_STIFFNESS)
    if entry is not None and entry.paper:
        stiffnesses["paper"] = (entry.paper.value, GREY, "dash")
    for who, (stiffness, colour, dash) in stiffnesses.items():
        ends = np.array([0.0, DEPTH])
        label = f"{who}, k = {stiffness / kN:.1f} kN/m"
        curves.append(ChartCurve(label, ends / cm, stiffness * ends / kN, colour, dash))
    yield Chart("penetration (cm)", "load (kN)", curves)


def _declared(run: StoredRun, picture: DeclaredPicture, known: KnownMetrics) -> Iterator[Chart]:
    """Yield a chart for each panel of a declared picture that has something to show."""
    for panel in picture.panels:
        owner = picture.owner(panel)
        recorded = any(f"{name}.{panel.needed}" in run.series for name in panel.components)
        if not recorded:
            continue
        if panel.is_envelope:
            yield _envelope(run, panel, owner)
        elif chart := _over_time(run, panel, owner, known):
            yield chart


def _over_time(
    run: StoredRun, panel: DeclaredPanel, owner: str, known: KnownMetrics
) -> Chart | None:
    time = run.series["time"] / ms
    curves = [
        ChartCurve(
            curve.label or str(panel.told["label"]),
            time,
            curve.values,
            curve.colour,
            "dash" if curve.dashed else "solid",
        )
        for curve in curves_of(run, panel)
    ]
    if not curves:
        return None
    for name, entry in known_in(panel, known).items():
        curves += _levels(run, levels(entry, panel.told["unit"], name))
    note = "; ".join(loads_at_rest(run, panel))
    downwards = bool(panel.told["downwards"])
    return Chart(_TIME, label_of(panel, owner), curves, downwards, note)


def _envelope(run: StoredRun, panel: DeclaredPanel, owner: str) -> Chart:
    """Return the largest and the least values along a component, and those of the peak."""
    places, values = along(run, panel.components[0], panel.told)
    values = values / SCREEN_UNITS[panel.told["unit"]]
    row = int(np.unravel_index(np.abs(values).argmax(), values.shape)[1])
    peak = f"at the time of the peak, {run.series['time'][row] / ms:.2f} ms"
    curves = [
        ChartCurve("largest", places, values.max(axis=1), TRANSMITTED),
        ChartCurve("least", places, values.min(axis=1), TRANSMITTED, "dash"),
        ChartCurve(peak, places, values[:, row], ROCK, markers=True),
    ]
    return Chart("x (m)", label_of(panel, owner), curves)


def _energy(run: StoredRun) -> Iterator[Chart]:
    """Yield the layers of energy, and the error of the balance."""
    time = run.series["time"] / ms
    found = list(layers(run))
    if not found:
        return
    size = screen_size("J", run)
    curves = [ChartCurve(e.label, time, e.values / size, e.colour, layer=True) for e in found]
    line = expected(run)
    curves.append(ChartCurve(_flat(line.label), time, line.values / size, line.colour, "dash"))
    yield Chart(_TIME, f"energy ({screen_unit('J', run)})", curves)
    error = balance_error(run)
    if error is not None:
        curve = ChartCurve("error of the balance", time, error.values, error.colour)
        yield Chart(_TIME, f"error ({_flat(error.label)})", [curve])


def _flat(text: str) -> str:
    return " ".join(text.split())


def thinned(curves: Sequence[ChartCurve], rows: int) -> list[ChartCurve]:
    """Return curves with at most so many points, the largest and the least kept.

    Parameters
    ----------
    curves : sequence of ChartCurve
        Of a chart.
    rows : int
        Points of a curve, at most; layers keep every so many-th row, since they lie on each other.

    Returns
    -------
    list of ChartCurve
        Those with fewer points are the same.
    """
    return [_thin(curve, rows) for curve in curves]


def _thin(curve: ChartCurve, rows: int) -> ChartCurve:
    size = curve.x.size
    if size <= rows:
        return curve
    if curve.layer:
        chosen = np.unique(np.linspace(0, size - 1, rows).round().astype(int))
    else:
        chosen = _extremes(curve.y, rows)
    return replace(curve, x=curve.x[chosen], y=curve.y[chosen])


def _extremes(values: CurveValues, rows: int) -> NDArray[np.intp]:
    """Return the places of the least and the largest value of each of ``rows`` / 2 parts."""
    places = [0, values.size - 1]
    for part in np.array_split(np.arange(values.size), max(rows // 2 - 1, 1)):
        places += [int(part[values[part].argmin()]), int(part[values[part].argmax()])]
    return np.unique(places)

"""Headline figures of an impact on a rock shed, or of a static test of its cushion, and what a case has to compare them with.

The figures follow from a run's results alone, whatever system it was: components are found by the model of their FMU, and a
figure whose component or column is missing is left out.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..core.results.metric import Metric
from ..references import Known as Known
from ..references import Reference as Reference

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..core.results.reading import Run

PEAK_TRANSMITTED = "peak transmitted force"
PEAK_TRANSMITTED_AT = "peak transmitted force at"
PEAK_ROCK = "peak force on the rock"
PEAK_ROCK_AT = "peak force on the rock at"
PEAK_LOAD_CELL = "peak transmitted force through the load cell"
LOAD_CELL_CUT_OFF = "cut-off frequency of the load cell"
RATIO = "peak transmitted force / peak force on the rock"
SETTLED_TRANSMITTED = "settled maximum of the transmitted force"
SETTLED_ROCK = "settled maximum of the force on the rock"
SETTLED_RATIO = "settled transmitted force / settled force on the rock"
SETTLED_CUT_OFF = "cut-off frequency of the settled forces"
PENETRATION = "penetration"
CLEARANCE = "least distance of rock and base"
DEFLECTION = "peak midspan deflection"
BEAM_ENERGY = "peak beam energy"
"""Largest elastic energy less that at the start, under dead load; the one from the strain counts the strain from the start."""
BEAM_ENERGY_FROM_STRAIN = "peak beam energy from the midspan strain"
BEAM_SHARE = "peak beam energy / impact energy"
BEAM_SHARE_FROM_STRAIN = "peak beam energy from the midspan strain / impact energy"
IMPULSE_ROCK = "impulse on the rock"
IMPULSE_TRANSMITTED = "transmitted impulse"
DURATION = "duration of the force on the rock"
IMPACT_ENERGY = "impact energy"
RESIDUAL = "largest energy residual of the system"
RESIDUAL_SHARE = "largest energy residual of the system / impact energy"
STATIC_LOAD = "load at 4 cm"
STATIC_STIFFNESS = "secant spring constant k"
STATIC_DEPARTURE = "departure of the load from the secant line / largest load"
MACHINE_WORK = "work of the machine"
RESIDUAL_WORK_SHARE = "largest energy residual of the system / work of the machine"

SETTLING = 0.5
"""Cut-off of the settled forces, as a part of the natural frequency of a sand disc on one contact."""
_ORDER = 4
"""Order of the low-pass filter; applied forwards and backwards."""

_LOAD_CELL_ORDER = 2
LOAD_CELL_ROWS = 5.0
"""Rows for each period of a load cell's cut-off that are needed at least."""

CONTACT_SHARE = 0.01
"""Part of its peak above which the force on the rock counts towards its duration."""


@dataclass(frozen=True)
class Roles:
    """Names of the components that play the parts of an impact; None where there is no such component, or several."""

    rock: str | None
    sand: str | None
    beam: str | None


def named(run: "Run", model: str) -> list[str]:
    """Names of the components of a model."""
    return [name for name, facts in run.provenance["components"].items() if facts["model"] == model]


def roles(run: "Run") -> Roles:
    """Who is who in a run, by the names of the models."""

    def only(model: str) -> str | None:
        names = named(run, model)
        return names[0] if len(names) == 1 else None

    return Roles(
        only("FallingRock") or only("SlopeRockfall"), only("SandCushion"), only("RBSMBeam")
    )


def driven(run: "Run") -> bool:
    """Whether the rock is driven by a machine: a static test, no impact."""
    rock = roles(run).rock
    return (
        rock is not None
        and run.provenance["components"][rock]["parameters"].get("motion", {}).get("value")
        == "driven"
    )


def extreme(run: "Run", column: str) -> tuple[float, float]:
    """Largest value of an output and its time (s): over all exchanges if the run watched it and has ended, else over the rows."""
    known = {metric.name: metric.value for metric in run.metrics.values()}
    if f"{column} maximum" in known:
        return float(known[f"{column} maximum"]), float(known[f"{column} maximum at"])
    at = int(run.series[column].argmax())
    return float(run.series[column][at]), float(run.series["time"][at])


_OUTSIDE = (".energy.work.drive", ".energy.work.gravity")
"""Works that come from outside of the system: of the machine, of the weight."""


def machine_work(run: "Run") -> "NDArray[np.float64] | None":
    """Work (J) of the machine on a driven rock since the start, at each row; None without one."""
    return run.series.get(f"{roles(run).rock}{_OUTSIDE[0]}") if driven(run) else None


def system_residual(run: "Run") -> "NDArray[np.float64] | None":
    """Energy (J) that the whole system has made since the start, at each row: what is stored and dissipated less what came in.

    A component's residual is the change of its energies less the work done on it. The works of both sides of an interface
    cancel but for what the coupling makes; with them the sum over all components is the balance of the system. The work of a
    machine and of a weight comes from outside and stays in the balance. The load that a rod carries at rest does work on its way
    down to the ground, which counts it as a potential; the rod leaves it out. None if a component gives no balance.
    """
    total = None
    for name in run.provenance["components"]:
        if f"{name}.energy.residual" not in run.series:
            return None
        works = [
            column
            for column in run.series
            if column.startswith(f"{name}.energy.work.") and not column.endswith(_OUTSIDE)
        ]
        for column in [f"{name}.energy.residual", *works]:
            part = run.series[column] - run.series[column][0]
            total = part if total is None else total + part
    carried = carried_work(run)
    return total if total is None or carried is None else total - carried


def carried_work(run: "Run") -> "NDArray[np.float64] | None":
    """Work (J) on the way of their heads of the loads that rods carry at rest, at each row, which no component counts; None without
    rods."""
    rods = [rod for rod in named(run, "PileRod") if f"{rod}.head.position" in run.series]
    works = [-preload(run, rod) * run.series[f"{rod}.head.position"] for rod in rods]
    return sum(works[1:], works[0]) if works else None


def preload(run: "Run", rod: str) -> float:
    """Static load (N) at the head of a rod, positive in the direction of its head."""
    parameters = run.provenance["components"][rod]["parameters"]
    return float(parameters["head.preload"]["value"]) * (
        -1.0 if parameters["head.direction"]["value"] == "up" else 1.0
    )


def impact_energy(run: "Run") -> float | None:
    """Kinetic energy (J) of the rock, or else of the hammers, at the start; of a rock from its slope, as it is handed over. None
    where a machine drives it."""
    rock = roles(run).rock
    received = run.series.get(f"{rock}.received")
    first = 0 if received is None else int(received.argmax())
    columns = [f"{name}.energy.kinetic" for name in ([rock] if rock else named(run, "Hammer"))]
    found = [float(run.series[column][first]) for column in columns if column in run.series]
    return sum(found) if found and not driven(run) else None


def beam_energies(run: "Run") -> tuple[float | None, float | None]:
    """Largest energy (J) that the impact has put into the beam: the springs' beyond that at the start, and by the strain."""
    beam = roles(run).beam
    elastic, by_strain = f"{beam}.energy.elastic", f"{beam}.energy.strain_estimate"
    return (
        extreme(run, elastic)[0] - float(run.series[elastic][0]) if elastic in run.series else None,
        extreme(run, by_strain)[0] if by_strain in run.series else None,
    )


def headlines(run: "Run") -> list[Metric]:
    """Every headline figure that the results give."""
    forces = _static(run) if driven(run) else [*_forces(run), *_load_cell(run), *_settled(run)]
    return [*forces, *_cushion(run), *_beam(run), *_piles(run), *_energy(run)]


def _static(run: "Run") -> Iterator[Metric]:
    """Load and secant spring constant at 4 cm."""
    from .load_curve import DEPTH, load_curve

    curve, work = load_curve(run.series, str(roles(run).sand)), machine_work(run)
    if curve is not None and curve.reaches(DEPTH):
        load = float(curve.at(DEPTH))
        yield Metric(STATIC_LOAD, load, "N")
        yield Metric(STATIC_STIFFNESS, load / DEPTH, "N/m")
        yield Metric(STATIC_DEPARTURE, curve.departure(DEPTH))
    if work is not None:
        yield Metric(MACHINE_WORK, float(work[-1]), "J")
        residual = system_residual(run)
        if residual is not None and work[-1]:
            yield Metric(RESIDUAL_WORK_SHARE, float(max(residual, key=abs)) / float(work[-1]))


def _forces(run: "Run") -> Iterator[Metric]:
    sand = roles(run).sand
    transmitted, rock = f"{sand}.transmitted_force", f"{sand}.rock.force.y"
    if transmitted not in run.series or rock not in run.series:
        return
    (peak, peak_at), (on_rock, on_rock_at) = extreme(run, transmitted), extreme(run, rock)
    yield Metric(PEAK_TRANSMITTED, peak, "N")
    yield Metric(PEAK_TRANSMITTED_AT, peak_at, "s")
    yield Metric(PEAK_ROCK, on_rock, "N")
    yield Metric(PEAK_ROCK_AT, on_rock_at, "s")
    if on_rock > 0.0:
        yield Metric(RATIO, peak / on_rock)
    time, force = run.series["time"], run.series[rock]
    yield Metric(IMPULSE_ROCK, integral(run, rock), "N.s")
    at_rest = float(run.series[transmitted][0]) * float(time[-1] - time[0])
    yield Metric(IMPULSE_TRANSMITTED, integral(run, transmitted) - at_rest, "N.s")
    touching = time[force > CONTACT_SHARE * on_rock]
    if touching.size:
        yield Metric(DURATION, float(touching[-1] - touching[0]), "s")


def cut_off(run: "Run") -> float:
    """Cut-off frequency (Hz) of the settled forces.

    Discs that meet, or are struck one by one, give spikes at the natural frequency of a disc, sqrt(k_n/m)/2 pi: they come from
    the size of the discs, not from the impact, which lasts many times as long.
    """
    sand = run.provenance["components"][roles(run).sand]["parameters"]
    factor, modulus, density, radius, solid = (
        float(sand[name]["value"])
        for name in ("stiffness_factor", "modulus", "unit_weight", "disc.radius", "solid_fraction")
    )
    if sand["unit_weight_of"]["value"] == "layer":
        density /= solid
    return SETTLING * math.sqrt(factor * modulus / (density * math.pi)) / radius / (2.0 * math.pi)


def load_cell(
    time: "NDArray[np.float64]", force: "NDArray[np.float64]", cut_off: float
) -> "NDArray[np.float64]":
    """What a load cell shows of a force (N) given at even times (s): a Butterworth low-pass of second order (scipy.signal), the
    response of an oscillator with the damping ratio 1/sqrt(2). It looks back only, so it lags; at the start it is steady.

    Raises:
        ValueError: there are fewer than :data:`LOAD_CELL_ROWS` rows for each period of ``cut_off`` (Hz).
    """
    from scipy.signal import butter, sosfilt, sosfilt_zi

    rate = (time.size - 1) / float(time[-1] - time[0])
    if cut_off * LOAD_CELL_ROWS > rate * (1.0 + 1e-9):
        raise ValueError(
            f"rows {1.0 / rate:.3g} s apart carry a cut-off of {rate / LOAD_CELL_ROWS:.4g} Hz, not {cut_off:g}"
        )
    sections = butter(_LOAD_CELL_ORDER, cut_off, fs=rate, output="sos")
    shown: NDArray[np.float64] = sosfilt(sections, force, zi=force[0] * sosfilt_zi(sections))[0]
    return shown


def _load_cell(run: "Run") -> Iterator[Metric]:
    """Peak through the load cell that the run was asked to have."""
    cut_off, column = run.provenance.get("load_cell"), f"{roles(run).sand}.transmitted_force"
    if cut_off and column in run.series and run.series["time"].size > 1:
        yield Metric(
            PEAK_LOAD_CELL,
            float(load_cell(run.series["time"], run.series[column], cut_off).max()),
            "N",
        )
        yield Metric(LOAD_CELL_CUT_OFF, cut_off, "1/s")


def settled(run: "Run", column: str) -> "NDArray[np.float64] | None":
    """An output of a run without what is faster than its cut-off: see :func:`low_pass`."""
    return low_pass(run.series["time"], run.series[column], cut_off(run))


def low_pass(
    time: "NDArray[np.float64]", values: "NDArray[np.float64]", cut_off: float
) -> "NDArray[np.float64] | None":
    """Values without what is faster than the cut-off (Hz): a Butterworth low-pass filter run forwards and backwards, so that
    nothing lags, which divides the spectrum by 1 + (f/cut_off)^(2 order). Beyond both ends the values are continued by their
    reflection.

    It works on the spectrum because every run shows it, and to import scipy.signal takes as long as a short run. None where the
    rows are too few or too far apart.
    """
    import numpy as np

    if time.size < 2:
        return None
    rate = (time.size - 1) / (time[-1] - time[0])
    if time.size * cut_off < rate or rate <= 2.0 * cut_off:
        return None
    even = np.linspace(time[0], time[-1], time.size)
    shown = np.interp(even, time, values)
    period = np.concatenate((shown, shown[-2:0:-1]))
    spectrum = np.fft.rfft(period) / (
        1.0 + (np.fft.rfftfreq(period.size, 1.0 / rate) / cut_off) ** (2 * _ORDER)
    )
    filtered = np.fft.irfft(spectrum, period.size)[: shown.size]
    return np.interp(time, even, filtered)


def _settled(run: "Run") -> Iterator[Metric]:
    columns = [f"{roles(run).sand}.{output}" for output in ("transmitted_force", "rock.force.y")]
    curves = [settled(run, column) for column in columns if column in run.series]
    if len(curves) < len(columns) or any(curve is None for curve in curves):
        return
    transmitted, rock = (float(curve.max()) for curve in curves if curve is not None)
    yield Metric(SETTLED_TRANSMITTED, transmitted, "N")
    yield Metric(SETTLED_ROCK, rock, "N")
    if rock > 0.0:
        yield Metric(SETTLED_RATIO, transmitted / rock)
    yield Metric(SETTLED_CUT_OFF, cut_off(run), "1/s")


def still_in_contact(run: "Run") -> bool:
    """Whether the force on the rock has not ended with the run, as it does after an impact."""
    column = f"{roles(run).sand}.rock.force.y"
    return (
        column in run.series
        and not driven(run)
        and bool(run.series[column][-1] > CONTACT_SHARE * extreme(run, column)[0])
    )


def still_sinking(run: "Run") -> bool:
    """Whether the rock had not come to a stop when the run ended; of a driven rock, whether it was not 4 cm deep."""
    if driven(run):
        return not any(figure.name == STATIC_STIFFNESS for figure in _static(run))
    depth = run.series.get(f"{roles(run).sand}.penetration")
    return depth is not None and (
        int(depth.argmax()) == depth.size - 1 or float(depth.max()) <= 0.0
    )


def integral(run: "Run", column: str) -> float:
    """Integral of an output over the time: over all exchanges if the run watched it and has ended, else over the rows."""
    known = next(
        (metric.value for metric in run.metrics.values() if metric.name == f"{column} integral"),
        None,
    )
    if known is not None:
        return float(known)
    values, time = run.series[column], run.series["time"]
    return float((0.5 * (values[1:] + values[:-1]) * (time[1:] - time[:-1])).sum())


def _cushion(run: "Run") -> Iterator[Metric]:
    sand = roles(run).sand
    if f"{sand}.penetration" not in run.series:
        return
    depth, _ = extreme(run, f"{sand}.penetration")
    yield Metric(PENETRATION, depth, "m")
    if sand and f"{sand}.surface_height" in run.series:
        yield Metric(
            CLEARANCE,
            float(run.series[f"{sand}.surface_height"][0]) - base_height(run) - depth,
            "m",
        )


def base_height(run: "Run") -> float:
    """Height (m) of what the sand rests on, at the start: the top of the beam's discs, or the floor."""
    sand, beam = (
        run.provenance["components"][name] if name else None
        for name in (roles(run).sand, roles(run).beam)
    )
    if sand is None or beam is None or sand["parameters"]["base"]["value"] == "floor":
        return float(sand["parameters"]["base.y"]["value"]) if sand else 0.0
    tops = [
        values[0]
        for name, values in run.series.items()
        if name.startswith(f"{roles(run).beam}.position.y[")
    ]
    return float(max(tops, default=0.0)) + float(sand["parameters"]["beam.radius"]["value"])


def _beam(run: "Run") -> Iterator[Metric]:
    column = f"{roles(run).beam}.midspan.deflection"
    if column in run.series:
        yield Metric(DEFLECTION, extreme(run, column)[0], "m")
    for name, energy in zip((BEAM_ENERGY, BEAM_ENERGY_FROM_STRAIN), beam_energies(run)):
        if energy is not None:
            yield Metric(name, energy, "J")


HEAD_FORCE, TOE_FORCE = "largest force at the head", "largest force at the toe"
COMPRESSION, TENSION = "largest compressive stress", "largest tensile stress"
TRANSFERRED, SETTLEMENT, SET = "transferred energy", "largest settlement", "permanent set"


def pile_figure(component: str, what: str) -> str:
    """Name of a figure of a rod or of the ground."""
    return f"{component}: {what}"


def _piles(run: "Run") -> Iterator[Metric]:
    """Rods and grounds, each under its own name."""
    series = run.series
    for rod in named(run, "PileRod"):
        for what, column in ((HEAD_FORCE, "head.contact_force"), (TOE_FORCE, "toe.contact_force")):
            if f"{rod}.{column}" in series:
                yield Metric(pile_figure(rod, what), extreme(run, f"{rod}.{column}")[0], "N")
        for what, column in ((COMPRESSION, "stress.compression"), (TENSION, "stress.tension")):
            values = [
                float(series[name][-1]) for name in series if name.startswith(f"{rod}.{column}[")
            ]
            if values:
                yield Metric(pile_figure(rod, what), max(values), "Pa")
        if f"{rod}.energy.transferred" in series:
            yield Metric(
                pile_figure(rod, TRANSFERRED), float(series[f"{rod}.energy.transferred"][-1]), "J"
            )
    for ground in named(run, "ImpulsiveGround"):
        if f"{ground}.settlement" in series:
            yield Metric(
                pile_figure(ground, SETTLEMENT), extreme(run, f"{ground}.settlement")[0], "m"
            )
        if f"{ground}.permanent_set" in series:
            yield Metric(
                pile_figure(ground, SET), float(series[f"{ground}.permanent_set"][-1]), "m"
            )


def _energy(run: "Run") -> Iterator[Metric]:
    impact, residual = impact_energy(run), system_residual(run)
    if impact is not None:
        yield Metric(IMPACT_ENERGY, impact, "J")
    if residual is not None:
        yield Metric(RESIDUAL, float(max(residual, key=abs)), "J")
    if impact:
        if residual is not None:
            yield Metric(RESIDUAL_SHARE, float(max(residual, key=abs)) / impact)
        for name, energy in zip((BEAM_SHARE, BEAM_SHARE_FROM_STRAIN), beam_energies(run)):
            if energy is not None:
                yield Metric(name, energy / impact)

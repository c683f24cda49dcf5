"""Energy of an impact, its balance over the whole system, and what of it reaches a structure."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from rockshed.components.common.roles import Role

from ..core.results.columns import WORK_OF_SCENARIO
from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .along import peak
from .roles import all_samples, column, owners, parameter, recorded
from .values import Samples, extreme, of_each


def driven(run: StoredRun) -> bool:
    """Return whether a machine moves a body: a static test, no impact.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    values = [parameter(run, owner, Role.DRIVEN) for owner in owners(run, Role.DRIVEN)]
    return any(value in ("driven", True) for value in values)


def machine_work(run: StoredRun) -> Samples | None:
    """Return the work of the machines on driven bodies since the start.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    array of float, shape (rows,), or None
        In J; None without a driven body.
    """
    works = [run.series[member.column] for member in recorded(run, Role.MACHINE_WORK)]
    return sum(works[1:], works[0]) if works and driven(run) else None


def system_residual(run: StoredRun) -> Samples | None:
    """Return the energy that the whole system has made since the start.

    That is what is stored and dissipated less what came in. A component's residual is the change of
    its energies less the work done on it. The works of both sides of an interface cancel but for
    what the coupling makes; with them the sum over all components is the balance of the system. The
    work of a machine and of a weight comes from outside and stays in the balance, and so does that
    of what a scenario imposes. The load that a rod carries at rest does work on its way down to the
    ground, which counts it as a potential; the rod leaves it out.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    array of float, shape (rows,), or None
        In J; None if a component gives no balance.
    """
    total = None
    for component in run.provenance["components"]:
        residual = column(run, component, Role.RESIDUAL)
        if residual is None:
            return None
        inside = [m.column for m in recorded(run, Role.WORK_INSIDE) if m.component == component]
        for name in [residual, *inside]:
            part = run.series[name] - run.series[name][0]
            total = part if total is None else total + part
    for outside in (carried_work(run), scenario_work(run)):
        total = total if total is None or outside is None else total - outside
    return total


def scenario_work(run: StoredRun) -> Samples | None:
    """Return the work of the forces and motions that a scenario imposes, since the start.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    array of float, shape (rows,), or None
        In J; None where it imposes none on a power port.
    """
    return run.series.get(WORK_OF_SCENARIO)


def carried_work(run: StoredRun) -> Samples | None:
    """Return the work of loads at rest that no component counts.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    array of float, shape (rows,), or None
        In J, on the way of the points that the loads act on; None where no component carries one.
    """
    works = [
        load_at_rest(run, member.component) * run.series[member.column]
        for member in recorded(run, Role.LOADED_POSITION)
    ]
    return sum(works[1:], works[0]) if works else None


def load_at_rest(run: StoredRun, component: str) -> float:
    """Return the load that a component carries at rest and leaves out of its balance.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.

    Returns
    -------
    float
        In N, in the direction in which the component counts force and way.
    """
    return float(parameter(run, component, Role.LOAD_AT_REST) or 0.0)


def impact_energy(run: StoredRun) -> float | None:
    """Return the kinetic energy of what strikes, at the start or when it is handed over.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    float or None
        In J; None where nothing strikes, a machine drives it, or there is no row.
    """
    striking = recorded(run, Role.STRIKING)
    if not striking or driven(run) or not run.time.size:
        return None
    return sum(float(run.series[m.column][_handed_over(run, m.component)]) for m in striking)


def _handed_over(run: StoredRun, component: str) -> int:
    """Return the row in which a body is handed over to the system; the first one if it is there."""
    received = column(run, component, Role.HANDED_OVER)
    return 0 if received is None else int(run.series[received].argmax())


def structures(run: StoredRun) -> list[str]:
    """Return the components that are structures: those with a deflection.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return owners(run, Role.DEFLECTION)


def of_structures(run: StoredRun) -> Iterator[Metric]:
    """Yield deflection, moment, reactions and energies of each structure.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return of_each(run, structures(run), _of_structure)


def _of_structure(run: StoredRun, structure: str) -> Iterator[Metric]:
    deflection = column(run, structure, Role.DEFLECTION)
    if deflection is not None:
        yield Metric(names.DEFLECTION, extreme(run, deflection)[0], "m")
    yield from _peak_moment(run, structure)
    yield from _peak_shear(run, structure)
    yield from _yielding(run, structure)
    yield from _reactions(run, structure)
    for name, energy in _structure_energies(run, structure):
        yield Metric(name, energy, "J")


def _peak_moment(run: StoredRun, structure: str) -> Iterator[Metric]:
    """Yield the bending moment farthest from zero, with its sign, its time and its place."""
    moments = all_samples(run, structure, Role.BENDING_MOMENT)
    if moments.size:
        place, row = np.unravel_index(np.abs(moments).argmax(), moments.shape)
        yield Metric(names.PEAK_MOMENT, float(moments[place, row]), "N.m")
        yield Metric(names.PEAK_MOMENT_AT, float(run.series["time"][row]), "s")
    found = peak(run, structure, Role.BENDING_MOMENT)
    if found:
        yield Metric(names.PEAK_MOMENT_PLACE, found.place, "m")


def _peak_shear(run: StoredRun, structure: str) -> Iterator[Metric]:
    """Yield the shear force farthest from zero, with its sign, its time and its place."""
    found = peak(run, structure, Role.SHEAR)
    if found:
        yield Metric(names.PEAK_SHEAR, found.value, "N")
        yield Metric(names.PEAK_SHEAR_AT, found.time, "s")
        yield Metric(names.PEAK_SHEAR_PLACE, found.place, "m")


def yields(run: StoredRun, structure: str) -> bool:
    """Return whether the section of a structure may yield.

    Parameters
    ----------
    run : StoredRun
        The run.
    structure : str
        Name of the component in the system.
    """
    ratio = column(run, structure, Role.CURVATURE_RATIO)
    return ratio is not None and bool(run.series[ratio].any())


def _yielding(run: StoredRun, structure: str) -> Iterator[Metric]:
    """Yield what stays of the deflection, plastic work and the largest curvature, if it yields."""
    if not yields(run, structure):
        return
    for name, role, unit in (
        (names.RESIDUAL_DEFLECTION, Role.RESIDUAL_DEFLECTION, "m"),
        (names.PLASTIC_WORK, Role.PLASTIC, "J"),
        (names.CURVATURE_RATIO, Role.CURVATURE_RATIO, "1"),
    ):
        found = column(run, structure, role)
        if found is not None:
            yield Metric(name, float(run.series[found][-1]), unit)


def _reactions(run: StoredRun, structure: str) -> Iterator[Metric]:
    """Yield the largest force of a support on the structure, upwards, and its time."""
    forces = all_samples(run, structure, Role.SUPPORT_FORCE)
    if forces.size:
        _, row = np.unravel_index(forces.argmin(), forces.shape)
        yield Metric(names.PEAK_REACTION, -float(forces.min()), "N")
        yield Metric(names.PEAK_REACTION_AT, float(run.series["time"][row]), "s")


def weightless(run: StoredRun) -> list[str]:
    """Return the structures whose moments and reactions leave out their own weight.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return [
        name
        for name in structures(run)
        if parameter(run, name, Role.GRAVITY) == 0.0
        and all_samples(run, name, Role.SUPPORT_FORCE).size
    ]


def _structure_energies(run: StoredRun, structure: str) -> Iterator[tuple[str, float]]:
    """Yield the largest energies (J) that the impact has put in, by the springs and by the strain.

    That of the springs counts beyond the start, under dead load. The strain tells the energy of a
    structure only as long as it is elastic.
    """
    elastic = column(run, structure, Role.ELASTIC)
    if elastic is not None:
        yield names.BEAM_ENERGY, extreme(run, elastic)[0] - float(run.series[elastic][0])
    estimated = column(run, structure, Role.ESTIMATED)
    if estimated is not None and not has_yielded(run, structure):
        yield names.BEAM_ENERGY_FROM_STRAIN, extreme(run, estimated)[0]


def has_yielded(run: StoredRun, structure: str) -> bool:
    """Tell whether anything has yielded in a structure.

    Parameters
    ----------
    run : StoredRun
        The run.
    structure : str
        Name of the component in the system.
    """
    plastic = column(run, structure, Role.PLASTIC)
    return plastic is not None and bool(run.series[plastic].any())


_SHARES = {
    names.BEAM_ENERGY: names.BEAM_SHARE,
    names.BEAM_ENERGY_FROM_STRAIN: names.BEAM_SHARE_FROM_STRAIN,
}


def of_system(run: StoredRun) -> Iterator[Metric]:
    """Yield impact energy, residual of the balance, and the shares of the impact energy.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    impact, residual = impact_energy(run), system_residual(run)
    if impact is not None:
        yield Metric(names.IMPACT_ENERGY, impact, "J")
    if residual is not None:
        yield Metric(names.RESIDUAL, largest(residual), "J")
    if not impact:
        return
    if residual is not None:
        yield Metric(names.RESIDUAL_SHARE, largest(residual) / impact)
    yield from of_each(run, structures(run), partial(_structure_shares, impact))


def _structure_shares(impact: float, run: StoredRun, structure: str) -> Iterator[Metric]:
    for name, energy in _structure_energies(run, structure):
        yield Metric(_SHARES[name], energy / impact)


def largest(values: Samples) -> float:
    """Return the value that is farthest from zero.

    Parameters
    ----------
    values : array of float, shape (rows,)
        In any unit.
    """
    return float(max(values, key=abs))

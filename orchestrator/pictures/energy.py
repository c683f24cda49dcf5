"""Balance of energy: where the energy of an impact is, and the error of the balance."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from rockshed.components.common.roles import Role
from rockshed.components.common.units import ms

from ..core.results.reading import StoredRun
from ..metrics.energy import (
    carried_work,
    impact_energy,
    machine_work,
    scenario_work,
    system_residual,
)
from ..metrics.roles import Member, recorded
from ..metrics.screen_units import screen_size, screen_unit
from .style import GREY, INK, WIDTH, figure, legend_beside, literal, over_time


@dataclass(frozen=True)
class _Family:
    """Energies of one role: words for those without a label, and colours of their layers."""

    role: Role
    words: str
    colours: tuple[str, ...]


_FAMILIES = (
    _Family(Role.STRIKING, "{component}, kinetic", ("#2f5d8a", "#55708c")),
    _Family(Role.KINETIC, "{component}, kinetic", ("#8fb3d4", "#3d7d3f", "#b7a6c9", "#a9b59a")),
    _Family(Role.GRAVITY_ENERGY, "gravity, above its least", ("#c9cfd4",)),
    _Family(Role.ELASTIC, "{component}, elastic", ("#7fae7a", "#a9c9a4", "#5f8f7a")),
    _Family(
        Role.DISSIPATED,
        "lost in {component}",
        ("#f2cf96", "#e3a857", "#d98e73", "#c0561a", "#8c2f12", "#5c3a2e", "#8a6d4b", "#3b2b52"),
    ),
)
"""Families from the bottom of the picture to its top; a role of two families belongs to the
first."""
_FROM_LEAST = (Role.GRAVITY_ENERGY, Role.LEFT_BEHIND)
"""Energies whose zero is arbitrary: they count from their least value, so that they stack."""
_SHOWN = 1e-4
"""A layer is left out if it never reaches this part of the sum."""


@dataclass(frozen=True)
class Layer:
    """A layer of the balance, or a line over it.

    Attributes
    ----------
    label : str
        Its name in the legend.
    colour : str
        Its colour.
    values : array of float, shape (rows,)
        Energy (J).
    """

    label: str
    colour: str
    values: NDArray[np.float64]


def energy(run: StoredRun, file: Path) -> None:
    """Draw the layers of energy, and the error of the balance.

    Parameters
    ----------
    run : StoredRun
        The run.
    file : Path
        File of the picture.
    """
    with figure(run, file, WIDTH, 5.2) as made:
        upper, lower = made.subplots(2, sharex=True, height_ratios=(3.5, 1))
        _stack(run, upper)
        _error(run, lower)
        lower.set_xlabel("time (ms)")


def _stack(run: StoredRun, axes: Axes) -> None:
    """Draw the layers, and the energy that there should be."""
    time = run.series["time"] / ms
    shown = list(layers(run))
    size = screen_size("J", run)
    if shown:  # no part may have any energy
        axes.stackplot(
            time,
            [layer.values / size for layer in shown],
            colors=[layer.colour for layer in shown],
            labels=[layer.label for layer in shown],
            edgecolor="white",
            linewidth=0.3,
        )
    there_should_be = expected(run)
    axes.plot(
        time,
        there_should_be.values / size,
        color=INK,
        linewidth=0.9,
        linestyle="--",
        label=there_should_be.label,
    )
    axes.set(ylabel=f"energy ({screen_unit('J', run)})")
    over_time(axes, time)
    legend_beside(axes)


def _error(run: StoredRun, axes: Axes) -> None:
    """Draw the error of the balance."""
    found = balance_error(run)
    if found is not None:
        axes.plot(run.series["time"] / ms, found.values, color=INK, linewidth=1.0)
        axes.set_ylabel(f"error\n({found.label})")
    axes.axhline(0.0, color=GREY, linewidth=0.7)


def expected(run: StoredRun) -> Layer:
    """Return the energy that the layers should add up to.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    Layer
        A line over all layers: their sum at the start, and what comes from outside.
    """
    start = sum(float(layer.values[0]) for layer in layers(run))
    works = {
        "work of the machine": machine_work(run),
        "work of the loads at rest": carried_work(run),
        "work of the scenario": scenario_work(run),
    }
    added = {words: work for words, work in works.items() if work is not None and work.any()}
    whole = np.full(run.series["time"].size, start) + sum(added.values())
    return Layer(" and ".join(["all energy at the start", *added]), INK, whole)


def balance_error(run: StoredRun) -> Layer | None:
    """Return the error of the balance.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    Layer or None
        In percent of the impact energy, or of the work of a machine, as its label tells; None if a
        component gives no balance.
    """
    residual, machine = system_residual(run), machine_work(run)
    whole = impact_energy(run)
    label = "% of the\nimpact energy"
    if machine is not None:
        whole = float(abs(machine[-1]))
        label = "% of the\nmachine's work"
    if residual is None or not whole:
        return None
    return Layer(label, INK, 100.0 * residual / whole)


def layers(run: StoredRun) -> Iterator[Layer]:
    """Yield the layers of the balance; energies of one label are one layer.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    made: list[Layer] = []
    taken: set[str] = set()
    for family in _FAMILIES:
        colours = cycle(family.colours)
        for label in _labels(run, family):
            if label not in taken:
                taken.add(label)
                made.append(Layer(label, next(colours), _sum(run, label)))
    total = max((float(layer.values.max()) for layer in made), default=0.0)
    yield from (layer for layer in made if layer.values.max() > _SHOWN * total)


def _labels(run: StoredRun, family: _Family) -> list[str]:
    return list(dict.fromkeys(_label(member) for member in recorded(run, family.role)))


def _label(member: Member) -> str:
    """Return the label of an energy, or words for it."""
    words = next(family.words for family in _FAMILIES if family.role.includes(member.role))
    return member.label or words.format(component=literal(member.component))


def _sum(run: StoredRun, label: str) -> NDArray[np.float64]:
    """Return the sum (J) of all energies with a label."""
    unique = {m.column: m for family in _FAMILIES for m in recorded(run, family.role)}
    parts = [
        _stackable(run.series[m.column], m.role) for m in unique.values() if _label(m) == label
    ]
    return np.asarray(np.sum(parts, axis=0), np.float64)


def _stackable(values: NDArray[np.float64], role: Role) -> NDArray[np.float64]:
    """Return an energy that is never negative."""
    least = float(values.min())
    return values - (least if role in _FROM_LEAST else min(least, 0.0))

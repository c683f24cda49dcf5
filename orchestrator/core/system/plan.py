"""A system ready to run: names replaced by places, times by ticks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..fmu.description import Description, Port
from .schedule import Schedule
from .system import SystemSpec
from .timing import Timing

Starts = Mapping[str, list[tuple[Port, float | str]]]
"""Ports of each component that are set before the initialisation, and their values."""


class End(NamedTuple):
    """A port of a component."""

    component: str
    port: Port

    @property
    def name(self) -> str:
        """``component.port``, the name in the results."""
        return f"{self.component}.{self.port.name}"


@dataclass(frozen=True)
class BondPlaces:
    """A power bond by places on the buses, one channel for each force.

    Attributes
    ----------
    name : str
        Of the bond in the system.
    given, seen : array of int, shape (channels,)
        Places among the inputs: the force that is set in the taker, the position that is shown to
        the giver. Without a connection that shows it, ``seen`` is -1, and ``work`` is there.
    force, position : array of int, shape (channels,)
        Places among the outputs: the force that the giver computes, the position of the taker.
    work : End or None
        Output of the giver that counts the energy brought into it (J).
    sign : float
        -1 where force and position count in opposite directions, else 1.
    """

    name: str
    given: NDArray[np.int64]
    seen: NDArray[np.int64]
    force: NDArray[np.int64]
    position: NDArray[np.int64]
    work: End | None
    sign: float = 1.0


@dataclass(frozen=True)
class Plan:
    """A system ready to run.

    Attributes
    ----------
    system : SystemSpec
        As it was checked.
    order : tuple of str
        Components in the order of their turns.
    descriptions : mapping of str to Description
        Of the components' FMUs.
    timing : Timing
        Times in ticks.
    schedule : Schedule
        Order of exchanges and steps.
    starts : Starts
        Values that are set before the initialisation.
    inputs, outputs : tuple of End
        Ports that take part in the exchange, in the order of the two buses: by component, kind,
        reference.
    source : array of int, shape (inputs,)
        Place among the outputs that feeds each input.
    bonds : tuple of BondPlaces
        Power bonds.
    recorded : tuple of End
        Columns of the results.
    watched : array of int
        Places among the outputs.
    reference : float, End or None
        Energy E0 (J) that the ledger compares with; None where it is to find one.
    balances : tuple of End
        Outputs that give the error of a component's own balance of energy.
    kinetic : tuple of End
        Outputs that give a kinetic energy.
    warnings : tuple of str
        For the user.
    linear : mapping of int to (float, float)
        Factor and offset of the inputs, by place, that get other values than their sources have.
    """

    system: SystemSpec
    order: tuple[str, ...]
    descriptions: Mapping[str, Description]
    timing: Timing
    schedule: Schedule
    starts: Starts
    inputs: tuple[End, ...]
    outputs: tuple[End, ...]
    source: NDArray[np.int64]
    bonds: tuple[BondPlaces, ...]
    recorded: tuple[End, ...]
    watched: NDArray[np.int64]
    reference: float | End | None
    balances: tuple[End, ...]
    kinetic: tuple[End, ...]
    warnings: tuple[str, ...] = ()
    linear: Mapping[int, tuple[float, float]] = field(default_factory=dict)

    def tolerance(self, component: str) -> float | None:
        """Return the relative tolerance that the solver of a component is told.

        Parameters
        ----------
        component : str
            Its own value comes before that of the system and the one that its FMU proposes.

        Returns
        -------
        float or None
            None where nobody gives one.
        """
        own = self.system.components[component].tolerance
        return own or self.system.tolerance or self.descriptions[component].tolerance

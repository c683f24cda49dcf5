"""An impact system as data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.component import Component

from ..core.system.iteration import InputMoment
from ..core.system.system import SystemSpec

NumberArray = NDArray[np.float64]
ExchangeOrder = Literal["sequential", "jacobi", "implicit"]
"""In which order a system exchanges."""


@dataclass(frozen=True)
class FmuPart:
    """A component and its sizes, of which an FMU of a system is built.

    Attributes
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        Sizes that differ from its defaults.
    """

    component: Component
    sizes: Mapping[str, int] = field(default_factory=dict)


FmuPaths = Mapping[str, str]
"""FmuPaths of FMUs by the component of the system."""


@dataclass(frozen=True)
class ImpactSystem:
    """A coupled problem of impact, and its solution.

    Attributes
    ----------
    name : str
        Identifier, with hyphens.
    title : str
        One line.
    folder : Path
        Where ``README.md`` derives the truth.
    parts : mapping of str to FmuPart
        By the component of the system.
    make : callable
        Returns the system for files, an exchange step (s) and a master.
    quantity : str
        Output, ``component.port``, that is compared with the truth.
    unit : str
        Its unit.
    truth : callable
        Returns the true values at times (s).
    stop_time : float
        End of the run (s).
    steps : tuple of float
        Exchange steps (s), coarsest first, each a multiple of the next ones.
    step : float
        The one of them at which :attr:`tolerance` is stated (s).
    tolerance : float
        Largest error that a correct master makes there, as a part of the largest true value.
    energies : tuple of str
        Outputs (J) whose sum a true coupling does not change from start to end; empty where the
        system has no such sum.
    impact_energy : float
        Energy (J) that energy which was made is told as a part of.
    start_energy : float
        The sum of :attr:`energies` at the start (J).
    finer : mapping of str to int
        How many steps a component makes in an exchange; 1 for all others.
    moments : mapping of str to str
        Moment of whose values inputs of the implicit master are, by ``component.port`` with ``*``
        for any text; the end for all others. The page derives them.
    """

    name: str
    title: str
    folder: Path
    parts: Mapping[str, FmuPart]
    make: Callable[[FmuPaths, float, ExchangeOrder], SystemSpec]
    quantity: str
    unit: str
    truth: Callable[[NumberArray], NumberArray]
    stop_time: float
    steps: tuple[float, ...]
    step: float
    tolerance: float
    energies: tuple[str, ...] = ()
    impact_energy: float = 1.0
    start_energy: float = 0.0
    finer: Mapping[str, int] = field(default_factory=dict)
    moments: Mapping[str, InputMoment] = field(default_factory=dict)

    @property
    def page(self) -> str:
        """Page that derives the truth (Markdown), without what is declared here."""
        return (self.folder / "README.md").read_text(encoding="utf-8")

    @cached_property
    def scale(self) -> float:
        """Largest true value, in :attr:`unit`."""
        return float(np.abs(self.truth(self.times(self.steps[-1]))).max())

    def times(self, step: float) -> NumberArray:
        """Return the times of all exchanges (s), the start and the end among them."""
        times: NumberArray = np.arange(round(self.stop_time / step) + 1, dtype=np.float64) * step
        return times

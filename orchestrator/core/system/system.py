"""A system as data: its parts, and how it is run.

A system is read from a TOML file or built in Python; both are checked for their form
(:mod:`rockshed.core.system.reading`), and against the FMUs
(:mod:`rockshed.core.system.planning`).
"""

from typing import Literal

from pydantic import Field

from .adaptivity import Adaptive
from .fields import ComponentName, Extrapolation, Name, Seconds, SystemData, Time, Tolerance
from .iteration import Iteration
from .parts import ComponentSpec, Connection, EnergyAlarm, PowerBond, SharedValue
from .scenario import Scenario

ALL = "all"
"""Stands for all components."""

TIME_LIMIT = 600.0
"""Longest time (s) of one call of an isolated FMU, where nothing else is said."""


class SystemSpec(SystemData):
    """A co-simulation: what takes part, how it is connected and how it is run.

    Attributes
    ----------
    components : dict of str to ComponentSpec
        Subsystems.
    connections : list of Connection
        Outputs that feed inputs.
    shared : dict of str to SharedValue
        Values that several parameters take.
    bonds : dict of str to PowerBond
        Interfaces whose energy is accounted for.
    energy_alarm : EnergyAlarm
        Limit of the energy that couplings and components make; a warning beyond it.
    master : str
        ``sequential`` (in ``order``, each component takes the newest values), ``jacobi`` (all
        take the values of the beginning of the exchange), or ``implicit`` (each exchange is
        repeated until all values fit together).
    iteration : Iteration
        How the implicit master repeats it.
    order : list of str
        Every component once; without it, as they are listed.
    start_time, stop_time, exchange_step : float
        Times (s). Any time may be a text: with a unit, ``"20 ms"``, or a fraction, ``"1/60"``.
    output_interval : float, optional
        Time between two rows of the results (s); without it, the exchange step.
    state_interval : float, optional
        Time between two recorded states (s) of the components with ``record_states``.
    record : list of str
        Variables in the results, ``component.port``; ``*`` stands for any text, and then selects
        outputs. Default: all outputs.
    watch : list of str
        Outputs whose extremes and integral over all exchanges go into the summary, in the same
        notation.
    tolerance : float, optional
        Relative tolerance of the solvers in FMUs; without it, the one that each FMU proposes.
    extrapolation : int
        Order of the polynomials that inputs follow, of components that have none of their own.
    adaptive : Adaptive, optional
        The exchange step becomes longer where the error allows it.
    isolate : list of str
        Components whose FMUs run in processes of their own, besides those that say so themselves;
        ``all`` stands for all.
    time_limit : float
        Longest time (s) of one call of an isolated FMU; then it is ended.
    scenario : Scenario
        Inputs over time, values that change, and faults of connections.
    """

    name: str
    description: str = ""
    components: dict[ComponentName, ComponentSpec] = Field(min_length=1)
    connections: list[Connection] = []
    shared: dict[Name, SharedValue] = {}
    bonds: dict[Name, PowerBond] = {}
    energy_alarm: EnergyAlarm = EnergyAlarm()
    master: Literal["sequential", "jacobi", "implicit"] = "sequential"
    iteration: Iteration = Iteration()
    order: list[str] = []
    start_time: Time = 0.0
    stop_time: Time
    exchange_step: Seconds
    output_interval: Seconds | None = None
    state_interval: Seconds | None = None
    record: list[str] = ["*"]
    watch: list[str] = []
    tolerance: Tolerance | None = None
    extrapolation: Extrapolation = 0
    adaptive: Adaptive | None = None
    isolate: list[str] = []
    time_limit: Seconds = TIME_LIMIT
    scenario: Scenario = Scenario()

    def step(self, component: str) -> float:
        """Return the communication step of a component (s)."""
        return self.components[component].step or self.exchange_step

    def longest_step(self, component: str) -> float:
        """Return the longest communication step (s) that a component may be asked for."""
        longest = self.adaptive.largest_step if self.adaptive else self.exchange_step
        return self.components[component].step or max(longest, self.exchange_step)

    @property
    def isolated(self) -> dict[str, float]:
        """Return the longest time (s) of a call of each component with a process of its own."""
        return {
            name: spec.time_limit or self.time_limit
            for name, spec in self.components.items()
            if spec.isolate or name in self.isolate or ALL in self.isolate
        }

    @property
    def limits_calls(self) -> bool:
        """Whether anything limits the time of a call otherwise than by default."""
        own = any(spec.time_limit for spec in self.components.values())
        return own or self.time_limit != TIME_LIMIT

"""A system as data: components, connections, shared values, power bonds, and how it is run.

A system is read from a TOML file or built in Python; both are checked for their form here, and
against the FMUs in :mod:`rockshed.core.system.planning`.
"""

from collections.abc import Collection, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_serializer,
    model_validator,
)

from ..errors import InputRefused, Problem, counted
from ..form_faults import UNKNOWN_KEY, sentences
from ..input_text import read_text, toml_content
from .clock import seconds_in
from .iteration import IteratedConnection, Iteration
from .names import matches, nearest, split_name

Value = bool | int | float | str
"""Value of a parameter or input; of an enumeration, the name or the number of an item."""


def plain_value(value: Any) -> Any:
    """Return a number of numpy as one of Python; refuse a list.

    Parameters
    ----------
    value : Any
        Value for a parameter or input.

    Returns
    -------
    Any
        The value; its type is not checked.

    Raises
    ------
    ValueError
        It is a list, an array or a mapping.
    """
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, list | tuple | dict | np.ndarray):
        raise ValueError(ONE_VALUE)
    return value


ONE_VALUE = (
    "takes one number, true or false, or a word; give array elements one by one as name[1], "
    "name[2], ..., or all the same value as name[*]"
)
"""Why a list is refused as a value."""

_PlainValue = Annotated[Value, BeforeValidator(plain_value)]


def _from_fraction(value: Any) -> Any:
    """Return a fraction of a second, ``1/60``, as the nearest float; anything else as it is."""
    if isinstance(value, Fraction) or (isinstance(value, str) and "/" in value):
        return seconds_in(str(value))
    return value


Time = Annotated[float, BeforeValidator(_from_fraction), Field(allow_inf_nan=False)]
Seconds = Annotated[float, BeforeValidator(_from_fraction), Field(gt=0.0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Tolerance = Annotated[float, Field(gt=0.0, lt=1.0, allow_inf_nan=False)]
Extrapolation = Literal[0, 1, 2]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
_DottedName = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$")]
"""Name of a component, ``rock``, also of one inside a system of an SSP, ``shed.rock``."""

ALL = "all"
"""Stands for all components."""
RESERVED = ("time", "coupling")
"""Names that a component cannot have: columns of the results begin with them."""


def _not_reserved(name: str) -> str:
    if name.partition(".")[0] in RESERVED:
        raise ValueError(
            f"a component cannot be called {name}: columns of the results are; choose another name"
        )
    return name


ComponentName = Annotated[_DottedName, AfterValidator(_not_reserved)]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class ComponentSpec(_Data):
    """A subsystem: an FMU and how it takes part.

    Attributes
    ----------
    fmu : str
        Path of the file; in a TOML file, relative to the folder of that file.
    step : float, optional
        Communication step (s); without it, the exchange step.
    parameters : dict
        Values of parameters and of unconnected inputs that differ from the FMU's start values, and
        of outputs and local variables that begin with a start value (``initial`` exact or approx).
        ``name[*]`` sets a whole array.
    record_states : bool
        Keep serialized states every ``state_interval``.
    tolerance : float, optional
        Relative tolerance of the FMU's solver; without it, that of the system.
    extrapolation : int, optional
        Order, 0 to 2, of the polynomial through their newest values that its real inputs follow; in
        each step, an input has the mean of that. 0 holds them. Without it, that of the system.
    isolate : bool
        Run the FMU in a process of its own.
    time_limit : float, optional
        Longest time (s) of one call of an isolated FMU; without it, that of the system.
    """

    fmu: str
    step: Seconds | None = None
    parameters: dict[str, _PlainValue] = {}
    record_states: bool = False
    tolerance: Tolerance | None = None
    extrapolation: Extrapolation | None = None
    isolate: bool = False
    time_limit: Seconds | None = None


class Connection(_Data):
    """An output that feeds an input, both written ``component.port``.

    In TOML: ``"sand.rock.force.x -> rock.force.x"``, or a table with ``source``, ``target`` and
    what is else. The name of an array, or ``[*]`` behind it, stands for all its elements,
    ``[1..24]`` for some; source and target then need the same number of them.

    ``"sand.rock <-> rock.rock"`` connects two terminals: all variables that they have in common,
    each in its direction.

    Attributes
    ----------
    source, target : str
        Output and input, or two terminals.
    factor, offset : float
        The input gets ``factor`` times the output plus ``offset``. Where one of them is given, both
        ports are real, and their units are not compared: the numbers stand for what is between
        them, and a factor of 1 says that they are the same.
    terminals : bool
        Whether two terminals are connected, in both directions.
    """

    source: str
    target: str
    factor: Finite | None = None
    offset: Finite | None = None
    terminals: bool = False

    def __str__(self) -> str:
        return f"{self.source} {'<->' if self.terminals else '->'} {self.target}"

    @property
    def is_linear(self) -> bool:
        """Whether it says how the value changes on its way."""
        return self.factor is not None or self.offset is not None

    @property
    def way(self) -> tuple[float, float]:
        """Factor and offset of the value; 1 and 0 where it stays as it is."""
        return 1.0 if self.factor is None else self.factor, self.offset or 0.0

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, data: Any) -> Any:
        if not isinstance(data, str):
            return data
        terminals = "<->" in data
        parts = [part.strip() for part in data.split("<->" if terminals else "->")]
        if len(parts) != 2 or not all(parts):
            raise ValueError(
                f'{data!r} is no connection; write "component.output -> component.input", or '
                '"component.terminal <-> component.terminal"'
            )
        return {"source": parts[0], "target": parts[1], "terminals": terminals}

    @model_validator(mode="after")
    def _is_one_or_the_other(self) -> "Connection":
        if self.terminals and self.is_linear:
            raise ValueError(
                "connects terminals, and has a factor or an offset; connect their variables"
            )
        return self


class SharedValue(_Data):
    """One value that several parameters take: the radius of the rock, for instance.

    Targets are ``component.parameter``.
    """

    value: _PlainValue
    targets: list[str] = Field(min_length=1)


class PowerBond(_Data):
    """An interface through which energy flows.

    The giver computes forces, the taker moves under them.

    Attributes
    ----------
    giver, taker : str
        Components.
    force : list of str
        Outputs of ``giver``, force or torque on the taker.
    position : list of str
        Outputs of ``taker``, one for each force, of the point and direction (or angle) in which
        it acts.
    work : str, optional
        Output of ``giver`` that counts the energy which this interface brings into it. Without
        it, the ledger takes the force that the giver computed times the displacement that it was
        shown.
    opposed : bool
        Force and position count in opposite directions, as the compression at a toe and its way
        downwards do.
    """

    giver: str
    force: list[str] = Field(min_length=1)
    taker: str
    position: list[str] = Field(min_length=1)
    work: str | None = None
    opposed: bool = False


class EnergyAlarm(_Data):
    """Warn when a coupling or a component made or lost more energy than ``share`` of E0.

    Attributes
    ----------
    share : float
        Largest share that is no alarm.
    reference : float or str, optional
        E0: an energy (J), or the output ``component.port`` whose value at the start is taken.
        Without it, the kinetic energy at the start, or the largest work that an interface has done
        until the end, whichever is more.
    """

    share: float = Field(default=0.01, gt=0.0, allow_inf_nan=False)
    reference: str | Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None


class ValueSet(_Data):
    """A value that a port takes during the run, at a time or on a condition.

    Attributes
    ----------
    port : str
        ``component.port``: an input that nothing feeds, or a tunable parameter.
    value : bool, int, float or str
        In the unit of the port; the name of an item of an enumeration.
    at : float, optional
        Time (s) of an exchange, from which on the value holds.
    when : str, optional
        ``"rock.position.y < 1.0"``: an output, ``<``, ``<=``, ``>`` or ``>=``, and a number in its
        unit. The value holds from the first exchange on at which it is true.
    """

    port: str
    value: _PlainValue
    at: Time | None = None
    when: str | None = None

    @model_validator(mode="after")
    def _has_one_moment(self) -> "ValueSet":
        if (self.at is None) == (self.when is None):
            raise ValueError("needs either at (s) or when (a condition), and not both")
        return self


class ConnectionFault(_Data):
    """A fault of a connection: what it delivers in the place of its source's value.

    It acts at exchanges, from that at ``from`` until before that at ``to``.

    Attributes
    ----------
    port : str
        ``component.input``, which a connection feeds; an array shorthand for several.
    kind : str
        ``frozen``: the value that the source had at ``from``; ``cut``: the input's start value, 0
        where it has none; ``noise``: the value plus normally distributed noise.
    begin, end : float
        ``from`` and ``to`` in a file: times (s) of exchanges; without ``to``, until the end.
    deviation : float, optional
        Standard deviation of the noise, in the unit of the input.
    seed : int
        Of the noise, whose values follow from seed, input and exchange alone.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True, defer_build=True)

    port: str
    kind: Literal["frozen", "noise", "cut"]
    begin: Time = Field(alias="from")
    end: Time | None = Field(default=None, alias="to")
    deviation: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    seed: int = Field(default=0, ge=0, lt=2**63)

    @model_validator(mode="after")
    def _is_whole(self) -> "ConnectionFault":
        is_noise = self.kind == "noise"
        if is_noise and self.deviation is None:
            raise ValueError("is noise, and needs a deviation in the unit of the port")
        if not is_noise and self.model_fields_set & {"deviation", "seed"}:
            raise ValueError(f"is {self.kind}: deviation and seed are for noise")
        if self.end is not None and self.end <= self.begin:
            raise ValueError(f"ends at {self.end:g} s, and begins at {self.begin:g} s")
        return self

    @model_serializer(mode="wrap")
    def _as_written(self, handler: Any) -> dict[str, Any]:
        names = {"begin": "from", "end": "to"}
        return {
            names.get(key, key): value
            for key, value in handler(self).items()
            if value is not None and (key != "seed" or self.kind == "noise")
        }


class Scenario(_Data):
    """A scenario: what happens to a system from outside during a run.

    Attributes
    ----------
    inputs : mapping of str to list of float, or str
        ``time`` (s), and values of inputs ``component.input`` that nothing feeds, in their units;
        in a system file also the path of a CSV file with these columns.
    set : list of ValueSet
        Values that change.
    fault : list of ConnectionFault
        What connections deliver instead.
    """

    inputs: str | dict[str, list[Finite]] | None = None
    set: list[ValueSet] = []
    fault: list[ConnectionFault] = []

    def __bool__(self) -> bool:
        return bool(self.inputs or self.set or self.fault)

    def __str__(self) -> str:
        table = self.inputs if isinstance(self.inputs, dict) else {}
        columns = len(table.keys() - {"time"})
        parts = {"input column": columns, "value": len(self.set), "fault": len(self.fault)}
        return ", ".join(counted(number, what) for what, number in parts.items() if number)


class Adaptive(_Data):
    """An exchange step that follows the error of the coupling.

    The exchange step of the system is the smallest one; the others are 2, 4, 8, ... times as long.

    Attributes
    ----------
    tolerance : float
        Error of one exchange: with ``doubling``, root mean square of the errors of all exchanged
        values, each as a part of the largest value so far of its component and unit; with
        ``ledger``, energy that the couplings have made, as a part of E0.
    largest_step : float
        Longest step (s) that is tried.
    control : str
        ``doubling``: a step is compared with two of half of it, after which all FMUs go back; the
        two are kept. ``ledger``: the energy residual of the last step is looked at, and none is
        taken back.
    """

    tolerance: Tolerance
    largest_step: Seconds
    control: Literal["doubling", "ledger"] = "doubling"


class SystemSpec(_Data):
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
        Times (s). In a file, any time may be a fraction: ``"1/60"``.
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
    time_limit: Seconds = 600.0
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


def system_from(data: Mapping[str, Any], where: str = "system") -> SystemSpec:
    """Make a system of plain data.

    Parameters
    ----------
    data : mapping
        Keys and values as in a TOML file.
    where : str
        Stands before the key of a problem.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        Unknown or missing keys, values of the wrong type or out of range; each with the path of
        its key.
    """
    try:
        return SystemSpec.model_validate(data)
    except ValidationError as error:
        found = sentences(error.errors())
        raise InputRefused(
            [_form_problem(where, key, texts) for key, texts in found.items()]
        ) from error


_LEFT_OUT = ("connections", "bonds", "scenario")
"""Keys of a system whose entries the others can do without."""


def _without_faulty(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a system without what is of a wrong form in these keys."""
    try:
        SystemSpec.model_validate(data)
    except ValidationError as error:
        faulty = {tuple(fault["loc"][:2]) for fault in error.errors()}
        return {key: _sound(key, value, faulty) for key, value in data.items()}
    return dict(data)


def _sound(key: str, value: Any, faulty: Collection[tuple[Any, ...]]) -> Any:
    if key not in _LEFT_OUT or not isinstance(value, list | dict):
        return value
    if isinstance(value, list):
        return [entry for place, entry in enumerate(value) if (key, place) not in faulty]
    return {name: entry for name, entry in value.items() if (key, name) not in faulty}


def _form_problem(where: str, key: tuple[Any, ...], texts: list[str]) -> Problem:
    hints = [nearest(str(key[-1]), _KEYS)] if UNKNOWN_KEY in texts else []
    return Problem(f"{where}: {'.'.join(map(str, key))}", "; ".join([" or ".join(texts), *hints]))


def load_system(path: Path, leave_out_faulty: bool = False) -> SystemSpec:
    """Read a system from a TOML file.

    Parameters
    ----------
    path : Path
        Relative paths of FMUs count from its folder.
    leave_out_faulty : bool
        Connections, bonds and parts of a scenario of a wrong form are passed over, to see what
        else is wrong.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        No such file, not TOML, or :func:`system_from` refuses the content.
    """
    data = toml_content(path, read_text(path))
    if leave_out_faulty:
        data = _without_faulty(data)
    system = system_from(data, str(path))
    folder = path.resolve().parent
    components = {
        name: spec.model_copy(update={"fmu": str(folder / spec.fmu)})
        for name, spec in system.components.items()
    }
    return system.model_copy(update={"components": components})


def with_values(system: SystemSpec, values: Mapping[str, Value]) -> SystemSpec:
    """Return the system with other values.

    Parameters
    ----------
    system : SystemSpec
        Stays as it is.
    values : mapping of str to value
        By ``component.parameter`` or by the name of a shared value. A value that is shared changes
        for all its targets.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        No such component, or two different values for one shared value. Names of parameters are
        not checked here: only the FMU knows them.
    """
    parameters = {name: dict(spec.parameters) for name, spec in system.components.items()}
    shared: dict[str, dict[str, Value]] = {}
    problems = []
    for name, entry in values.items():
        try:
            value: Value = plain_value(entry)
        except ValueError as error:
            problems.append(Problem(name, str(error)))
            continue
        component, parameter = split_name(name, parameters)
        owner = _owner(system, name)
        if owner is not None:
            shared.setdefault(owner, {})[name] = value
        elif component in parameters and parameter:
            parameters[component][parameter] = value
        else:
            known = [*system.components, *system.shared]
            what = "is neither component.parameter nor a shared value"
            problems.append(Problem(name, what, nearest(component, known)))
    problems += [problem for key, given in shared.items() for problem in _one_value(key, given)]
    if problems:
        raise InputRefused(problems)
    components = {
        name: spec.model_copy(update={"parameters": parameters[name]})
        for name, spec in system.components.items()
    }
    replaced = {
        key: system.shared[key].model_copy(update={"value": next(iter(given.values()))})
        for key, given in shared.items()
    }
    return system.model_copy(
        update={"components": components, "shared": {**system.shared, **replaced}}
    )


def aliases(system: SystemSpec, name: str) -> set[str]:
    """Return the names under which a value can be given.

    Parameters
    ----------
    system : SystemSpec
        With its shared values.
    name : str
        ``component.parameter``, or the name of a shared value.

    Returns
    -------
    set of str
        The name itself; of a shared value also its own name and all its targets.
    """
    owner = _owner(system, name)
    return {name} if owner is None else {name, owner, *system.shared[owner].targets}


def _owner(system: SystemSpec, name: str) -> str | None:
    """Return the shared value that a name stands for or that its parameter takes."""
    for key, entry in system.shared.items():
        if name == key or any(matches(target, name) for target in entry.targets):
            return key
    return None


def _one_value(key: str, given: Mapping[str, Value]) -> list[Problem]:
    """Refuse several values for one shared value."""
    if len(set(map(str, given.values()))) <= 1:
        return []
    listed = ", ".join(f"{name} = {value}" for name, value in given.items())
    what = f"is one value for all its targets, and is given several: {listed}"
    return [Problem(key, what, "give one of them")]


_MODELS = (
    *(ComponentSpec, Connection, SharedValue, PowerBond, EnergyAlarm, SystemSpec),
    *(Scenario, ValueSet, ConnectionFault, Adaptive, Iteration, IteratedConnection),
)
_KEYS = sorted({field.alias or key for m in _MODELS for key, field in m.model_fields.items()})

"""Parts of a system as data: components, connections, shared values, power bonds, alarm."""

from typing import Annotated, Any

from pydantic import Field, model_validator

from .fields import Extrapolation, Finite, PlainValue, Seconds, SystemData, Tolerance


class ComponentSpec(SystemData):
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
    parameters: dict[str, PlainValue] = {}
    record_states: bool = False
    tolerance: Tolerance | None = None
    extrapolation: Extrapolation | None = None
    isolate: bool = False
    time_limit: Seconds | None = None


class Connection(SystemData):
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


class SharedValue(SystemData):
    """One value that several parameters take: the radius of the rock, for instance.

    Targets are ``component.parameter``.
    """

    value: PlainValue
    targets: list[str] = Field(min_length=1)


class PowerBond(SystemData):
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


class EnergyAlarm(SystemData):
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

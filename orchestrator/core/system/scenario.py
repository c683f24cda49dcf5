"""The table ``[scenario]`` of a system: what happens to it from outside during a run."""

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_serializer, model_validator

from ..errors import counted
from .fields import Finite, PlainValue, SystemData, Time


class ValueSet(SystemData):
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
    value: PlainValue
    at: Time | None = None
    when: str | None = None

    @model_validator(mode="after")
    def _has_one_moment(self) -> "ValueSet":
        if (self.at is None) == (self.when is None):
            raise ValueError("needs either at (s) or when (a condition), and not both")
        return self


class ConnectionFault(SystemData):
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


class Scenario(SystemData):
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

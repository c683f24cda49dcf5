"""The table ``[iteration]`` of a system: how the implicit master repeats an exchange."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from .fields import Seconds, SystemData, Tolerance

InputMoment = Literal["begin", "middle", "end", "mean"]
"""InputMoment of a step whose values a component gets for that step."""


class IteratedConnection(SystemData):
    """Tolerances and moment of the connections between some ports.

    Attributes
    ----------
    source, target : str
        ``component.port``; ``*`` stands for any text. Default: any.
    tolerance : float, optional
        Relative tolerance of the value.
    absolute : float, optional
        Difference that is tolerated besides, in the unit of the source.
    input : str, optional
        InputMoment of the values, see :class:`Iteration`.
    """

    source: str = "*"
    target: str = "*"
    tolerance: Tolerance | None = None
    absolute: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    input: InputMoment | None = None

    def __str__(self) -> str:
        return f"{self.source} -> {self.target}"

    @model_validator(mode="after")
    def _says_something(self) -> "IteratedConnection":
        if self.tolerance is None and self.absolute is None and self.input is None:
            raise ValueError("gives neither tolerance nor absolute nor input")
        return self


class Iteration(SystemData):
    """How the implicit master iterates.

    Attributes
    ----------
    method : str
        ``fixed_point`` (with Aitken's relaxation), ``anderson``, or ``quasi_newton`` (on the
        interface, with what earlier exchanges have taught).
    window : float, optional
        Time (s) that is iterated as a whole, a multiple of the exchange step and of all steps of
        components; without it, an exchange, or as many as all components need to come to a common
        one. What components show at each exchange within it is found together: in an iteration
        they pass on the course of a value, and not the end of it alone.
    interpolation : int
        Order of the polynomial between values at exchanges: 1, a straight line; 2 and 3 through the
        nearest exchanges of the window, which has to have as many of them at least.
    tolerance : float
        Largest difference between a value that was given and the one that came back, relative to
        the largest amount that this output has had so far.
    absolute : float
        Difference tolerated besides, in the unit of each source: near 0, values are rounding.
    most : int
        Iterations in an exchange, at most.
    input : str
        Values of an exchange that components get for a step. ``end``: those of its end (first
        order); ``middle``: those of its middle, between those of its beginning and its end, for
        components that hold their inputs (second order), with ``interpolation`` above 1 the mean
        over the step, which is the middle of a line; ``begin``: those of its beginning, for
        positions that the component itself moves on with a velocity; ``mean``: the values of the
        end for the whole of the source's step, for outputs that are means over it.
    unconverged : str
        ``fail``: the run ends where ``most`` iterations are not enough; ``continue``: it goes on
        with the newest values, and warns with the number of such exchanges.
    connections : list of IteratedConnection
        What is otherwise for some connections; the last entry that names one counts.
    """

    method: Literal["fixed_point", "anderson", "quasi_newton"] = "quasi_newton"
    window: Seconds | None = None
    interpolation: Literal[1, 2, 3] = 1
    tolerance: Tolerance = 1e-6
    absolute: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] = 1e-9
    most: int = Field(default=50, ge=1, le=1000)
    input: InputMoment = "end"
    unconverged: Literal["fail", "continue"] = "fail"
    connections: list[IteratedConnection] = Field(default_factory=list)

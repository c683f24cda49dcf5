"""A component stepped without FMI, reached by the names of its variables."""

import math
from collections.abc import Iterator, Mapping
from numbers import Integral
from typing import Any

import numpy as np

from rockshed.components.catalogue import NAMES
from rockshed.components.catalogue import component as catalogued
from rockshed.components.common.component import (
    Component,
    ComponentError,
    Instance,
    value_problems,
)
from rockshed.components.common.ports import Causality, Variable

from ..core.errors import UnknownName
from ..core.system.names import nearest
from ..tables import Table
from .first_compilation import tell_first_compilation

NOT_INITIALISED = "call initialise() first"
"""Why a component cannot step that is not initialised."""
MAKE_ANOTHER = "make another component with rockshed.component"
"""Remedy where the life of a component is over."""
FAILED = f"an earlier step has failed; {MAKE_ANOTHER}"
"""Why a component cannot step that has failed."""


class Subsystem:
    """A component with a clock of its own.

    Set parameters and inputs, :meth:`initialise`, then :meth:`step` as often as wanted. Inputs may
    change between two steps, outputs change only in a step. Iterating gives the names of the
    variables, arrays element by element.

    Parameters
    ----------
    instance : Instance
        Holds the buffers of the component.

    Attributes
    ----------
    instance : Instance
        The same, for what has no name: hidden states, serialized states.
    time : float
        Time reached (s).
    """

    def __init__(self, instance: Instance) -> None:
        self.instance = instance
        self.time = 0.0
        self._why_no_step = NOT_INITIALISED

    @property
    def component(self) -> Component:
        """The declarations and kernels of the component."""
        return self.instance.component

    def __getitem__(self, name: str) -> Any:
        self._known(name)
        return self.instance[name]

    def __setitem__(self, name: str, value: Any) -> None:
        self._known(name)
        if found := self._value_problems(name, value):
            raise ComponentError(self.component.name, found)
        self.instance[name] = value

    def __iter__(self) -> Iterator[str]:
        return iter(self.instance.references)

    def __contains__(self, name: object) -> bool:
        return name in self.instance.references or name in self._arrays()

    def initialise(self) -> None:
        """Check the parameters, compute the state and the outputs at the start.

        Raises
        ------
        ComponentError
            Parameters or inputs that are refused, all reasons at once.
        """
        self.time = 0.0
        self._why_no_step = NOT_INITIALISED
        tell_first_compilation([self.component])
        self.instance.initialise()
        self._why_no_step = ""

    def step(self, step: float) -> None:
        """Advance by a step with the inputs as they are.

        Parameters
        ----------
        step : float
            Length of the step (s).

        Raises
        ------
        ComponentError
            The component is not initialised or has failed, the step is not positive, or the
            component cannot go on.
        """
        if self._why_no_step:
            raise self._refused(f"a step is refused: {self._why_no_step}")
        if not (step > 0.0 and math.isfinite(step)):
            reason = f"a step of {step:.6g} s is refused: its length must be a positive number"
            raise self._refused(reason)
        try:
            self.instance.step(self.time, step)
        except BaseException:
            self._why_no_step = FAILED
            raise
        self.time += step

    def variables(self) -> Table:
        """Return a table of all variables: name, causality, unit, value, description."""
        table = Table(("variable", "", "unit", "value", "description"), right=("value",))
        for variable in self.component.layout.ordered:
            value = self.instance[variable.name]
            length = "" if variable.size is None else f"[1..{len(value)}]"
            shown = f"{value:.6g}" if variable.size is None else ""
            if variable.choices:
                shown = variable.choices[int(value) - 1]
            unit = "" if variable.unit == "1" else variable.unit
            name = f"{variable.name}{length}"
            table.add(name, str(variable.causality), unit, shown, variable.description)
        return table

    def _refused(self, reason: str) -> ComponentError:
        return ComponentError(self.component.name, [reason])

    def _variable(self, name: str) -> Variable:
        base = name.partition("[")[0]
        layout = self.component.layout
        present = layout.renamed.get(base, base)
        return next(variable for variable in layout.variables if variable.name == present)

    def _value_problems(self, name: str, value: Any) -> list[str]:
        """Return why a variable cannot be set to a value now, as the FMU of the component does.

        Before the initialisation ranges are left alone: it checks them all together.
        """
        variable = self._variable(name)
        if variable.causality is Causality.OUTPUT:
            return [f"{name} is an output, which the component computes; set parameters or inputs"]
        running = self._why_no_step != NOT_INITIALISED
        if running and variable.causality is Causality.PARAMETER:
            return [f"{name} is a parameter, which is fixed after initialise(); {MAKE_ANOTHER}"]
        if isinstance(value, str):
            is_word = bool(variable.choices)
            return [] if is_word else [f"{name} = {value!r}: must be a number, not a text"]
        try:
            numbers = np.asarray(value, np.float64)
        except (TypeError, ValueError):
            return [f"{name}: must be numbers"]
        length = None if name in self.instance.references else len(self.instance[name])
        if numbers.shape not in {(), (length,)}:
            takes = "one number" if length is None else f"one number or {length}"
            return [f"{name} takes {takes}, not an array of shape {numbers.shape}"]
        if not running:
            return []
        return [
            problem for n in numbers.ravel() for problem in value_problems(variable, name, float(n))
        ]

    def _arrays(self) -> set[str]:
        return {variable.name for variable in self.component.layout.variables}

    def _known(self, name: str) -> None:
        if name not in self:
            remedy = nearest(name, dict.fromkeys([*self._arrays(), *self]))
            raise UnknownName(f"{self.component.name} has no variable {name!r}; {remedy}")

    def __repr__(self) -> str:
        sizes = "".join(f", {name} {number}" for name, number in self.instance.sizes.items())
        inputs = sum(v.causality is Causality.INPUT for v in self.component.layout.variables)
        outputs = sum(v.causality is Causality.OUTPUT for v in self.component.layout.variables)
        return (
            f"<{self.component.name}{sizes}: {inputs} inputs, {outputs} outputs, "
            f"at t = {self.time:.9g} s>"
        )

    def _repr_html_(self) -> str:
        return self.variables()._repr_html_()


def component_of(name: str | Component) -> Component:
    """Return a component by its name in the catalogue, or as it is.

    Parameters
    ----------
    name : str or Component
        Name, or a component of one's own.

    Returns
    -------
    Component
        Its declarations and kernels.

    Raises
    ------
    UnknownName
        The catalogue has no component of this name.
    """
    if isinstance(name, Component):
        return name
    if name not in NAMES:
        raise UnknownName(f"there is no component {name!r}; {nearest(name, NAMES)}")
    return catalogued(name)


def is_whole(value: object) -> bool:
    """Tell whether a value is a whole number, of Python or numpy; true and false are none.

    Parameters
    ----------
    value : object
        What is asked about.
    """
    return isinstance(value, Integral) and not isinstance(value, bool)


def whole_sizes(made: Component, sizes: Mapping[str, int] | None) -> dict[str, int]:
    """Return all sizes of a component as numbers of Python.

    Parameters
    ----------
    made : Component
        The component.
    sizes : mapping of str to int, optional
        Those that differ from the defaults.

    Returns
    -------
    dict of str to int
        By name.

    Raises
    ------
    ComponentError
        A size that the component has not, that is no whole number or out of range.
    """
    asked = dict(sizes or {})
    if broken := {name: value for name, value in asked.items() if not is_whole(value)}:
        reasons = [f"{name} = {value!r} is no whole number" for name, value in broken.items()]
        raise ComponentError(made.name, reasons)
    return made.with_sizes({name: int(value) for name, value in asked.items()})


def component(name: str | Component, /, **sizes: int) -> Subsystem:
    """Make a component to step it without FMI.

    Parameters
    ----------
    name : str or Component
        Name of a component of the catalogue (``rockshed list``), or a component of one's own.
    **sizes : int
        Sizes that differ from the defaults.

    Returns
    -------
    Subsystem
        The component with start values everywhere, not yet initialised.

    Raises
    ------
    UnknownName
        The catalogue has no component of this name.
    ComponentError
        A size that the component has not, or that is out of its range.

    Examples
    --------
    A rock that falls for a tenth of a second:

    >>> import rockshed
    >>> rock = rockshed.component("FallingRock")
    >>> rock["velocity0.y"] = -1.0
    >>> rock.initialise()
    >>> rock.step(0.1)
    >>> round(rock["velocity.y"], 3)
    -1.981
    """
    made = component_of(name)
    return Subsystem(Instance(made, whole_sizes(made, sizes)))

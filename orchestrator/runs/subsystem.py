"""A component stepped without FMI, reached by the names of its variables."""

from collections.abc import Iterator
from typing import Any

from rockshed.components.catalogue import NAMES
from rockshed.components.catalogue import component as catalogued
from rockshed.components.common.component import Component, Instance
from rockshed.components.common.ports import Causality

from ..core.errors import UnknownName
from ..core.system.names import nearest
from ..tables import Table


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

    @property
    def component(self) -> Component:
        """The declarations and kernels of the component."""
        return self.instance.component

    def __getitem__(self, name: str) -> Any:
        self._known(name)
        return self.instance[name]

    def __setitem__(self, name: str, value: Any) -> None:
        self._known(name)
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
        self.instance.initialise()

    def step(self, step: float) -> None:
        """Advance by a step with the inputs as they are.

        Parameters
        ----------
        step : float
            Length of the step (s).

        Raises
        ------
        ComponentError
            The component cannot go on.
        """
        self.instance.step(self.time, step)
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
    return Subsystem(component_of(name).instance(**sizes))

"""Components without FMI: the slave of an FMU, called directly in this process.

It behaves like the FMU file of the same component behind the orchestrator's slave interface (same
description, same states, same messages); breakpoints and coverage reach its code.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.cache import source_stamp
from rockshed.components.common.component import Component

from .build import fmu_files
from .python.foundations import Fmi2Status
from .python.slave import ComponentSlave

OK, DISCARD, ERROR = int(Fmi2Status.ok), int(Fmi2Status.discard), int(Fmi2Status.error)


class InProcess:
    """A component in this process, where an FMU file is expected.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int, optional
        Numbers that differ from the defaults.

    Raises
    ------
    ComponentError
        A size that the component has not, or that is out of range.
    """

    def __init__(self, component: Component, sizes: Mapping[str, int] | None = None) -> None:
        self.component = component
        self.sizes = component.with_sizes(sizes)
        self.origin = {
            "component": component.name,
            "sources": source_stamp(component.folder),
            **{name: str(value) for name, value in self.sizes.items()},
        }

    def model_description(self) -> bytes:
        """Return the ``modelDescription.xml`` of the component's FMU."""
        return fmu_files(self.component, self.sizes)["modelDescription.xml"]

    def instantiate(self, name: str) -> "InProcessSlave":
        """Return a new instance of the component.

        Parameters
        ----------
        name : str
            Name of the instance.

        Returns
        -------
        InProcessSlave
        """
        return InProcessSlave(slave_class(self.component, self.sizes), name)


def slave_class(component: Component, sizes: Mapping[str, int]) -> type[ComponentSlave]:
    """Return the class that the FMU of a component holds, over the component of this process.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.

    Returns
    -------
    type of ComponentSlave
    """
    return type(component.name, (ComponentSlave,), {"component": component, "sizes": dict(sizes)})


class InProcessSlave:
    """An instance of a component with the calls of FMI 2.0.

    Unlike with pythonfmu's binary, every call returns its true status. ``messages`` holds status
    and text of everything logged, oldest first.

    Parameters
    ----------
    kind : type of ComponentSlave
        Class of the slave.
    name : str
        Name of the instance.
    """

    addresses: Any = None
    """There are no C functions to call."""

    def __init__(self, kind: type[ComponentSlave], name: str) -> None:
        self.name, self._kind = name, kind
        self.messages: list[tuple[int, str]] = []
        self._marked = b""
        self.reset()

    def set(
        self, references: NDArray[np.uint32], values: NDArray[np.float64], kind: str = "Real"
    ) -> int:
        """Set variables of one kind, and return the status.

        Parameters
        ----------
        references : ndarray of uint32, shape (n,)
            Value references.
        values : ndarray of float64, shape (n,)
            Values, each in the unit of its variable.
        kind : str
            Real, Integer (also enumerations) or Boolean.
        """
        convert = {"Real": float, "Integer": int, "Boolean": bool}[kind]
        setter = {
            "Real": self._slave.set_real,
            "Integer": self._slave.set_integer,
            "Boolean": self._slave.set_boolean,
        }[kind]
        return self._call(
            setter, references.tolist(), [convert(value) for value in values.tolist()]
        )[1]

    def get(
        self, references: NDArray[np.uint32], out: NDArray[np.float64], kind: str = "Real"
    ) -> int:
        """Read variables of one kind, and return the status.

        Parameters
        ----------
        references : ndarray of uint32, shape (n,)
            Value references.
        out : ndarray of float64, shape (n,)
            Gets the values, each in the unit of its variable.
        kind : str
            Real, Integer (also enumerations) or Boolean.
        """
        getter = {
            "Real": self._slave.get_real,
            "Integer": self._slave.get_integer,
            "Boolean": self._slave.get_boolean,
        }[kind]
        out[:], status = self._call(getter, references.tolist())
        return status

    def set_text(self, reference: int, text: str) -> int:
        """Refuse a string, as no component has one, and return the status.

        Parameters
        ----------
        reference : int
            Value reference.
        text : str
            The string.

        Returns
        -------
        int
            Status of FMI 2.0.
        """
        return self._call(self._slave.set_string, [reference], [text])[1]

    def setup_experiment(self, start: float, stop: float, tolerance: float | None = None) -> int:
        """Tell start and end of the run (s), and return the status.

        Parameters
        ----------
        start : float
            Start of the run (s).
        stop : float
            End of the run (s).
        tolerance : float, optional
            Relative tolerance; no component has a use for it.

        Returns
        -------
        int
            Status of FMI 2.0.
        """
        return self._call(self._slave.setup_experiment, start, stop, tolerance)[1]

    def enter_initialisation(self) -> int:
        """Enter the initialization mode; return the status."""
        return self._call(self._slave.enter_initialization_mode)[1]

    def exit_initialisation(self) -> int:
        """Leave the initialization mode; return the status."""
        return self._call(self._slave.exit_initialization_mode)[1]

    def step(self, time: float, step: float) -> int:
        """Advance from ``time`` by ``step`` (s), and return the status.

        Parameters
        ----------
        time : float
            Start of the step (s).
        step : float
            Length of the step (s).

        Returns
        -------
        int
            Status of FMI 2.0.
        """
        done, _ = self._call(self._slave.do_step, time, step)
        return OK if done else DISCARD

    def terminated_at(self) -> float | None:
        """No component of this house ends a run."""
        return None

    def state(self) -> bytes:
        """Return the complete state, serialized; equal to that of the FMU."""
        return bytes(self._call(self._slave._get_fmu_state)[0])

    def restore(self, content: bytes) -> None:
        """Take over a state of :meth:`state`.

        Parameters
        ----------
        content : bytes
            The serialized state.

        Raises
        ------
        RuntimeError
            It is damaged, or of another component or size.
        """
        if self._call(self._slave._set_fmu_state, content)[1] == ERROR:
            raise RuntimeError(self.messages[-1][1])

    def mark(self) -> None:
        """Keep the present state in memory."""
        self._marked = self.state()

    def roll_back(self) -> None:
        """Go back to the state that was kept.

        Raises
        ------
        RuntimeError
            None was.
        """
        self.restore(self._marked)

    def reset(self) -> int:
        """Go back to the start values of a new slave, and return the status."""
        self._slave = self._kind(instance_name=self.name)
        return OK

    def terminate(self) -> int:
        """End the run; return the status."""
        return self._call(self._slave.terminate)[1]

    def free(self) -> None:
        """Do nothing: Python gives back by itself what is held."""

    def _call(self, function: Callable[..., Any], *arguments: Any) -> tuple[Any, int]:
        """Return the result of a call, and the worst status logged, save that of steps to come."""
        result = function(*arguments)
        logged = [(int(entry.status), entry.msg) for entry in self._slave.log_queue]
        self._slave.log_queue.clear()
        self.messages += logged
        return result, max((status for status, _ in logged if status != DISCARD), default=OK)

"""What the master needs of a subsystem, in the order in which it needs it.

A :class:`Source` is an FMU file, or anything that behaves like one; a :class:`Slave` is an instance made from it. The calls
are those of FMI 2.0 and return its status; what a slave has to say about a status it leaves in ``messages``. Classes need not
inherit from these protocols: having the same methods is enough.

The life of a slave: ``set`` parameters and inputs, ``setup_experiment``, ``enter_initialisation``, ``set`` and ``get`` as often
as wanted, ``exit_initialisation``, then ``set``, ``step``, ``get`` over and over, ``terminate``, ``free``.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
"""Status of an FMI call. OK and WARNING let the run go on."""

STATUS_NAMES = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")

REAL, INTEGER, BOOLEAN, STRING = "Real", "Integer", "Boolean", "String"
"""The four families of FMI calls. An enumeration travels as Integer."""

References = NDArray[np.uint32]
Values = NDArray[np.float64]


@dataclass(frozen=True)
class Addresses:
    """Addresses of a slave's C functions, ``set`` and ``get`` by kind, for a loop that calls them without Python."""

    instance: int
    set: Mapping[str, int]
    get: Mapping[str, int]
    do_step: int


class Slave(Protocol):
    """An instance of a subsystem.

    name: name of the component in the system.
    messages: (status, text) of everything the slave has logged so far, oldest first. A refusal during the initialisation is a
        message with the status ERROR or a call that returns DISCARD or worse.
    addresses: None where the slave can only be called through Python.
    """

    name: str
    messages: list[tuple[int, str]]
    addresses: Addresses | None

    def set(self, references: References, values: Values, kind: str = REAL) -> int:
        """Set the variables ``references`` (all of one kind) to ``values``. Integers and booleans are given as whole floats."""

    def get(self, references: References, out: Values, kind: str = REAL) -> int:
        """Write the present values of the variables ``references`` (all of one kind) into ``out``."""

    def set_text(self, reference: int, text: str) -> int:
        """Set one variable of the kind String."""

    def setup_experiment(self, start: float, stop: float) -> int:
        """Tell the time (s) at which the run starts and the time at which it ends."""

    def enter_initialisation(self) -> int:
        """Enter the initialisation mode: parameters are given, the start values of inputs may still change."""

    def exit_initialisation(self) -> int:
        """Leave the initialisation mode: the slave is ready for its first step."""

    def step(self, time: float, step: float) -> int:
        """Advance from ``time`` (s) by ``step`` (s) with the inputs as they are set."""

    def state(self) -> bytes:
        """The complete state, serialized.

        Raises:
            RuntimeError: the slave cannot do it, or failed to.
        """

    def restore(self, content: bytes) -> None:
        """Take over a state that :meth:`state` gave, of this instance or another one, in this process or another.

        Raises:
            RuntimeError: the slave cannot do it, or this is no such state.
        """

    def reset(self) -> int:
        """Back to where the slave was when it was made, with start values everywhere."""

    def terminate(self) -> int:
        """End the run."""

    def free(self) -> None:
        """Give back everything the slave holds, in whatever state it is. Nothing may be called afterwards."""


class Source(Protocol):
    """What slaves are made from: an FMU file, or a component in this process.

    origin: what it is, for the record of a run: path and hash of the file, or the name of the component.
    """

    origin: dict[str, str]

    def model_description(self) -> bytes:
        """The modelDescription.xml as it stands in the FMU.

        Raises:
            InputRefused: there is none, or it cannot be used on this machine.
        """

    def instantiate(self, name: str) -> Slave:
        """A new instance.

        Raises:
            InputRefused: the instance cannot be made.
        """


def without_name(name: str, text: str) -> str:
    """A slave's message without the instance's name in front, which is told anyway wherever the message is shown."""
    return re.sub(rf"^{re.escape(name)}( \([^)]*\))?: ", "", text)

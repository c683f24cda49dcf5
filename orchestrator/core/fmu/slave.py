"""Interface of the master to a subsystem, in the order in which it is used.

A :class:`Source` is an FMU file, or anything that behaves like one; a :class:`Slave` is an instance
made from it. The calls are those of FMI, whatever its version, and return its status; messages
about a status are in ``messages``. Classes need not inherit from these protocols: having the same
methods is enough.

The life of a slave: ``set`` parameters and inputs, ``setup_experiment``, ``enter_initialisation``,
``set`` and ``get`` as often as wanted, ``exit_initialisation``, then ``set``, ``step``, ``get`` in
turn, ``terminate``, ``free``.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
"""Status of an FMI call. OK and WARNING let the run go on."""

_STATUS_NAMES = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")


def status_name(status: int) -> str:
    """Return the name of a status; of a number that FMI does not know, that."""
    known = 0 <= status < len(_STATUS_NAMES)
    return _STATUS_NAMES[status] if known else f"{status}, which is no status of FMI"


def worst(*statuses: int) -> int:
    """Return the worst status; one below OK, which FMI does not know, is the worst of all."""
    return min(statuses) if min(statuses) < OK else max(statuses)


MESSAGES_KEPT = 1000
"""Messages of a slave that are kept, and different ones that are counted."""

REAL = "Real"
INTEGER = "Integer"
BOOLEAN = "Boolean"
STRING = "String"
BINARY = "Binary"
CLOCK = "Clock"
"""Kinds of values: what is of one kind can be connected. An enumeration is an Integer."""

NUMBERS = (REAL, INTEGER, BOOLEAN)
"""Kinds whose values a float can carry."""

ValueReferences = NDArray[np.uint32]
Values = NDArray[np.float64]


@dataclass(frozen=True)
class Addresses:
    """Addresses of a slave's C functions, for the exchange loop.

    Attributes
    ----------
    instance : int
        First argument of every call.
    set, get : mapping of str to int
        Functions that move values, by :mod:`type <rockshed.core.fmu.types>`.
    do_step : int
        Function that advances.
    may_return_early : bool
        Whether that is the one of FMI 3.0, which tells how far it came.
    """

    instance: int
    set: Mapping[str, int]
    get: Mapping[str, int]
    do_step: int
    may_return_early: bool = False


class Messages(list[tuple[int, str]]):
    """The newest messages of a slave, status and text of each, and the number of all of them.

    Attributes
    ----------
    counts : Counter
        How often each message has come; those of which there are too many are one.
    """

    def __init__(self) -> None:
        super().__init__()
        self.counts: Counter[tuple[int, str]] = Counter()

    def append(self, message: tuple[int, str]) -> None:
        """Take a message; the oldest is dropped where there are too many."""
        super().append(message)
        del self[:-MESSAGES_KEPT]
        if message not in self.counts and len(self.counts) >= MESSAGES_KEPT:
            message = (message[0], "(other messages)")
        self.counts[message] += 1


class SlaveLost(RuntimeError):  # noqa: N818 (it says what happened)
    """The process of a slave has ended, or does not return. It cannot be called any more.

    Attributes
    ----------
    name : str
        Of the component.
    what : str
        How it was lost.
    """

    def __init__(self, name: str, what: str) -> None:
        self.name = name
        self.what = what
        super().__init__(what)


def counts_of(messages: list[tuple[int, str]]) -> Counter[tuple[int, str]]:
    """Return how often each message of a slave has come."""
    return Counter(messages.counts if isinstance(messages, Messages) else messages)


class Slave(Protocol):
    """An instance of a subsystem.

    Attributes
    ----------
    name : str
        Name of the component in the system.
    messages : list of (int, str)
        Status and text of all messages, oldest first. A refusal during the initialisation is a
        message with the status ERROR or a call that returns DISCARD or worse.
    addresses : Addresses or None
        None where the slave can only be called through Python.
    """

    name: str
    messages: list[tuple[int, str]]
    addresses: Addresses | None

    def set(self, references: ValueReferences, values: Values, kind: str = REAL) -> int:
        """Set variables of one type, ``kind``; of arrays, all elements one after the other.

        Whole numbers and booleans come as whole floats.
        """

    def get(self, references: ValueReferences, out: Values, kind: str = REAL) -> int:
        """Write the present values of variables of one type, ``kind``, into ``out``."""

    def set_text(self, reference: int, text: str) -> int:
        """Set one variable of the kind String."""

    def setup_experiment(self, start: float, stop: float, tolerance: float | None = None) -> int:
        """Tell the times (s) at which the run starts and ends, and the solver's tolerance."""

    def enter_initialisation(self) -> int:
        """Enter the initialisation mode: parameters are set, inputs may still change."""

    def exit_initialisation(self) -> int:
        """Leave the initialisation mode: the slave is ready for its first step."""

    def step(self, time: float, step: float) -> int:
        """Make a step (s) from a time (s) with the inputs as they are set."""

    def terminated_at(self) -> float | None:
        """Return the time (s) up to which a step went that the slave has ended with DISCARD.

        None where the slave does not want the run to end.
        """

    def state(self) -> bytes:
        """Serialize the complete state.

        Raises
        ------
        RuntimeError
            The slave cannot do it, or failed to.
        """

    def restore(self, content: bytes) -> None:
        """Take over a state that :meth:`state` gave.

        Parameters
        ----------
        content : bytes
            State of this instance or another one, in this process or another.

        Raises
        ------
        RuntimeError
            The slave cannot do it, or this is no such state.
        """

    def reset(self) -> int:
        """Go back to the state after the instantiation, with start values everywhere."""

    def terminate(self) -> int:
        """End the run of this slave."""

    def free(self) -> None:
        """Give back everything the slave holds. Nothing may be called afterwards."""


class SlaveWithTexts(Slave, Protocol):
    """An instance that has variables of the kind String."""

    def get_texts(self, reference: int, count: int) -> tuple[int, list[str]]:
        """Return status and texts of a variable; ``count`` of them, where it is an array."""

    def set_texts(self, reference: int, texts: list[str]) -> int:
        """Set one variable of the kind String; of an array, all elements."""


class SlaveWithRollback(Slave, Protocol):
    """An instance that can go back to an earlier state of its own, kept in memory."""

    def mark(self) -> None:
        """Keep the present state, in the place of one that was kept before.

        Raises
        ------
        RuntimeError
            The slave cannot do it, or failed to.
        """

    def roll_back(self) -> None:
        """Go back to the state that was kept, as often as wanted.

        Raises
        ------
        RuntimeError
            The slave failed to.
        """


class PartialStep(NamedTuple):
    """A step of FMI 3.0, which may end early.

    status: of FMI. event: something has happened. ended: the run is to end. early: the step has
    ended before its end. reached: time (s) at which it ended.
    """

    status: int
    event: bool = False
    ended: bool = False
    early: bool = False
    reached: float = 0.0


class SlaveOfFmi3(SlaveWithTexts, Protocol):
    """An instance with the calls that FMI 3.0 alone has."""

    def configure(self, sizes: Sequence[tuple[ValueReferences, Values, str]]) -> int:
        """Set structural parameters, references, values and type of each, before all else."""

    def partial_step(self, time: float, step: float) -> PartialStep:
        """Make a step (s) from a time (s), or the beginning of it."""


class Source(Protocol):
    """Maker of slaves: an FMU file, or a component in this process.

    Attributes
    ----------
    origin : dict of str to str
        For the record of a run: path and hash of the file, or the name of the component.
    """

    origin: dict[str, str]

    def model_description(self) -> bytes:
        """Return the modelDescription.xml as it stands in the FMU.

        Raises
        ------
        InputRefused
            There is none, or it cannot be used on this machine.
        """

    def instantiate(self, name: str) -> Slave:
        """Make an instance for a component of this name.

        Raises
        ------
        InputRefused
            The instance cannot be made.
        """


def without_name(name: str, text: str) -> str:
    """Return a slave's message without the name in front of it.

    Wherever the message is shown, the name of the component stands there already.
    """
    return re.sub(rf"^{re.escape(name)}( \([^)]*\))?: ", "", text)


def times(count: int) -> str:
    """Return how often something was said, to stand behind it; nothing for once."""
    return f" ({count} times)" if count > 1 else ""

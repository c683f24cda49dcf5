"""Instances in processes of their own, behind the interface of all others."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

from ..errors import InputRefused, Problem
from ..fmu.fmi3_slave import StepsInParts
from ..fmu.fmu_slave import FmuFile, read_description
from ..fmu.slave import (
    FATAL,
    MESSAGES_KEPT,
    REAL,
    WARNING,
    Addresses,
    Messages,
    PartialStep,
    SlaveLost,
    ValueReferences,
    Values,
)
from .process import Gone, Process, Replied
from .wire import CALL, GET, KINDS, SET, STEP, Errand, as_json

_LONGEST_LINE = 200
"""Characters of a printed line that are kept."""
_NUMBERS = {kind: number for number, kind in enumerate(KINDS)}
_AT_END = " when it was ended, after the run"
_T = TypeVar("_T")


class IsolatedFmu:
    """An FMU file whose instances run in processes of their own.

    Parameters
    ----------
    file : FmuFile
        The FMU.
    limit : float
        Longest time (s) of one call of an instance.

    Attributes
    ----------
    path : Path
        Of the file.
    origin : dict of str to str
        Path and hash of the file, and that its instances have processes of their own.
    """

    def __init__(self, file: FmuFile, limit: float) -> None:
        self._file = file
        self._limit = limit
        self.path = file.path
        process = f"its own, at most {limit:g} s for a call"
        self.origin = {**file.origin, "process": process}

    def model_description(self) -> bytes:
        """Read the modelDescription.xml; see :class:`~rockshed.core.fmu.fmu_slave.FmuFile`."""
        xml = self._file.model_description()
        self.origin.update(self._file.origin)
        return xml

    @property
    def cannot_run(self) -> Problem | None:
        """The reason why it cannot run on this machine, once the description has been read."""
        return self._file.cannot_run

    def content(self, name: str) -> bytes | None:
        """Read a file in the FMU; return None if it is not in it."""
        return self._file.content(name)

    def instantiate(self, name: str) -> "IsolatedSlave":
        """Make an instance in a new process.

        Raises
        ------
        InputRefused
            The library cannot be loaded, or it makes no instance.
        SlaveLost
            The process has ended meanwhile, or does not return.
        """
        is_fmi_3 = read_description(self.model_description()).is_fmi_3
        kind = IsolatedFmi3Slave if is_fmi_3 else IsolatedSlave
        slave = kind(name, self._limit)
        try:
            slave.instantiate(self.path)
        except BaseException:
            slave.free()
            raise
        return slave


class _Printed:
    """Lines that a process prints, as messages.

    Equal lines are one message that is counted; it tells when the line came first.
    """

    def __init__(self, messages: Callable[[], list[tuple[int, str]]]) -> None:
        self._messages = messages
        self._rest = b""
        self._first: dict[str, str] = {}
        self.time: float | None = None

    def __call__(self, content: bytes) -> None:
        """Take what was printed; a line that has no end yet waits for it."""
        *lines, self._rest = (self._rest + content).split(b"\n")
        for line in lines:
            self._tell(line)
        if len(self._rest) > 4 * _LONGEST_LINE:
            self.end()

    def end(self) -> None:
        """Take what waits for the end of its line."""
        if self._rest:
            self._tell(self._rest)
        self._rest = b""

    def _tell(self, line: bytes) -> None:
        letters = line.decode("utf-8", "replace").strip()[:_LONGEST_LINE]
        text = "".join(letter if letter.isprintable() else "?" for letter in letters)
        if len(self._first) < MESSAGES_KEPT:
            when = "before the first step" if self.time is None else f"at t = {self.time:.9g} s"
            self._first.setdefault(text, f"prints, first {when}: {text}")
        self._messages().append((WARNING, self._first.get(text, "prints more")))


class IsolatedSlave:
    """An instance of FMI 2.0 in a process of its own. See :class:`rockshed.core.fmu.slave.Slave`.

    Parameters
    ----------
    name : str
        Of the component.
    limit : float
        Longest time (s) of one call.

    Attributes
    ----------
    forgets : bool
        Whether the FMU may forget states before a step.
    """

    addresses: Addresses | None = None
    forgets = True

    def __init__(self, name: str, limit: float) -> None:
        self.name = name
        self.messages: list[tuple[int, str]] = Messages()
        self._printed = _Printed(lambda: self.messages)
        self._process = Process(limit, self._printed)
        self._memory = self._process.memory
        self._lost = ""
        self._when = ""

    def instantiate(self, path: Path) -> None:
        """Make the instance of an FMU file in the process.

        Raises
        ------
        InputRefused
            It cannot be made.
        SlaveLost
            The process has ended, or does not return.
        """
        try:
            self._process.begin()
        except Gone as lost:
            raise self._loss(str(lost)) from None
        self._asked("instantiate", str(path.absolute()), self.name)

    # ------------------------------------------------------------------ values

    def set(self, references: ValueReferences, values: Values, kind: str = REAL) -> int:
        """Set variables of one type; of arrays, all elements one after the other."""
        memory = self._memory
        number, size = references.size, values.size
        memory.grow(max(number, size))
        memory.references[:number] = references
        memory.values[:size] = values
        return self._passed(Errand(SET, _NUMBERS[kind], number, size)).reply.status

    def get(self, references: ValueReferences, out: Values, kind: str = REAL) -> int:
        """Read variables of one type into ``out``."""
        memory = self._memory
        number, size = references.size, out.size
        memory.grow(max(number, size))
        memory.references[:number] = references
        status = self._passed(Errand(GET, _NUMBERS[kind], number, size)).reply.status
        out[:] = memory.values[:size]
        return status

    def set_text(self, reference: int, text: str) -> int:
        """Set one variable of the kind String."""
        return self._status_of("set_text", reference, text)

    def set_texts(self, reference: int, texts: Sequence[str]) -> int:
        """Set one variable of the kind String; of an array, all elements."""
        return self._status_of("set_texts", reference, list(texts))

    def get_texts(self, reference: int, count: int) -> tuple[int, list[str]]:
        """Return status and texts of a variable of the kind String."""
        return self._value(_texts, "get_texts", reference, count)

    # ------------------------------------------------------------------ life cycle

    def setup_experiment(self, start: float, stop: float, tolerance: float | None = None) -> int:
        """Tell start and end of the run (s), and the relative tolerance of the FMU's solver."""
        return self._status_of("setup_experiment", start, stop, tolerance)

    def enter_initialisation(self) -> int:
        """Enter the initialisation mode of the FMU."""
        return self._status_of("enter_initialisation")

    def exit_initialisation(self) -> int:
        """Leave the initialisation mode of the FMU."""
        return self._status_of("exit_initialisation")

    def step(self, time: float, step: float) -> int:
        """Make a step (s) from a time (s)."""
        self._printed.time = time
        return self._passed(Errand(STEP, self.forgets, time=time, step=step)).reply.status

    def terminated_at(self) -> float | None:
        """Return the time (s) up to which the last step went, if the FMU wants to end there."""
        return self._value(lambda at: None if at is None else float(at), "terminated_at")

    def state(self) -> bytes:
        """Serialize the complete state.

        Raises
        ------
        RuntimeError
            A call failed, or the process is lost.
        """
        return self._asked("state").content

    def restore(self, content: bytes) -> None:
        """Take over a state of :meth:`state`.

        Parameters
        ----------
        content : bytes
            State of this FMU, of an instance in any process.

        Raises
        ------
        RuntimeError
            A call failed, the slave says that this is no state of its own, or the process is lost.
        """
        self._asked("restore", content=bytes(content))

    def mark(self) -> None:
        """Keep the present state in the memory of the process.

        Raises
        ------
        RuntimeError
            A call failed, or the process is lost.
        """
        self._asked("mark")

    def roll_back(self) -> None:
        """Go back to the state that was kept.

        Raises
        ------
        RuntimeError
            A call failed, or the process is lost.
        """
        self._asked("roll_back")

    def reset(self) -> int:
        """Go back to the state after the instantiation."""
        return self._status_of("reset")

    def terminate(self) -> int:
        """End the run of this instance."""
        self._when = _AT_END
        try:
            return self._status_of("terminate")
        except SlaveLost:  # a message says so
            return FATAL

    def free(self) -> None:
        """Free the instance and let its process end.

        An instance that failed beyond repair is not called any more: its process is ended.
        """
        self._when = _AT_END
        if self._lost or any(status == FATAL for status, _ in self.messages):
            self._process.end()
        else:
            with suppress(RuntimeError):  # a message says so
                self._asked("free")
            self._process.leave()
        self._printed.end()

    # ------------------------------------------------------------------ calls

    def _status_of(self, name: str, *arguments: Any) -> int:
        """Return the status of a call by its name."""
        return self._value(int, name, *arguments)

    def _value(self, read: Callable[[Any], _T], name: str, *arguments: Any) -> _T:
        """Return the value of a call by its name, as a function reads it."""
        value = self._asked(name, *arguments).told.get("value")
        with self._nonsense_ends():
            return read(value)

    def _asked(self, name: str, *arguments: Any, content: bytes = b"") -> Replied:
        return self._passed(Errand(CALL), as_json({"call": name, "arguments": arguments}), content)

    def _passed(self, errand: Errand, told: bytes = b"", content: bytes = b"") -> Replied:
        """Pass an errand on; take the messages that come with the reply."""
        if self._lost:
            raise SlaveLost(self.name, self._lost)
        try:
            replied = self._process.ask(errand, told, content)
        except Gone as lost:
            raise self._loss(str(lost)) from None
        except BaseException:  # Ctrl-C
            self._loss("was interrupted")
            raise
        if replied.told:
            self._hear(replied.told)
        return replied

    def _hear(self, told: dict[str, Any]) -> None:
        """Take messages, and raise the errors of the instance."""
        with self._nonsense_ends():
            messages = [(int(status), str(text)) for status, text in told.get("messages", ())]
            refused = [Problem(*map(str, problem)) for problem in told.get("refused", ())]
        for message in messages:
            self.messages.append(message)
        if refused:
            raise InputRefused(refused)
        if "error" in told:
            raise RuntimeError(str(told["error"]))

    @contextmanager
    def _nonsense_ends(self) -> Iterator[None]:
        """End the process where a reply is of a wrong form."""
        try:
            yield
        except (TypeError, ValueError, OverflowError):
            self._process.end()
            raise self._loss("answers nonsense") from None

    def _loss(self, how: str) -> SlaveLost:
        """Note that the process is lost, and return the error that says so."""
        self._printed.end()
        self._lost = f"its code {how}{self._when}"
        self.messages.append((FATAL, self._lost))
        return SlaveLost(self.name, self._lost)


def _texts(value: Any) -> tuple[int, list[str]]:
    status, texts = value
    return int(status), [str(text) for text in texts]


class IsolatedFmi3Slave(StepsInParts, IsolatedSlave):
    """An instance of FMI 3.0 in a process of its own."""

    def configure(self, sizes: Sequence[tuple[ValueReferences, Values, str]]) -> int:
        """Set structural parameters, in configuration mode."""
        plain = [(r.tolist(), v.tolist(), kind) for r, v, kind in sizes]
        return self._status_of("configure", *plain)

    def partial_step(self, time: float, step: float) -> PartialStep:
        """Make a step (s) from a time (s), or the beginning of it."""
        self._printed.time = time
        done = self._passed(Errand(STEP, self.forgets, time=time, step=step)).reply
        return PartialStep(done.status, done.event, done.ended, done.early, done.reached)

    def reset(self) -> int:
        """Go back to the state after the instantiation."""
        self._terminated_at = None
        return self._status_of("reset")

"""The slave of every component: what pythonfmu's binary calls.

The binary turns an exception that escapes from here into fmi2Fatal and crashes a few calls later,
and of all calls only ``do_step`` can return a status other than OK. So nothing escapes: a call that
is refused is logged with its reason, the slave counts as failed, and every step is refused
(fmi2Discard) until it is reset or an earlier state is restored.
"""

import ctypes
import math
import struct
import zlib
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, ClassVar

import numpy as np

from .conduct import (
    ENTER,
    EXIT,
    LOG_CATEGORIES,
    REMEDIES,
    SET,
    SET_UP,
    SETTLED,
    STEP,
    TERMINATE,
    Call,
    Phase,
    Stale,
    number,
    say,
)
from .foundations import (
    IMPOSSIBLE_STATE,
    OK,
    Causality,
    Component,
    ComponentError,
    DeferredError,
    Fmi2Slave,
    Fmi2Status,
    Instance,
    Kind,
    Variable,
    value_problems,
)
from .interpreter import let_go_of_interpreter
from .isolation import ForeignFoldersHidden

_SEAL = struct.Struct("<8sI")
"""Begins a serialized state: a mark and the checksum of what follows, :data:`_CLOCK` and the state
of the component."""
_CLOCK = struct.Struct("<Id")
_MARK = b"rockslav"
_ROUNDING = 1e-6
"""A communication point may differ from the end of the last step by this part of the step."""


_RUNNING = Phase.RUNNING


class _RefusedError(Exception):
    """A call that the slave refuses, with every reason."""


def _guarded(otherwise: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorate a call of the binary: what goes wrong is logged and fails the slave.

    Parameters
    ----------
    otherwise : callable
        Returns the result of a call that goes wrong, from its arguments.

    Returns
    -------
    callable
        The decorator.
    """

    def decorate(method: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(method)
        def call(self: "ComponentSlave", *arguments: Any) -> Any:
            try:
                return method(self, *arguments)
            except BaseException as error:
                # KeyboardInterrupt too: the binary crashes on it as on any other
                self._fail(error)
                return otherwise(*arguments)

        return call

    return decorate


_nothing = _guarded(lambda *arguments: None)


class ComponentSlave(Fmi2Slave):
    """FMI 2.0 slave over an instance of a component.

    The value reference of a variable is its index in the buffer ``w``. Subclasses name the
    component and the sizes it is built with.
    """

    component: ClassVar[Component]
    sizes: ClassVar[Mapping[str, int]]
    log_categories = LOG_CATEGORIES

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if self.resources is not None:
            let_go_of_interpreter(self.resources)
        self._instance = instance = Instance(self.component, self.sizes)
        self._phase = Phase.INSTANTIATED
        self._stale = Stale.STATE
        self._previewed = False
        self._compiled = False
        self._time, self._stop_time = math.nan, math.inf
        self._longest_stable = math.inf
        self._advance: Callable[..., int] = self.component.step
        self._zeros = np.zeros_like(instance.w)
        """As many zeros as values: their product is 0 while all values are finite."""
        self._values: Any = (ctypes.c_double * len(instance.w)).from_buffer(instance.w)  # type: ignore[arg-type]
        self._table = [
            (name, variable)
            for variable in self.component.layout.ordered
            for name in variable.element_names(self.sizes)
        ]
        self._are_outputs = np.array([v.causality is Causality.OUTPUT for _, v in self._table])
        self._constants = {
            len(self._table) + i: value for i, value in enumerate(self.sizes.values())
        }
        self._readers: dict[tuple[int, int], tuple[list[int], Callable[[], list[float]]]] = {}
        self._writers: dict[tuple[int, int], tuple[list[int], Callable[[list[float]], None]]] = {}

    # --- life cycle

    @_nothing
    def setup_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Set the time (s) of the initialisation, and the end that no step may exceed.

        Parameters
        ----------
        start_time : float
            Time of the initialisation (s).
        stop_time : float or None
            End of the run (s), if there is one.
        tolerance : float or None
            Not used: no component has a step size control.
        """
        self._expect(SET_UP)
        if not math.isfinite(start_time) or (stop_time is not None and not stop_time >= start_time):
            stop = "none" if stop_time is None else number(stop_time)
            raise _RefusedError(say("TIMES", number(start_time), stop))
        self._time = start_time
        self._stop_time = math.inf if stop_time is None else stop_time

    @_nothing
    def enter_initialization_mode(self) -> None:
        """Let outputs be read from now on, which follow from parameters and inputs set so far."""
        self._expect(ENTER)
        if math.isnan(self._time):
            raise _RefusedError(say("NO_START"))
        self._phase = Phase.INITIALISING

    @_nothing
    def exit_initialization_mode(self) -> None:
        """Fix the parameters and be ready to step."""
        self._expect(EXIT)
        try:
            self._compute()
        except DeferredError as error:
            text = say("DEFERRED", "; ".join(error.problems))
            self._log(text, Fmi2Status.discard, "logStatusWarning")
            self._stale = Stale.NOTHING
        self._compile_step()
        self._phase = Phase.RUNNING
        self._longest_stable = self._longest_stable_step()

    @_nothing
    def terminate(self) -> None:
        """End the simulation; values can still be read."""
        if self._phase is not Phase.FAILED:
            self._expect(TERMINATE)
            self._phase = Phase.TERMINATED

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance with the present inputs.

        Parameters
        ----------
        current_time, step_size : float
            Start and length of the step (s).

        Returns
        -------
        bool
            False if that is refused or fails; the log tells why.
        """
        try:
            due = (
                self._phase is _RUNNING
                and current_time == self._time
                and 0.0 < step_size < self._stop_time - current_time
                and step_size <= self._longest_stable
            )
            if not due and (reason := self._why_not(current_time, step_size)):
                self._log(
                    say("STEP_REFUSED", number(step_size), current_time, reason), Fmi2Status.error
                )
                return False
            if step_size > self._longest_stable:
                self._warn_of_unstable_step()
            instance = self._instance
            status = self._advance(current_time, step_size, instance.w, instance.x, instance.k)
            if status != OK:
                raise self._failed(current_time, instance.message(status))
            if np.vdot(self._zeros, instance.w) != 0.0 and (lost := instance.lost()):
                raise self._failed(current_time, lost)
            self._time = current_time + step_size
            return True
        except BaseException as error:
            self._fail(error)
            return False

    def _failed(self, time: float, reason: str) -> ComponentError:
        return ComponentError(self.component.name, [say("STEP_FAILED", time, reason)])

    def _why_not(self, time: float, step: float) -> str:
        if self._phase not in STEP.phases:
            return REMEDIES[self._phase]
        if not (step > 0.0 and math.isfinite(step)):
            return say("NO_LENGTH")
        tolerance = _ROUNDING * step + 4.0 * math.ulp(self._time)
        if not abs(time - self._time) <= tolerance:
            return say("ELSEWHERE", self._time)
        if time + step > self._stop_time + tolerance:
            return say("BEYOND_STOP", self._stop_time)
        return ""

    def _expect(self, call: Call) -> None:
        if self._phase not in call.phases:
            raise _RefusedError(say("NOT_NOW", call.name, REMEDIES[self._phase]))

    def _compute(self) -> None:
        """Bring outputs at the start up to date.

        The state, which may be expensive, is computed only if a parameter has changed.
        """
        with ForeignFoldersHidden():
            if self._stale is Stale.STATE:
                self._instance.initialise()
            elif self._stale is Stale.OUTPUTS:
                if problems := self._instance.problems():
                    raise ComponentError(self.component.name, problems)
                self._instance.evaluate()
        self._stale = Stale.NOTHING

    def _compile_step(self) -> None:
        """Compile the step now or load it from the cache, so that the first step takes no longer.

        There is no compiler with NUMBA_DISABLE_JIT, for debugging.
        """
        compiler = getattr(self.component.step, "compile", None)
        if compiler is not None and not self._compiled:
            with ForeignFoldersHidden():
                from numba import typeof

                arguments = (0.0, 0.0, self._instance.w, self._instance.x, self._instance.k)
                compiler(tuple(map(typeof, arguments)))
        self._compiled = True

    def _longest_stable_step(self) -> float:
        """Return the longest communication step (s) with which the integration is stable.

        Internal steps are never longer than it, unless a component has its own.
        """
        known = self._instance.references
        own = "time_step" in known
        used = "time_step" if own else "internal_step"
        if not {used, "stable_step"} <= known.keys():
            return math.inf
        stable = self._instance["stable_step"]
        if self._instance[used] <= stable:
            return math.inf
        return 0.0 if own else stable

    def _warn_of_unstable_step(self) -> None:
        """Say once that a step is too long."""
        step, stable = self._instance["internal_step"], self._instance["stable_step"]
        text = say("UNSTABLE", number(step), number(stable), number(stable))
        self._log(text, Fmi2Status.warning)
        self._longest_stable = math.inf

    # --- values

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return real variables; a block of consecutive references is one slice of the buffer.

        Parameters
        ----------
        vrs : list of int
            Value references.

        Returns
        -------
        list of float
            Values, not a number where the call is refused.
        """
        try:
            if vrs and self._stale is Stale.NOTHING:
                known = self._readers.get((vrs[0], len(vrs)))
                if known and known[0] == vrs:
                    return known[1]()
            return self._get(Kind.REAL, vrs)
        except BaseException as error:
            self._fail(error)
            return [math.nan] * len(vrs)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set real variables; a block of consecutive references is one slice of the buffer.

        Parameters
        ----------
        vrs : list of int
            Value references.
        values : list
            A value for each.
        """
        try:
            if vrs and self._phase is Phase.RUNNING:
                known = self._writers.get((vrs[0], len(vrs)))
                if known and known[0] == vrs and math.isfinite(sum(values)):
                    known[1](values)
                    return
            self._set(Kind.REAL, vrs, values)
        except BaseException as error:
            self._fail(error)

    @_guarded(lambda vrs: [0] * len(vrs))
    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return integer and enumeration variables and the sizes.

        Parameters
        ----------
        vrs : list of int
            Value references.

        Returns
        -------
        list of int
            Values, 0 where the call is refused.
        """
        others = iter(self._get(Kind.INTEGER, [r for r in vrs if r not in self._constants]))
        return [self._constants[r] if r in self._constants else int(next(others)) for r in vrs]

    @_nothing
    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set integer and enumeration variables.

        Parameters
        ----------
        vrs : list of int
            Value references.
        values : list
            A value for each.
        """
        self._set(Kind.INTEGER, vrs, values)

    @_guarded(lambda vrs: [False] * len(vrs))
    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Return the values of boolean variables.

        Parameters
        ----------
        vrs : list of int
            Value references.

        Returns
        -------
        list of bool
            Values, False where the call is refused.
        """
        return [bool(value) for value in self._get(Kind.BOOLEAN, vrs)]

    @_nothing
    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set variables of the type Boolean.

        Parameters
        ----------
        vrs : list of int
            Value references.
        values : list
            A value for each.
        """
        self._set(Kind.BOOLEAN, vrs, values)

    @_guarded(lambda vrs: [""] * len(vrs))
    def get_string(self, vrs: list[int]) -> list[str]:
        """Refuse to read a string: no component has one."""
        raise _RefusedError(f"value references {vrs} of strings are read; this FMU has no string")

    @_nothing
    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Refuse to set a string: no component has one."""
        raise _RefusedError(f"value references {vrs} of strings are set; this FMU has no string")

    def _variable(self, reference: int, kind: Kind) -> tuple[str, Variable]:
        if not 0 <= reference < len(self._table):
            raise _RefusedError(say("NO_REFERENCE", reference, len(self._table) - 1))
        name, variable = self._table[reference]
        if kind is not (Kind.INTEGER if variable.kind is Kind.ENUMERATION else variable.kind):
            raise _RefusedError(say("OTHER_TYPE", name, variable.kind, kind))
        return name, variable

    def _get(self, kind: Kind, vrs: list[int]) -> list[float]:
        variables = [self._variable(reference, kind)[1] for reference in vrs]
        if self._phase is Phase.INITIALISING and any(
            variable.causality is Causality.OUTPUT for variable in variables
        ):
            self._preview()
        if kind is Kind.REAL and vrs:
            self._readers[vrs[0], len(vrs)] = list(vrs), _reader(self._instance.w, list(vrs))
        return [self._values[reference] for reference in vrs]

    def _preview(self) -> None:
        """Compute the outputs before the initialization mode ends.

        What is wrong with the inputs may still be put right.
        """
        try:
            if not self._previewed:
                self._compute()
        except ComponentError as error:
            self._forget_lost()
            self._log(say("NOT_VALID_YET", "; ".join(error.problems)), Fmi2Status.warning)
        self._previewed = True

    def _forget_lost(self) -> None:
        """Take outputs that are no finite numbers for not yet computed ones, which are 0."""
        w = self._instance.w
        w[~np.isfinite(w) & self._are_outputs] = 0.0

    def _set(self, kind: Kind, vrs: list[int], values: list[Any]) -> None:
        self._expect(SET)
        variables = [self._variable(reference, kind) for reference in vrs]
        if refused := [
            reason
            for (name, variable), value in zip(variables, values)
            for reason in self._why_not_set(name, variable, float(value))
        ]:
            raise _RefusedError("; ".join(refused))
        changed = [
            variable.causality
            for (_, variable), r, value in zip(variables, vrs, values)
            if self._values[r] != value
        ]
        for reference, value in zip(vrs, values):
            self._values[reference] = value
        if self._phase is not Phase.RUNNING:
            for causality in changed:
                needs = Stale.STATE if causality is Causality.PARAMETER else Stale.OUTPUTS
                self._stale = max(self._stale, needs)
                self._previewed = False
        elif vrs and all(
            variable.minimum is None and variable.maximum is None for _, variable in variables
        ):
            self._writers[vrs[0], len(vrs)] = list(vrs), _writer(self._instance.w, list(vrs))

    def _why_not_set(self, name: str, variable: Variable, value: float) -> list[str]:
        if variable.causality is Causality.OUTPUT:
            return [say("OUTPUT_SET", name, number(value))]
        if self._phase is not Phase.RUNNING:
            return []  # checked all together when the initialization mode ends
        if variable.causality is Causality.PARAMETER:
            return [say("FIXED", name, number(value))]
        return [
            say("BAD_INPUT", self._time, problem)
            for problem in value_problems(variable, name, value)
        ]

    # --- complete state

    def _get_fmu_state(self) -> bytes:
        """Return the complete state with the time, exact to the bit.

        It is serialized already: nothing is left that could fail.
        """
        try:
            settled = self._phase is Phase.INITIALISING and self._stale is Stale.NOTHING
            phase = self._phase | SETTLED if settled else self._phase
            content = _CLOCK.pack(phase, self._time) + self._instance.to_bytes()
            return _SEAL.pack(_MARK, zlib.crc32(content)) + content
        except BaseException as error:
            self._fail(error)
            return b""

    @_nothing
    def _set_fmu_state(self, state: bytes) -> None:
        """Go back to a state, also one of another process.

        It is refused if it is damaged or of another component or size.
        """
        content = component_state(state)
        phase, time = _CLOCK.unpack_from(state, _SEAL.size)
        settled = phase == Phase.INITIALISING | SETTLED
        phase = Phase.INITIALISING if settled else phase
        if problem := _clock_problem(phase, time):
            raise ComponentError(self.component.name, [IMPOSSIBLE_STATE % problem])
        computed = settled or phase in (Phase.RUNNING, Phase.TERMINATED)
        restored = Instance(self.component, self.sizes)
        restored.from_bytes(content, computed)
        if computed and (problems := restored.value_problems()):
            raise ComponentError(self.component.name, [IMPOSSIBLE_STATE % problems[0]])
        self._take_over(restored, Phase(phase), time)
        if settled:
            self._stale = Stale.OUTPUTS

    def _take_over(self, restored: Instance, phase: Phase, time: float) -> None:
        """Continue from the values of an instance."""
        own = self._instance
        own.w[:] = restored.w
        own.x[:] = restored.x
        own.k[:] = restored.k
        self._phase = phase
        self._time = time
        self._previewed = False
        self._stale = (
            Stale.STATE if phase in (Phase.INSTANTIATED, Phase.INITIALISING) else Stale.NOTHING
        )
        if self._phase is Phase.RUNNING:
            self._compile_step()

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        return state

    # --- log

    def _fail(self, error: BaseException) -> None:
        self._phase = Phase.FAILED
        if isinstance(error, ComponentError):
            text = "; ".join(error.problems)
        elif isinstance(error, _RefusedError):
            text = str(error)
        elif isinstance(error, KeyboardInterrupt):
            text = "interrupted"
        else:
            text = f"unexpected {type(error).__name__}: {error}"
        self._log(text, Fmi2Status.error)

    def _log(self, text: str, status: Fmi2Status, category: str | None = None) -> None:
        """Log with the instance's name.

        FMI takes a message for a printf format, some tools do not: no percent sign is safe.
        """
        said = f"{self.instance_name} ({self.component.name}): {text}".replace("%", "percent")
        self.log(said, status, category)


def component_state(state: bytes) -> bytes:
    """Return the part of a slave's serialized state that belongs to the component.

    :meth:`rockshed.components.common.component.Instance.from_bytes` reads it.

    Parameters
    ----------
    state : bytes
        Of a slave.

    Returns
    -------
    bytes
        Of the component.

    Raises
    ------
    ComponentError
        Not written by such a slave, or damaged.
    """
    if len(state) < _SEAL.size + _CLOCK.size or _SEAL.unpack_from(state) != (
        _MARK,
        zlib.crc32(state[_SEAL.size :]),
    ):
        raise ComponentError("FMU state", [say("DAMAGED")])
    return state[_SEAL.size + _CLOCK.size :]


def _clock_problem(phase: int, time: float) -> str:
    """Return what no phase or time of a slave can be; empty if they can."""
    if phase not in [*Phase]:
        return say("IMPOSSIBLE_PHASE", phase)
    may_be_unknown = phase in (Phase.INSTANTIATED, Phase.FAILED) and math.isnan(time)
    if not math.isfinite(time) and not may_be_unknown:
        return say("IMPOSSIBLE_TIME", number(time))
    return ""


def _is_block(references: list[int]) -> bool:
    return bool(references) and references == list(
        range(references[0], references[0] + len(references))
    )


def _reader(buffer: Any, references: list[int]) -> Callable[[], list[float]]:
    """Return a function that lists the values at some places of the buffer."""
    if _is_block(references):
        return buffer[references[0] : references[0] + len(references)].tolist
    places = np.array(references)
    return lambda: buffer[places].tolist()


def _writer(buffer: Any, references: list[int]) -> Callable[[list[float]], None]:
    """Return a function that puts a list of values to some places of the buffer.

    ``pack_into`` is faster than assigning a slice.
    """
    if _is_block(references):
        pack = struct.Struct(f"{len(references)}d").pack_into
        place = references[0] * buffer.itemsize
        return lambda values: pack(buffer, place, *values)
    places = np.array(references)
    return lambda values: buffer.put(places, values)

"""Probes of variables: start values, reading, setting, wrong values, dependencies."""

import math
import struct
from collections.abc import Sequence

from ...core.errors import counted
from ..subject.calls import Called
from ..subject.subject import Subject
from ..subject.variables import Declared, Numbers, exactly, listed, not_finite
from ..verdicts import Seen, failed, not_applicable, passed, warned

_BEYOND_ALL = 10_000
"""Distance of a reference that no variable has from the largest one."""
_MOST_INPUTS = 5
"""Inputs that get values that are no numbers, and variables that are set beyond their range."""
_FIRM = ("parameter", "input")
"""Causalities of variables that keep their start value until they are set."""
_OTHER_TYPES = {2: ("Real", "Integer", "Boolean"), 3: ("Float64", "Int32", "Boolean")}


def _as_held(variable: Declared, values: Numbers) -> Numbers:
    """Return values as the type of a variable holds them."""
    if variable.kind != "Float32":
        return values
    return tuple(struct.unpack("f", struct.pack("f", value))[0] for value in values)


def starts(subject: Subject) -> Seen:
    """Compare what an initialised instance has with the start values of the description."""
    instance = subject.begun()
    told = [v for v in subject.readable if v.start is not None and not v.is_alias]
    values = exactly(instance.get(told))
    wrong = [v for v in told if values[v.name] != exactly({"": _as_held(v, v.start or ())})[""]]
    firm = [v for v in wrong if v.causality in _FIRM or v.variability == "constant"]
    if firm:
        return failed(
            f"another value than the start value that is told: {listed([v.name for v in firm])}",
            "tell the start value that the FMU has, or take the one that is told",
        )
    exact = [v.name for v in wrong if v.initial == "exact"]
    if exact:
        return warned(
            f"exact, and of another value after the initialisation: {listed(exact)}",
            "tell its value as start, or declare it as calculated",
        )
    return passed(f"{counted(len(told), 'variable')} begin with the start values that are told")


def read_back(subject: Subject) -> Seen:
    """Set parameters while initialising and inputs while running, and read them."""
    instance = subject.instantiate()
    instance.enter_initialisation(subject.start, subject.horizon)
    parameters = [v for v in subject.readable if v.causality == "parameter"]
    lost = _not_read_back(instance, parameters)
    running = subject.begun("running") if _may_have_two(subject) else None
    inputs = subject.inputs()
    if running is not None:
        lost += _not_read_back(running, inputs)
    if lost:
        return failed(f"read with another value than was set: {listed(lost)}", "keep what is set")
    told = f"{counted(len(parameters), 'parameter')}, {counted(len(inputs), 'input')}"
    return passed(f"read as they are set: {told}")


def _may_have_two(subject: Subject) -> bool:
    return not subject.can.canBeInstantiatedOnlyOncePerProcess


def _not_read_back(instance: Called, variables: Sequence[Declared]) -> list[str]:
    """Set each variable to another value, read it, and set it back."""
    lost = []
    for variable in variables:
        values = variable.other_start()
        if values is None or variable.start is None or variable.kind == "Binary":
            continue
        if instance.attempt(instance.set, variable, values).refused:
            continue
        held = exactly({"": _as_held(variable, values)})[""]
        if exactly(instance.get([variable]))[variable.name] != held:
            lost.append(variable.name)
        instance.set(variable, variable.start)
    return lost


def order(subject: Subject) -> Seen:
    """Read variables forwards, backwards, one by one and twice in one call."""
    instance = subject.begun()
    instance.step(subject.step)
    read = subject.readable
    forwards = exactly(instance.get(read))
    ways = {
        "backwards": exactly(instance.get(read[::-1])),
        "one by one": {k: v for each in read for k, v in exactly(instance.get([each])).items()},
        "every second one": exactly(instance.get(read[::2])),
        "in pairs with one left out": _in_pairs(instance, read),
    }
    for way, values in ways.items():
        if wrong := [name for name in values if values[name] != forwards[name]]:
            return failed(
                f"{listed(wrong)} has another value when variables are read {way}",
                "look every reference up: their order in a call is free",
            )
    return passed(f"{counted(len(read), 'variable')} read in several orders")


def _in_pairs(instance: Called, read: Sequence[Declared]) -> dict[str, tuple[str, ...]]:
    """Read each variable with the one behind the next in one call."""
    values: dict[str, tuple[str, ...]] = {}
    for one, other in zip(read, read[2:], strict=False):
        values |= exactly(instance.get([one, other]))
    return values


def unknown(subject: Subject) -> Seen:
    """Read and set references that no variable has."""
    accepted = []
    kinds = sorted({v.kind for v in subject.readable} - {"Binary", "String"})
    largest = max((int(v.valueReference) for v in subject.model.modelVariables), default=0)
    for kind in kinds:
        for reference in (min(largest + _BEYOND_ALL, 2**32 - 2), 2**32 - 1):
            for name in ("get_raw", "set_raw"):
                instance = subject.begun()
                last = 1 if name == "get_raw" else (0,)
                if not instance.attempt(getattr(instance, name), kind, [reference], last).refused:
                    accepted.append(f"{name.partition('_')[0]} of {kind} {reference}")
                instance.free()
    if accepted:
        return failed(
            f"references that no variable has are accepted: {listed(accepted)}",
            "return an error for a value reference that is not in the description",
        )
    if not kinds:
        return not_applicable("there is no variable")
    return passed("references that no variable has are refused")


def other_type(subject: Subject) -> Seen:
    """Read variables with the calls of another type."""
    known = {(v.kind, v.reference) for v in subject.variables}
    accepted = []
    for variable in _one_of_each_kind(subject):
        for kind in _OTHER_TYPES[subject.version]:
            if (kind, variable.reference) in known:
                continue
            instance = subject.begun()
            arguments = (kind, [variable.reference], variable.size)
            if not instance.attempt(instance.get_raw, *arguments).refused:
                accepted.append(f"{variable.name} ({variable.kind}) read as {kind}")
            instance.free()
    if accepted:
        return failed(
            f"calls of another type are accepted: {listed(accepted)}",
            "return an error for a variable of another type",
        )
    return passed("calls of another type than the variable's are refused")


def _one_of_each_kind(subject: Subject) -> list[Declared]:
    kinds: dict[str, Declared] = {}
    for variable in subject.readable:
        kinds.setdefault(variable.kind, variable)
    return list(kinds.values())


def _accepted(subject: Subject, variables: Sequence[Declared]) -> list[str]:
    """Return the names of variables that a running instance lets be set."""
    found = []
    for variable in variables:
        instance = subject.begun()
        values = (variable.other_start() if variable.start else None) or variable.start
        values = values or (0,) * variable.size
        if not instance.attempt(instance.set, variable, values).refused:
            found.append(variable.name)
        instance.free()
    return found


def read_only(subject: Subject) -> Seen:
    """Set outputs and constants of a running instance."""
    closed = [
        v
        for v in subject.readable
        if (v.causality == "output" or v.variability == "constant")
        and v.kind not in ("String", "Binary")
        and not v.is_alias
    ][:_MOST_INPUTS]
    if not closed:
        return not_applicable("there is no output and no constant")
    if found := _accepted(subject, closed):
        return warned(
            f"outputs or constants can be set: {listed(found)}",
            "return an error: who sets it believes that it has an effect",
        )
    return passed("outputs and constants are not set")


def fixed(subject: Subject) -> Seen:
    """Set fixed parameters of a running instance."""
    closed = [
        v
        for v in subject.readable
        if v.causality == "parameter" and v.variability == "fixed"
        if v.kind not in ("String", "Binary") and not v.is_alias
    ][:_MOST_INPUTS]
    if not closed:
        return not_applicable("there is no fixed parameter")
    if found := _accepted(subject, closed):
        return warned(
            f"fixed parameters can be set while running: {listed(found)}",
            "return an error, or declare it as tunable",
        )
    return passed("fixed parameters are not set while running")


def not_finite_inputs(subject: Subject) -> Seen:
    """Set inputs to values that are no finite numbers, step, reset, and step again."""
    inputs = subject.inputs(real=True)[:_MOST_INPUTS]
    if not inputs:
        return not_applicable("there is no real input")
    taken = []
    for variable in inputs:
        for value in (math.nan, math.inf):
            instance = subject.begun()
            if _passes_on(subject, instance, variable, value):
                taken.append(f"{variable.name} = {value}")
            if _stays_lost(subject, instance):
                return failed(
                    f"after {variable.name} = {value} and a reset values are not finite",
                    "set everything back to its start value",
                )
            instance.free()
    if taken:
        return warned(
            f"outputs are not finite after a step without error with {listed(taken)}",
            "refuse the value or the step: otherwise nobody knows where it came from",
        )
    return passed("NaN and infinity are refused, or do not reach the outputs")


def _passes_on(subject: Subject, instance: Called, variable: Declared, value: float) -> bool:
    """Tell whether a value reaches an output without any error."""
    if instance.attempt(instance.set, variable, (value,) * variable.size).refused:
        return False
    if instance.attempt(instance.step, subject.step).refused:
        return False
    return bool(not_finite(instance.get(subject.outputs)))


def _stays_lost(subject: Subject, instance: Called) -> bool:
    instance.reset()
    instance.initialise(subject.start, subject.horizon)
    instance.step(subject.step)
    return bool(not_finite(instance.get(subject.outputs)))


def out_of_range(subject: Subject) -> Seen:
    """Set inputs and parameters beyond the range that is declared for them."""
    tried = 0
    taken = []
    for variable in subject.readable:
        value = _beyond(variable)
        if value is None or tried >= _MOST_INPUTS:
            continue
        tried += 1
        instance = subject.instantiate()
        said = instance.attempt(instance.set, variable, (value,) * variable.size)
        later = instance.attempt(instance.initialise, subject.start, subject.horizon)
        heard = said.refused or later.refused or said.said or later.said
        if not heard:
            taken.append(f"{variable.name} = {value:g}")
        instance.free()
    if not tried:
        return not_applicable("no input and no parameter has a range")
    if taken:
        return warned(
            f"values beyond their range are accepted without a word: {listed(taken)}",
            "refuse the value, or warn of it",
        )
    return passed("values beyond the declared range are refused or warned of")


def _beyond(variable: Declared) -> float | None:
    """Return a value beyond the range of a variable that can be set; None without any."""
    if variable.causality not in ("parameter", "input") or not variable.is_real:
        return None
    if variable.highest is not None and variable.highest < 1e300:
        return variable.highest + max(1.0, abs(variable.highest))
    if variable.lowest is not None and variable.lowest > -1e300:
        return variable.lowest - max(1.0, abs(variable.lowest))
    return None


def length(subject: Subject) -> Seen:
    """Read variables of FMI 3.0 with more and with fewer values than they have."""
    accepted = []
    for variable in _one_of_each_kind(subject) + [v for v in subject.readable if v.size > 1][:3]:
        if variable.kind in ("String", "Binary"):
            continue
        for total in {variable.size + 1, variable.size - 1}:
            instance = subject.begun()
            arguments = (variable.kind, [variable.reference], total)
            if not instance.attempt(instance.get_raw, *arguments).refused:
                accepted.append(f"{total} values for the {variable.size} of {variable.name}")
            instance.free()
    if accepted:
        return failed(
            f"a wrong number of values is accepted: {listed(accepted)}",
            "compare nValues with the elements",
        )
    return passed("a wrong number of values is refused")

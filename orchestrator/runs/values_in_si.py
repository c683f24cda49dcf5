"""Values of a request as numbers in SI, wherever they may be given with a unit."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from rockshed.components.catalogue import component
from rockshed.components.common.ports import Kind, Variable

from ..cases.registry import Case
from ..core.errors import Problem
from ..core.fmu.description import Port
from ..core.fmu.fmu_slave import FmuFile
from ..core.fmu.slave import REAL, Source
from ..core.system.fields import ONE_VALUE, Value
from ..core.system.in_si import Descriptions, fmu_of
from ..core.system.quantities import in_si, in_unit, is_quantity
from ..core.system.system import SystemSpec
from ..input_files.quantities import doubt
from .request import Request


def case_in_si(
    request: Request, chosen: Case, problems: list[Problem], warnings: list[str]
) -> Request:
    """Return the request for a case with numbers in SI where numbers are meant.

    A case computes with its values before its FMUs are asked. Values beyond what is usual are
    warned of. Values that are shared are known when the case is made: :func:`shared_in_si`.

    Parameters
    ----------
    request : Request
        Its values are numbers, or texts with a unit.
    chosen : Case
        Declares them.
    problems : list of Problem
        Takes those of values that are none.
    warnings : list of str
        Takes doubts.
    """
    kept: dict[str, Value] = {}
    for name, value in request.values.items():
        owner, _, key = name.partition(".")
        if owner in chosen.models and key in component(chosen.models[owner]).sizes:
            problems.append(_a_size(name, value))
        elif not key and isinstance(value, str):
            kept[name] = value
        else:
            variable = _declared(chosen, owner, key)
            _keep(kept, name, value, variable, problems)
            warnings += _implausible(name, kept.get(name), variable)
    return replace(request, values=kept)


def shared_in_si(
    request: Request, chosen: Case, system: SystemSpec, problems: list[Problem]
) -> Request:
    """Return the request for a case with the values in SI that its parameters share.

    Parameters
    ----------
    request : Request
        Of :func:`case_in_si`.
    chosen : Case
        Declares the parameters.
    system : SystemSpec
        Of the case; says which parameters share a value.
    problems : list of Problem
        Takes those of values that are none.
    """
    kept: dict[str, Value] = {}
    for name, value in request.values.items():
        if name in system.shared and isinstance(value, str):
            owner, _, key = system.shared[name].targets[0].partition(".")
            _keep(kept, name, value, _declared(chosen, owner, key), problems)
        else:
            kept[name] = value
    return replace(request, values=kept)


def file_in_si(request: Request, system: SystemSpec, problems: list[Problem]) -> Request:
    """Return the request for a system file or SSP with its values in SI.

    Parameters
    ----------
    request : Request
        Its values are numbers, words, or texts with a unit.
    system : SystemSpec
        Its FMUs tell the units.
    problems : list of Problem
        Takes those of quantities that do not fit.
    """
    return replace(request, values=values_in_si(request.values, system, {}, problems))


def values_in_si(
    values: Mapping[str, Value],
    system: SystemSpec,
    sources: Mapping[str, Source],
    problems: list[Problem],
) -> dict[str, Value]:
    """Return values for a system in the units of its variables.

    Texts that are neither numbers nor quantities stay, and are refused with the rest of the system
    where no word is meant.

    Parameters
    ----------
    values : mapping of str to Value
        By ``component.variable`` or by the name of a shared value: numbers, words, or texts with a
        unit.
    system : SystemSpec
        With these components.
    sources : mapping of str to Source
        Components that are made without an FMU file.
    problems : list of Problem
        Takes those of quantities that do not fit.
    """
    known = Descriptions(system.components, source_in(sources))
    kept: dict[str, Value] = {}
    for name, value in values.items():
        shared = system.shared.get(name)
        target = shared.targets[0] if shared else name
        port = known.port(target) if _is_quantity(value) else None
        try:
            kept[name] = value_of_port(port, value)
        except ValueError as error:
            problems.append(_no_number(name, value, str(error), port.description if port else ""))
    return kept


def source_in(sources: Mapping[str, Source]) -> Callable[[str, Any], Source]:
    """Return the maker of the sources of a system: those that are given, else FMU files.

    Parameters
    ----------
    sources : mapping of str to Source
        Components that are made without an FMU file.
    """

    def source_of(component: str, entry: Any) -> Source:
        return sources.get(component) or FmuFile(Path(fmu_of(entry)), to_run=False)

    return source_of


def value_of_port(port: Port | None, value: Value) -> Value:
    """Return what a quantity is in the unit of a port; anything else as it is.

    Parameters
    ----------
    port : Port or None
        A variable of an FMU, if there is one.
    value : bool, int, float or str
        A text that begins as a number may have a unit.

    Raises
    ------
    ValueError
        The unit is of another kind, or does not exist.
    """
    if port is None or port.kind != REAL or not _is_quantity(value):
        return value
    return in_unit(str(value), port.unit)


def _is_quantity(value: Value) -> bool:
    return isinstance(value, str) and is_quantity(value)


def _keep(
    kept: dict[str, Value],
    name: str,
    value: Value,
    variable: Variable | None,
    problems: list[Problem],
) -> None:
    """Keep a value in SI, or tell why it is no number."""
    if variable is not None and variable.kind is not Kind.REAL:
        kept[name] = value
    elif reason := _why_no_number(value, variable):
        described = variable.description if variable else ""
        problems.append(_no_number(name, value, reason, described))
    elif isinstance(value, str) and variable is not None:
        kept[name] = in_si(value, variable.unit)
    else:
        kept[name] = value


def _no_number(name: str, value: object, reason: str, description: str) -> Problem:
    described = f" ({description})" if description else ""
    return Problem(name, f"{value!r}: {reason}", f"set {name}{described} to another value")


def _declared(chosen: Case, owner: str, key: str) -> Variable | None:
    """Return the variable of a component of a case; None if there is none of this name."""
    if owner not in chosen.models:
        return None
    variables = component(chosen.models[owner]).layout.variables
    return {v.name: v for v in variables}.get(key.partition("[")[0])


def _implausible(name: str, value: Value | None, variable: Variable | None) -> list[str]:
    """Return the warning of a value beyond what is usual, if it is."""
    if variable is None or variable.plausible is None or value is None:
        return []
    reason = doubt(float(value), variable.unit, variable.plausible)
    return [f"{name} {reason}"] if reason else []


def _a_size(name: str, value: object) -> Problem:
    what = "is a size, which an FMU is built with, and no parameter"
    return Problem(name, what, f"give {name} = {value} with sizes=...")


def _why_no_number(value: object, variable: Variable | None) -> str:
    if isinstance(value, list | tuple | dict):
        return ONE_VALUE
    try:
        if isinstance(value, str) and variable is not None:
            in_si(value, variable.unit)
        else:
            float(value)  # type: ignore[arg-type]
    except ValueError as error:
        return "must be a number" if variable is None else str(error)
    except OverflowError:  # an integer of hundreds of digits
        return "must be a finite number"
    except TypeError:
        return ONE_VALUE
    return ""

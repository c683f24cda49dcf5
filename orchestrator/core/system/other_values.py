"""A system with other values than it has."""

from collections.abc import Mapping

from ..errors import InputRefused, Problem
from .fields import Value, plain_value
from .names import matches, nearest, split_name
from .system import SystemSpec


def with_values(system: SystemSpec, values: Mapping[str, Value]) -> SystemSpec:
    """Return the system with other values.

    Parameters
    ----------
    system : SystemSpec
        Stays as it is.
    values : mapping of str to value
        By ``component.parameter`` or by the name of a shared value. A value that is shared changes
        for all its targets.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        No such component, or two different values for one shared value. Names of parameters are
        not checked here: only the FMU knows them.
    """
    parameters = {name: dict(spec.parameters) for name, spec in system.components.items()}
    shared: dict[str, dict[str, Value]] = {}
    problems = []
    for name, entry in values.items():
        try:
            value: Value = plain_value(entry)
        except ValueError as error:
            problems.append(Problem(name, str(error)))
            continue
        component, parameter = split_name(name, parameters)
        owner = _owner(system, name)
        if owner is not None:
            shared.setdefault(owner, {})[name] = value
        elif component in parameters and parameter:
            parameters[component][parameter] = value
        else:
            known = [*system.components, *system.shared]
            what = "is neither component.parameter nor a shared value"
            problems.append(Problem(name, what, nearest(component, known)))
    problems += [problem for key, given in shared.items() for problem in _one_value(key, given)]
    if problems:
        raise InputRefused(problems)
    components = {
        name: spec.model_copy(update={"parameters": parameters[name]})
        for name, spec in system.components.items()
    }
    replaced = {
        key: system.shared[key].model_copy(update={"value": next(iter(given.values()))})
        for key, given in shared.items()
    }
    return system.model_copy(
        update={"components": components, "shared": {**system.shared, **replaced}}
    )


def aliases(system: SystemSpec, name: str) -> set[str]:
    """Return the names under which a value can be given.

    Parameters
    ----------
    system : SystemSpec
        With its shared values.
    name : str
        ``component.parameter``, or the name of a shared value.

    Returns
    -------
    set of str
        The name itself; of a shared value also its own name and all its targets.
    """
    owner = _owner(system, name)
    return {name} if owner is None else {name, owner, *system.shared[owner].targets}


def _owner(system: SystemSpec, name: str) -> str | None:
    """Return the shared value that a name stands for or that its parameter takes."""
    for key, entry in system.shared.items():
        if name == key or any(matches(target, name) for target in entry.targets):
            return key
    return None


def _one_value(key: str, given: Mapping[str, Value]) -> list[Problem]:
    """Refuse several values for one shared value."""
    if len(set(map(str, given.values()))) <= 1:
        return []
    listed = ", ".join(f"{name} = {value}" for name, value in given.items())
    what = f"is one value for all its targets, and is given several: {listed}"
    return [Problem(key, what, "give one of them")]

"""Values of an input file as parameters of a component."""

from collections.abc import Callable
from typing import Any

from rockshed.components.common.component import Instance, value_problems

from ..core.errors import Problem
from ..core.system.names import nearest
from .places import Key, Places

Setting = Callable[[str, Any, Key], bool]
"""Takes name and value of a parameter and its place; returns whether the component accepts it."""


def setter(instance: Instance, where: Places, problems: list[Problem]) -> Setting:
    """Return a function that sets scalar parameters of a component.

    Parameters
    ----------
    instance : Instance
        Of the component, not yet initialised.
    where : Places
        Of the values in the file.
    problems : list of Problem
        Faults of values are appended, each with its place in the file.

    Returns
    -------
    Setting
        Of an array it checks the value only.
    """
    variables = {variable.name: variable for variable in instance.component.layout.variables}

    def set_(name: str, value: Any, key: Key) -> bool:
        variable = variables[name]
        if isinstance(value, str) and value not in variable.choices:
            remedy = nearest(value, variable.choices)
            problems.append(Problem(where.of(key), f"{name} = {value!r} is no choice", remedy))
            return False
        is_word = isinstance(value, str)
        number = float(variable.choices.index(value) + 1 if is_word else value)
        faults = value_problems(variable, name, number)
        problems.extend(Problem(where.of(key), text) for text in faults)
        if not faults and variable.size is None:
            instance[name] = number
        return not faults

    return set_

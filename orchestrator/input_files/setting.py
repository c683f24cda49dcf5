"""Values of an input file as parameters of a component."""

from collections.abc import Callable
from typing import Any

from rockshed.components.common.component import Instance, value_problems

from ..core.errors import Problem
from ..core.system.names import nearest
from .places import Path as Key
from .places import Places

Setting = Callable[[str, Any, Key], bool]
"""Takes the name of a parameter, its value and where that stands; tells whether the component takes it."""


def setter(made: Instance, where: Places, problems: list[Problem]) -> Setting:
    """Sets scalar parameters of a component, or says what is wrong with a value at its place in the file."""
    variables = {variable.name: variable for variable in made.component.layout.variables}

    def set_(name: str, value: Any, key: Key) -> bool:
        if isinstance(value, str) and value not in variables[name].choices:
            problems.append(
                Problem(
                    where.of(key),
                    f"{name} = {value!r} is no choice",
                    nearest(value, variables[name].choices),
                )
            )
            return False
        number = (
            float(variables[name].choices.index(value) + 1)
            if isinstance(value, str)
            else float(value)
        )
        found = value_problems(variables[name], name, number)
        problems.extend(Problem(where.of(key), text) for text in found)
        if not found and variables[name].size is None:
            made[name] = number
        return not found

    return set_

"""Variables of a run by their role, as the components declare it.

The roles: :mod:`rockshed.components.common.roles`. A component of another tool has none, and is
passed over.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.roles import Role

from ..core.results.reading import StoredRun


@dataclass(frozen=True)
class Member:
    """A variable that plays a role.

    Attributes
    ----------
    component : str
        Name of the component in the system.
    variable : str
        Name of the variable; of an array without the number of an element.
    role : Role
        Its role.
    label : str
        Its short name in legends.
    """

    component: str
    variable: str
    role: Role
    label: str

    @property
    def column(self) -> str:
        """Name of a scalar in the results."""
        return f"{self.component}.{self.variable}"


_ROLES = frozenset(map(str, Role))
"""All roles; results may name others, which a later version has."""


def members(run: StoredRun, role: Role) -> list[Member]:
    """Return the variables that are declared with a role, or with a kind of it.

    Parameters
    ----------
    run : StoredRun
        The run.
    role : Role
        The role that is asked for.

    Returns
    -------
    list of Member
        In the order of the components and their declarations, recorded or not.
    """
    return [
        Member(component, variable, Role(told["role"]), told.get("label", ""))
        for component, facts in run.provenance["components"].items()
        for variable, told in facts.get("variables", {}).items()
        if told.get("role") in _ROLES and role.includes(told["role"])
    ]


def members_of(run: StoredRun, component: str, role: Role) -> list[Member]:
    """Return the variables with a role that one component declares.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    role : Role
        The role that is asked for.
    """
    return [member for member in members(run, role) if member.component == component]


def recorded(run: StoredRun, role: Role) -> list[Member]:
    """Return the scalar outputs with a role that the results have.

    Parameters
    ----------
    run : StoredRun
        The run.
    role : Role
        The role that is asked for.
    """
    return [member for member in members(run, role) if member.column in run.series]


def column(run: StoredRun, component: str, role: Role) -> str | None:
    """Return the first recorded output of a component with a role; None if there is none.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    role : Role
        The role that is asked for.
    """
    return next((m.column for m in recorded(run, role) if m.component == component), None)


def owners(run: StoredRun, role: Role) -> list[str]:
    """Return the components that declare a variable with a role, each once.

    Parameters
    ----------
    run : StoredRun
        The run.
    role : Role
        The role that is asked for.
    """
    return list(dict.fromkeys(member.component for member in members(run, role)))


def elements(run: StoredRun, name: str) -> list[NDArray[np.float64]]:
    """Return the series of an array's elements, as far as they were recorded.

    Parameters
    ----------
    run : StoredRun
        The run.
    name : str
        ``component.variable`` of the array, without the number of an element.

    Returns
    -------
    list of array of float, shape (rows,)
        One for each element.
    """
    return [values for key, values in run.series.items() if key.startswith(f"{name}[")]


def all_samples(run: StoredRun, component: str, role: Role) -> NDArray[np.float64]:
    """Return the series of a component's outputs with a role, elements of arrays included.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    role : Role
        The role that is asked for.

    Returns
    -------
    array of float, shape (outputs, rows)
        Of those that were recorded.
    """
    columns = [member.column for member in members_of(run, component, role)]
    listed = [
        series
        for name in columns
        for series in ([run.series[name]] if name in run.series else elements(run, name))
    ]
    return np.array(listed).reshape(len(listed), run.series["time"].size)


def parameters(run: StoredRun, component: str) -> dict[str, Any]:
    """Return the values of a component's parameters by name.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    """
    told: Mapping[str, Any] = run.provenance["components"][component]["parameters"]
    return {name: entry["value"] for name, entry in told.items()}


def parameter(run: StoredRun, component: str, role: Role) -> Any:
    """Return the value of a component's parameter with a role; None if it has none.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    role : Role
        The role that is asked for.
    """
    values = parameters(run, component)
    named = [member.variable for member in members_of(run, component, role)]
    return next((values[name] for name in named if name in values), None)


def positive(run: StoredRun, component: str, role: Role) -> float | None:
    """Return the value of a component's parameter with a role, where it is a positive number.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    role : Role
        The role that is asked for.

    Returns
    -------
    float or None
        In SI units; None also where a damaged file has something else.
    """
    value = parameter(run, component, role)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and value > 0.0 else None

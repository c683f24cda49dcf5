"""Older names of variables: their values are taken for the present ones, with a warning."""

from collections.abc import Mapping

from ..errors import InputRefused, Problem
from ..fmu.description import Description
from .fields import Value


def present_name(description: Description, name: str) -> str:
    """Return the name that a variable has now; a name that is no older one stays.

    Parameters
    ----------
    description : Description
        Description of the component.
    name : str
        Name of a variable without the component; may be an array shorthand.
    """
    base, bracket, element = name.partition("[")
    if name in description.ports or base in description.ports:
        return name
    return description.renamed_bases.get(base, base) + bracket + element


def renaming_warning(component: str, old: str, new: str) -> str:
    """Return the sentence that tells a user of a name that has changed.

    Parameters
    ----------
    component : str
        Name of the component in the system.
    old, new : str
        Names of the variable.
    """
    return (
        f"{component}.{old} is called {component}.{new} now: use the new name, the old one will go"
    )


def with_present_names(
    values: Mapping[str, Value], renamed: Mapping[str, Mapping[str, str]]
) -> tuple[dict[str, Value], list[str]]:
    """Return values under the present names of their variables.

    Parameters
    ----------
    values : mapping of str to value
        By ``component.variable``; other names stay as they are.
    renamed : mapping of str to mapping of str to str
        By the name of the component in the system: present names of its variables by their older
        ones.

    Returns
    -------
    values : dict
        The same values in the same order.
    warnings : list of str
        A sentence for each older name.

    Raises
    ------
    InputRefused
        A variable is given different values under two names.
    """
    present: dict[str, Value] = {}
    warnings = []
    problems = []
    for name, value in values.items():
        component, _, variable = name.partition(".")
        base, bracket, element = variable.partition("[")
        new = renamed.get(component, {}).get(base, base) + bracket + element
        if new == variable:
            present[name] = value
            continue
        warnings.append(renaming_warning(component, variable, new))
        name_now = f"{component}.{new}"
        if values.get(name_now, value) != value:
            what = f"is the older name of {name_now}, and both are given"
            problems.append(Problem(name, what, "keep one of them"))
        present.setdefault(name_now, value)
    if problems:
        raise InputRefused(problems)
    return present, warnings

"""Whether FMUs say that they can go back to an earlier state."""

from collections.abc import Mapping

from ..errors import Problem
from ..fmu.description import Description


def rollback_problems(descriptions: Mapping[str, Description], wanted_by: str) -> list[Problem]:
    """Return which components say that they cannot go back.

    Parameters
    ----------
    descriptions : mapping of str to Description
        By component.
    wanted_by : str
        What needs it: ``the implicit master``.
    """
    what = "its FMU cannot go back to an earlier state (canGetAndSetFMUstate), and {} needs that"
    remedy = "choose another master, or export the FMU with it"
    return [
        Problem(name, what.format(wanted_by), remedy)
        for name, description in descriptions.items()
        if not description.keeps_state
    ]

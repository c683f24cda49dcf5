"""The case of a request: one of the catalogue, or one that is made of a project."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..cases.registry import Case, case, is_case
from ..core.errors import InputRefused, Problem
from ..core.system.fields import Value
from ..input_files.form import read_toml
from ..ssp.package import is_ssp
from .request import Request
from .target import wrong_target


@dataclass(frozen=True)
class Chosen:
    """The system that a request asks for.

    Attributes
    ----------
    case : Case or None
        None for a system file.
    request : Request
        With the values of components only.
    facts : mapping
        For the provenance: where it comes from.
    fields : mapping of str to Value
        Fields of a project that the request changes.
    """

    case: Case | None
    request: Request
    facts: Mapping[str, Any]
    fields: Mapping[str, Value] = field(default_factory=dict)


def choose(request: Request, problems: list[Problem]) -> Chosen:
    """Find the case of a request, or make it of a project.

    Parameters
    ----------
    request : Request
        The request.
    problems : list of Problem
        Of the caller, refused together with those seen here.

    Returns
    -------
    Chosen

    Raises
    ------
    InputRefused
        The target can be no system, there is no such case, or the project is refused.
    """
    if request.project is not None:
        return _of_project(request, request.project, problems)
    if not is_case(request.target) and (wrong := wrong_target(request.target)):
        raise InputRefused([*problems, wrong])
    if not request.is_file:
        try:
            found = case(request.target)
        except InputRefused as refusal:
            raise InputRefused([*problems, *refusal.problems]) from None
        return Chosen(found, request, {"case": found.name})
    if not is_ssp(request.target) and is_project_file(request.target):
        return _of_project(request, Path(request.target), problems)
    return Chosen(None, request, {"system_file": request.target})


def is_project_file(target: str) -> bool:
    """Tell whether a target is the file of a project.

    Parameters
    ----------
    target : str
        Path of a TOML file.

    Returns
    -------
    bool
        Whether it has a table of a project and no components, as a system has; False also where
        it cannot be read, which a system file is refused for.
    """
    try:
        content = read_toml(Path(target))[0]
    except InputRefused:
        return False
    meant = any(key in content for key in ("cushion", "roof"))
    return meant and not any(key in content for key in ("components", "hammer", "profile"))


def has_slope(target: str) -> bool:
    """Tell whether a target is the file of a project whose rock comes from a slope.

    Parameters
    ----------
    target : str
        Path of a TOML file.
    """
    return is_project_file(target) and "slope" in read_toml(Path(target))[0]


def _of_project(
    request: Request, project: Path | Mapping[str, Any], problems: list[Problem]
) -> Chosen:
    """Return the case of a project; values that name a field of it are part of it.

    Raises
    ------
    InputRefused
        The project, together with the problems of the caller.
    """
    # a project's models of its file take a tenth of the start of a run that has none
    from ..cases.shed import prepared, shed_case
    from ..sites.shed.preparation import is_field

    changes = {name: value for name, value in request.values.items() if is_field(name)}
    others = {name: value for name, value in request.values.items() if name not in changes}
    try:
        found = shed_case(prepared(project, changes))
    except InputRefused as refusal:
        raise InputRefused([*problems, *refusal.problems]) from None
    if request.sizes:
        remedy = "set numerics.disc_radius or numerics.elements"
        problems.append(Problem("sizes", "follow from the fields of a project", remedy))
    file = {"project_file": str(project)} if isinstance(project, Path) else {}
    return Chosen(found, replace(request, values=others, sizes={}), file, changes)

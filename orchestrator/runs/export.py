"""Systems as files: the TOML that ``rockshed run`` takes, alone or with its FMUs, and SSPs."""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.fmu.description import Port
from ..core.fmu.slave import Source
from ..core.run import sources_of
from ..core.system.parts import Connection
from ..core.system.plan import Plan
from ..core.system.planning import make_plan
from ..core.system.system import SystemSpec
from ..temporary import TemporaryFolder
from .job import Job
from .target import SYSTEM


def system_text(system: SystemSpec) -> str:
    """Return a system as TOML; keys that have their defaults are left out.

    Parameters
    ----------
    system : SystemSpec
        The system.

    Returns
    -------
    str
        Content of a system file.
    """
    data = system.model_dump(mode="json", exclude_defaults=True)
    data["connections"] = [_connection(c) for c in system.connections]
    tables = {key: value for key, value in data.items() if isinstance(value, dict)}
    return tomli_w.dumps(
        {**{key: value for key, value in data.items() if key not in tables}, **tables},
        multiline_strings=False,
    )


def _connection(connection: Connection) -> str | dict[str, Any]:
    if connection.is_linear:
        return connection.model_dump(exclude_defaults=True)
    return str(connection)


def export_system(
    system: SystemSpec, folder: Path, sources: Mapping[str, Source] | None = None
) -> Path:
    """Write ``system.toml`` and the FMUs of a system into a folder.

    Parameters
    ----------
    system : SystemSpec
        The system.
    folder : Path
        A new or empty folder.
    sources : mapping of str to Source, optional
        Components that are made without an FMU file; they become FMUs with Python inside.

    Returns
    -------
    Path
        The system file.

    Raises
    ------
    InputRefused
        The folder holds something, or cannot be written.
    """
    refuse_place(folder)
    with refusing_unwritable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        specs = {
            name: spec.model_copy(update={"fmu": _store(name, spec.fmu, folder, sources or {})})
            for name, spec in system.components.items()
        }
        text = system_text(system.model_copy(update={"components": specs}))
        (folder / SYSTEM).write_text(text, encoding="utf-8")
    return folder / SYSTEM


def is_ssp_name(place: Path) -> bool:
    """Tell whether an export to a place becomes an SSP, by the end of its name."""
    return place.suffix.lower() == ".ssp"


def refuse_place(place: Path, version: str | None = None) -> None:
    """Refuse a place of an export that holds something, or a version that it cannot have.

    Parameters
    ----------
    place : Path
        A new SSP, or a new or empty folder.
    version : str, optional
        Of the SSP.

    Raises
    ------
    InputRefused
        With all that is wrong.
    """
    from ..ssp.documents import VERSIONS

    problems = []
    if version is not None and not is_ssp_name(place):
        what = "is to be an SSP, and is a folder"
        problems.append(Problem(str(place), what, "name a file that ends in .ssp"))
    elif version not in (None, *VERSIONS):
        choice = f"choose one of {', '.join(VERSIONS)}"
        problems.append(Problem("ssp", f"{version!r} is unknown", choice))
    if is_ssp_name(place) and place.exists():
        problems.append(Problem(str(place), "is there already, and stays", "name a new file"))
    elif place.exists() and (not place.is_dir() or any(place.iterdir())):
        reason = "is not empty" if place.is_dir() else "is a file"
        problems.append(Problem(str(place), reason, "name a new or empty folder"))
    if problems:
        raise InputRefused(problems)


def export_ssp(job: Job, file: Path, version: str | None = None) -> Path:
    """Write a system as an SSP; one that was read from an SSP keeps everything that is in it.

    Parameters
    ----------
    job : Job
        The system.
    file : Path
        A new file.
    version : str, optional
        ``1.0`` or ``2.0``, by default that of the SSP that it was read from, else 1.0.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputRefused
        There is such a file, it cannot be written, or the version is unknown.
    """
    from ..ssp.documents import VERSIONS
    from ..ssp.rewriting import rewrite_ssp
    from ..ssp.writing import write_ssp

    refuse_place(file, version)  # before FMUs are made
    if job.system.scenario:
        remedy = "write a system file (a folder), or take the scenario out"
        raise InputRefused([Problem("scenario", "has no place in an SSP", remedy)])
    with job.refused_in_place():
        plan = make_plan(job.system, {**sources_of(job.system, to_run=False), **job.sources})
    if job.ssp is not None:
        rewrite_ssp(job.ssp, plan, _changes(job.ssp.system, plan), file, version)
        return file
    with TemporaryFolder() as folder:
        made = {
            name: folder / _store(name, spec.fmu, folder, job.sources)
            for name, spec in job.system.components.items()
        }
        write_ssp(plan, made, file, version or VERSIONS[0])
    return file


def _changes(before: SystemSpec, plan: Plan) -> list[tuple[str, Port, float | str]]:
    """Return the values of a plan that are other than those of a system."""
    known = make_plan(before, sources_of(before, to_run=False)).starts
    told = {name: {port.name: value for port, value in known[name]} for name in known}
    return [
        (name, port, value)
        for name, starts in plan.starts.items()
        for port, value in starts
        if told[name].get(port.name) != value
    ]


def _store(name: str, fmu: str, folder: Path, sources: Mapping[str, Source]) -> str:
    """Write the FMU of a component into a folder; return the name of its file."""
    from rockshed.fmus.in_process import InProcess  # imports pythonfmu, which copying does not need

    source = sources.get(name)
    if isinstance(source, InProcess):
        from rockshed.fmus.build import build_component

        try:
            return build_component(source.component, source.sizes, folder).name
        finally:
            (folder / ".lock").unlink(missing_ok=True)  # nobody else builds into this new folder
    file = Path(fmu)
    copy = folder / file.name
    if copy.exists() and copy.read_bytes() != file.read_bytes():  # of the other runtime
        copy = folder / f"{name}-{file.name}"
    shutil.copyfile(file, copy)
    return copy.name

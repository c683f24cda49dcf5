"""Provenance of a run: files, versions, parameters."""

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from ...versions import versions
from ..errors import Problem
from ..fmu.access import read_values
from ..fmu.description import SIZE, Description
from ..fmu.slave import Slave, Source
from ..system.plan import Plan
from ..system.values import written

_PACKAGES = ("numpy", "numba", "llvmlite", "fmpy", "pythonfmu", "pyarrow", "h5py")


def describe_run(
    plan: Plan, sources: Mapping[str, Source], slaves: Mapping[str, Slave]
) -> dict[str, Any]:
    """Describe a run before its first step, as plain data.

    Parameters
    ----------
    plan : Plan
        The system as it is run.
    sources : mapping of str to Source
        Makers of the slaves.
    slaves : mapping of str to Slave
        Initialised: their parameters are read.

    Returns
    -------
    dict
        For ``run.json``.
    """
    return {
        "name": plan.system.name,
        "started": datetime.now(UTC).isoformat(),
        "components": {name: _component(plan, sources[name], slaves[name]) for name in plan.order},
        "system": plan.system.model_dump(mode="json"),
        "loops": list(plan.loops),
        "versions": versions(*_PACKAGES),
        "platform": platform.platform(),
    }


def _component(plan: Plan, source: Source, slave: Slave) -> dict[str, Any]:
    description = plan.descriptions[slave.name]
    return {
        **source.origin,
        "model": description.model,
        "guid": description.guid,
        "generation_tool": description.generation_tool,
        **declarations(description),
        "parameters": _parameters(plan, slave),
    }


_COMPUTING = ("python", "rockshed", "numpy", "numba", "llvmlite", "fmpy", "pythonfmu")
"""Programs and packages from which the bits of a run may follow, besides the FMUs."""


def program_problems(provenance: Mapping[str, Any], remedy: str) -> list[Problem]:
    """Return the programs of a run that are others here.

    Parameters
    ----------
    provenance : mapping
        Content of its ``run.json``.
    remedy : str
        Something to do about it, besides having the same versions.

    Returns
    -------
    list of Problem
    """
    then = provenance.get("versions") or {}
    now = versions(*_PACKAGES)
    return [
        Problem(
            name,
            f"the run was computed with {then.get(name)}, and this is {now.get(name)}",
            f"install that version, or {remedy}",
        )
        for name in _COMPUTING
        if then.get(name) != now.get(name)
    ]


def source_problems(
    name: str, provenance: Mapping[str, Any], source: Source, remedy: str
) -> list[Problem]:
    """Return what is other about the FMU of a component than in a run.

    Parameters
    ----------
    name : str
        Of the component.
    provenance : mapping
        Content of the ``run.json`` of the run.
    source : Source
        Whose description has been read.
    remedy : str
        Something to do about it, besides having the same FMU.

    Returns
    -------
    list of Problem
        Empty where its content is the same, wherever the file lies.
    """
    known = (provenance.get("components") or {}).get(name) or {}
    for key, value in source.origin.items():
        if key == "fmu" or known.get(key) == value:
            continue
        what = f"its {key} is {value[:16]}, and was {str(known.get(key))[:16]} in the run"
        place = source.origin.get("fmu", source.origin.get("component", ""))
        return [Problem(f"{name}: {place}", what, f"put the same one there, or {remedy}")]
    return []


def declarations(description: Description) -> dict[str, Any]:
    """Return what a component declares of itself for metrics and pictures.

    Parameters
    ----------
    description : Description
        Its description.

    Returns
    -------
    dict
        ``contents`` of its states, ``pictures``, and ``variables``: roles, labels and figures of
        those
        that have any; of an array once, without the number of an element.
    """
    variables = {
        port.name.partition("[")[0]: data
        for port in description.ports.values()
        if (data := port.annotation.as_data())
    }
    pictures = list(description.pictures)
    return {"contents": description.contents, "pictures": pictures, "variables": variables}


def _parameters(plan: Plan, slave: Slave) -> dict[str, Any]:
    """Read the values of all parameters from the slave; of strings, those that were set."""
    found: dict[str, Any] = {
        port.name: {"value": value}
        for port, value in plan.starts[slave.name]
        if isinstance(value, str)
    }
    known = plan.descriptions[slave.name]
    ports = [port for port in known.named(SIZE) + known.named("parameter") if port.is_number]
    _, values = read_values(slave, ports)
    for port, value in zip(ports, values, strict=True):
        found[port.name] = {"value": written(port, value), "unit": port.unit_name}
    return found

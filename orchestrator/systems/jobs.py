"""A system made ready for any master: FMUs, SSPs, and the same as plain data."""

import json
import os
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from rockshed.fmus.build import BuildError, Fmi, Runtime, build_component

from ..core.errors import InputRefused, Problem
from ..core.fmu.description import Port
from ..core.fmu.slave import BOOLEAN, INTEGER, Source
from ..core.run import sources_of
from ..core.system.iteration import IteratedConnection, Iteration
from ..core.system.plan import End, Plan
from ..core.system.planning import make_plan
from ..core.system.system import SystemSpec
from ..ssp.links import linked
from ..ssp.package import MAIN
from ..ssp.writing import MULTI_RATE, write_ssp
from .system import ExchangeOrder, FmuPart, ImpactSystem

SSP_OF = {Fmi.TWO: "1.0", Fmi.THREE: "2.0"}
"""Version of SSP that goes with a version of FMI."""


@dataclass(frozen=True)
class FmuKind:
    """FMUs of one kind.

    Attributes
    ----------
    fmi : Fmi
        Version of FMI.
    runtime : Runtime
        Native, or with Python inside.
    """

    fmi: Fmi
    runtime: Runtime

    @property
    def name(self) -> str:
        """Name of a folder: ``fmi2-native``."""
        return f"fmi{self.fmi.value}-{self.runtime.value}"


NATIVE = FmuKind(Fmi.TWO, Runtime.NATIVE)
VARIANTS = (NATIVE, FmuKind(Fmi.THREE, Runtime.NATIVE), FmuKind(Fmi.TWO, Runtime.PYTHON))
"""All kinds of FMUs that there are."""


def build_parts(
    system: ImpactSystem,
    folder: Path,
    variant: FmuKind = NATIVE,
    note: Callable[[str], None] = lambda text: None,
) -> dict[str, str]:
    """Build the FMUs of a system into a folder.

    Parameters
    ----------
    system : ImpactSystem
        The system.
    folder : Path
        Where they go; what is there already and the same stays.
    variant : FmuKind
        Kind of FMUs.
    note : callable
        Called with a line for each FMU.

    Returns
    -------
    dict of str to str
        FmuPaths by the component of the system.

    Raises
    ------
    InputRefused
        They cannot be built.
    """
    made: dict[str, str] = {}
    for name, part in system.parts.items():
        note(f"{system.name}: {part.component.name}")
        made[name] = str(_built(part, folder, variant))
    (folder / ".lock").unlink(missing_ok=True)
    return made


def _built(part: FmuPart, folder: Path, variant: FmuKind) -> Path:
    try:
        return build_component(
            part.component,
            part.sizes,
            folder,
            keep=True,
            runtime=variant.runtime,
            fmi=variant.fmi,
        )
    except BuildError as error:
        remedy = "install a C compiler, or `pip install ziglang`; name a folder that can be written"
        raise InputRefused([Problem(part.component.name, str(error), remedy)]) from error


def watched(system: ImpactSystem) -> list[tuple[str, str]]:
    """Return component and port of the outputs that are compared or added up."""
    names = dict.fromkeys((system.quantity, *system.energies))
    return [(name.partition(".")[0], name.partition(".")[2]) for name in names]


def planned(
    system: ImpactSystem,
    files: Mapping[str, str],
    step: float,
    master: ExchangeOrder,
    options: Mapping[str, Any] = MappingProxyType({}),
    sources: Mapping[str, Source] | None = None,
) -> Plan:
    """Return the plan of a system, with every row and what is watched in its results.

    Parameters
    ----------
    system : ImpactSystem
        The system.
    files : mapping of str to str
        FMUs by component.
    step : float
        Exchange step (s).
    master : ExchangeOrder
        Order of an exchange; of the implicit one, inputs have the moments of the system.
    options : mapping
        Further keys of the system.
    sources : mapping of str to Source, optional
        What takes the place of the files.

    Returns
    -------
    Plan

    Raises
    ------
    InputRefused
        The system does not fit its FMUs.
    """
    made = system.make(files, step, master)
    if master == "implicit":
        entries = [IteratedConnection(target=name, input=m) for name, m in system.moments.items()]
        made = made.model_copy(update={"iteration": Iteration(connections=entries)})
    record = [".".join(port) for port in watched(system)]
    made = made.model_copy(update={"record": record, "output_interval": step, **options})
    return make_plan(made, sources or sources_of(made))


def write_job(
    system: ImpactSystem,
    plan: Plan,
    files: Mapping[str, str],
    folder: Path,
    facts: Mapping[str, Any] = MappingProxyType({}),
) -> Path:
    """Write SSPs and job of a system into a folder.

    Parameters
    ----------
    system : ImpactSystem
        The system.
    plan : Plan
        Of :func:`planned`.
    files : mapping of str to str
        FMUs by component; those in the folder are told relative to it.
    folder : Path
        Where they go.
    facts : mapping
        Further entries of the job, for a master.

    Returns
    -------
    Path
        The job, ``job.json``.

    Raises
    ------
    InputRefused
        There are such SSPs already, or they cannot be written.
    """
    version = ssp_version(plan)
    ssp, multi_rate = folder / f"{system.name}.ssp", folder / f"{system.name}-multi-rate.ssp"
    write_ssp(plan, {n: Path(f) for n, f in files.items()}, ssp, version, shown(plan, system))
    with zipfile.ZipFile(ssp) as archive, zipfile.ZipFile(multi_rate, "w") as other:
        for name in archive.namelist():
            if name != MULTI_RATE:
                other.writestr(name, archive.read(MULTI_RATE if name == MAIN else name))
    told = {name: os.path.relpath(file, folder) for name, file in files.items()}
    content = {**as_data(system, plan, told), "ssp": ssp.name, "multi_rate_ssp": multi_rate.name}
    place = folder / "job.json"
    place.write_text(json.dumps({**content, **facts}, indent=1), encoding="utf-8")
    return place


def ssp_version(plan: Plan) -> str:
    """Return the version of SSP that the FMUs of a plan need."""
    is_fmi_3 = any(known.is_fmi_3 for known in plan.descriptions.values())
    return SSP_OF[Fmi.THREE if is_fmi_3 else Fmi.TWO]


def as_data(system: ImpactSystem, plan: Plan, files: Mapping[str, str]) -> dict[str, Any]:
    """Return a planned system as plain data: FMUs, steps, connections, values."""
    spec: SystemSpec = plan.system
    version = ssp_version(plan)
    whole = [
        (j.source.component, j.source.port.array, j.target.component, j.target.port.array)
        for j in linked(plan, version)
    ]
    return {
        "name": system.name,
        "fmi": "3.0" if version == SSP_OF[Fmi.THREE] else "2.0",
        "fmus": dict(files),
        "order": list(plan.order),
        "step": spec.exchange_step,
        "exchanges": round(spec.stop_time / spec.exchange_step),
        "steps": {name: spec.step(name) for name in spec.components},
        "connections": [
            (source.component, source.port.name, target.component, target.port.name)
            for _, target, source in plan.fed
        ],
        "whole_connections": whole,
        "starts": {name: _values(plan.starts[name]) for name in spec.components},
        "watch": watched(system),
    }


def shown(plan: Plan, system: ImpactSystem) -> list[End]:
    """Return the watched outputs, which become connectors of the SSP without a connection."""
    return [End(name, plan.descriptions[name].ports[port]) for name, port in watched(system)]


def _values(starts: list[tuple[Port, float | str]]) -> dict[str, bool | int | float | str]:
    """Return values by name, whole numbers and truths as such."""
    return {port.name: _plain(port, value) for port, value in starts}


def _plain(port: Port, value: float | str) -> bool | int | float | str:
    if isinstance(value, str):
        return value
    if port.kind == BOOLEAN:
        return bool(value)
    return int(value) if port.kind == INTEGER else float(value)

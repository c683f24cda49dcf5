"""The masters that are measured: a row each."""

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

from ...core.system.adaptivity import Adaptive
from ...core.system.iteration import Iteration
from ..system import ExchangeOrder, ImpactSystem

PEERS = Path(__file__).with_name("peers.py")
OURS = Path(__file__).with_name("ours.py")
ENVIRONMENT = "ROCKSHED_PEER_"
"""Beginning of environment variables that name the Python of a tool: ``ROCKSHED_PEER_COFMUPY``."""


Options = Callable[[ImpactSystem, float], Mapping[str, Any]]
"""Returns further keys of a system of this program, for an exchange step (s)."""


def nothing(_system: ImpactSystem, _step: float) -> Mapping[str, Any]:
    """Return no keys, for a master that has all that it needs from the system."""
    return {}


def with_lines(_system: ImpactSystem, _step: float) -> Mapping[str, Any]:
    """Return the keys for inputs that follow lines between exchanges."""
    return {"extrapolation": 1}


def with_ends(_system: ImpactSystem, _step: float) -> Mapping[str, Any]:
    """Return the keys for inputs that have the values of the end of the exchange, all of them."""
    return {"iteration": Iteration()}


def adaptive(
    control: Literal["doubling", "ledger"], system: ImpactSystem, step: float
) -> Mapping[str, Any]:
    """Return the keys for an exchange step that follows the error: a step, its half, its quarter.

    Parameters
    ----------
    control : str
        Of the step.
    system : ImpactSystem
        The system.
    step : float
        Exchange step (s), the longest, and the time between two rows. The tolerance is 0.1, that of
        the ledger 0.01, at the coarsest step, and goes down as errors of an exchange do: with the
        step, energies with its square.
    """
    part = step / system.steps[0]
    tolerance = 0.1 * part if control == "doubling" else 0.01 * part**2
    made = Adaptive(tolerance=tolerance, largest_step=step, control=control)
    return {"exchange_step": step / 4.0, "adaptive": made}


@dataclass(frozen=True)
class MasterRow:
    """A master algorithm of a tool.

    Attributes
    ----------
    name : str
        Row of the tables.
    tool : str
        What runs it: a tool of ``peers.py``, or ``rockshed``.
    package : str
        Distribution that has to be installed.
    scheme : str
        The algorithm, in the words of the tool's own configuration.
    how : str
        How it is used.
    given : ExchangeOrder
        ExchangeOrder of our systems that describes it: values of parameters may follow from it.
    options : callable
        Further keys of a system of this program.
    """

    name: str
    tool: str
    package: str
    scheme: str
    how: str
    given: ExchangeOrder = "jacobi"
    options: Options = nothing


MASTERS = (
    MasterRow(
        "rockshed, sequential",
        "rockshed",
        "rockshed",
        "sequential",
        "its system, forces first",
        "sequential",
    ),
    MasterRow("rockshed, jacobi", "rockshed", "rockshed", "jacobi", "its system, all at once"),
    MasterRow(
        "rockshed, sequential, lines",
        "rockshed",
        "rockshed",
        "sequential",
        "its system, forces first, `extrapolation = 1`",
        "sequential",
        with_lines,
    ),
    MasterRow(
        "rockshed, adaptive",
        "rockshed",
        "rockshed",
        "sequential",
        "its system, `[adaptive]` with `doubling`: half of the exchange step or a quarter",
        "sequential",
        partial(adaptive, "doubling"),
    ),
    MasterRow(
        "rockshed, adaptive, ledger",
        "rockshed",
        "rockshed",
        "sequential",
        "`[adaptive]` with `ledger`: the exchange step, its half or its quarter",
        "sequential",
        partial(adaptive, "ledger"),
    ),
    MasterRow(
        "rockshed, implicit",
        "rockshed",
        "rockshed",
        "implicit",
        "its system, exchanges repeated until all values fit; inputs of the moments that the "
        "system's page derives",
        "implicit",
    ),
    MasterRow(
        "rockshed, implicit, end",
        "rockshed",
        "rockshed",
        "implicit",
        "the same with the values of the end for all inputs, the default",
        "implicit",
        with_ends,
    ),
    MasterRow(
        "libcosim",
        "libcosim",
        "libcosimpy",
        "fixed step",
        "`CosimExecution.from_ssp_file` of `MultiRate.ssd`",
    ),
    MasterRow(
        "ecos", "ecos", "ecospy", "fixed step", "`EcosSimulationStructure`, a step hint each"
    ),
    MasterRow("ecos, SSP", "ecos-ssp", "ecospy", "fixed step", "`EcosSimulation(ssp_path=...)`"),
    MasterRow(
        "fmpy, slaves",
        "fmpy",
        "fmpy",
        "jacobi",
        "a loop of one's own around its slaves, as its examples have it",
    ),
    MasterRow(
        "fmpy, simulate_ssp", "fmpy-ssp", "fmpy", "jacobi", "`fmpy.ssp.simulation.simulate_ssp`"
    ),
    MasterRow(
        "FMU container",
        "container",
        "fmu-manipulation-toolbox",
        "jacobi",
        "`fmucontainer`, the container stepped by fmpy",
    ),
    MasterRow(
        "FMU container, sequential",
        "container",
        "fmu-manipulation-toolbox",
        "sequential",
        "`fmucontainer` with `sequential`",
        "sequential",
    ),
    MasterRow("CoFmuPy, jacobi", "cofmupy", "cofmupy", "jacobi", "`Coordinator`, `jacobi`"),
    MasterRow(
        "CoFmuPy, gauss_seidel",
        "cofmupy",
        "cofmupy",
        "gauss-seidel",
        "`Coordinator`, `gauss_seidel`",
        "sequential",
    ),
    MasterRow(
        "CoFmuPy, iterative",
        "cofmupy",
        "cofmupy",
        "iterative-jacobi",
        "`Coordinator`, `jacobi`, `iterative`",
    ),
    MasterRow("OMSimulator", "omsimulator", "OMSimulator", "oms-ma", "its package for Python"),
)
"""Every master, in the order of the tables."""

CANNOT_BE_HAD = {
    "omsimulator": "its package on PyPI is a source whose build downloads the program from "
    "build.openmodelica.org; without that server it cannot be installed"
}
"""Tools that `bench systems` knows no way to run, and why."""


def python_of(master: MasterRow) -> str:
    """Return the Python that has a tool: this one, or that of its environment variable."""
    return os.environ.get(f"{ENVIRONMENT}{master.tool.upper().replace('-', '_')}", sys.executable)


def version_in(python: str, package: str) -> str | None:
    """Return the version of a package in a Python, None where it is not installed."""
    code = f"from importlib.metadata import version; print(version({package!r}))"
    found = subprocess.run([python, "-c", code], capture_output=True, text=True, check=False)
    return found.stdout.strip() if found.returncode == 0 else None


def versions() -> Mapping[str, str | None]:
    """Return the versions of all packages, None of those that are not installed."""
    pythons = {master.package: python_of(master) for master in MASTERS}
    return {package: version_in(python, package) for package, python in pythons.items()}

"""The masters that are measured: a row each."""

import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...core.system.schedule import Scheme

PEERS = Path(__file__).with_name("peers.py")
OURS = Path(__file__).with_name("ours.py")
ENVIRONMENT = "ROCKSHED_PEER_"
"""Beginning of environment variables that name the Python of a tool: ``ROCKSHED_PEER_COFMUPY``."""


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
    given : Scheme
        Scheme of our systems that describes it: values of parameters may follow from it.
    options : mapping
        Further keys of a system of this program.
    """

    name: str
    tool: str
    package: str
    scheme: str
    how: str
    given: Scheme = "jacobi"
    options: Mapping[str, Any] = field(default_factory=dict)


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
        {"extrapolation": 1},
    ),
    MasterRow(
        "rockshed, implicit",
        "rockshed",
        "rockshed",
        "implicit",
        "its system, exchanges repeated until all values fit",
        "jacobi",
        {"master": "implicit"},
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

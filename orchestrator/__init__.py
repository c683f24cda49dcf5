"""Rockfall protection as FMI co-simulation: falling rock, sand cushion and beam as FMUs.

>>> import rockshed
>>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
>>> run = rockshed.simulate(system)
>>> run["rock.velocity.y"].unit
'm/s'

Names are imported when they are first used, so that ``import rockshed`` takes no time.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import formulas
    from .analyses.back_analysis.run import calibrate_rockfall
    from .analyses.calibration.run import calibrate
    from .analyses.convergence.run import converge
    from .analyses.exchange_steps.run import converge_exchange
    from .analyses.pile.run import pile
    from .analyses.pile_matching.run import match_pile
    from .analyses.resuming import resume
    from .analyses.rockfall.run import rockfall
    from .analyses.study.factors import Interval, RandomValue
    from .analyses.study.run import StudyFailed, study
    from .analyses.study.variants import branches
    from .checking.check import check_fmu
    from .components.common.component import ComponentError
    from .core.errors import InputRefused, Problem, RunDoubted, RunFailed, UnknownName
    from .pages.writing import page
    from .reports.writing import report
    from .runs.alone import alone
    from .runs.building import build_fmu
    from .runs.catalogue import list_cases, list_components
    from .runs.continuing import branch
    from .runs.projects import shed
    from .runs.run import Run, read_run
    from .runs.simulation import simulate
    from .runs.subsystem import Subsystem, component
    from .runs.system import System, case
    from .runs.verification import verify
    from .tables import Table

    __version__: str

_HOMES = {
    "alone": "runs.alone",
    "ComponentError": "components.common.component",
    "InputRefused": "core.errors",
    "Interval": "analyses.study.factors",
    "Problem": "core.errors",
    "RandomValue": "analyses.study.factors",
    "Run": "runs.run",
    "RunDoubted": "core.errors",
    "RunFailed": "core.errors",
    "StudyFailed": "analyses.study.run",
    "Subsystem": "runs.subsystem",
    "System": "runs.system",
    "Table": "tables",
    "UnknownName": "core.errors",
    "build_fmu": "runs.building",
    "calibrate": "analyses.calibration.run",
    "calibrate_rockfall": "analyses.back_analysis.run",
    "check_fmu": "checking.check",
    "converge": "analyses.convergence.run",
    "converge_exchange": "analyses.exchange_steps.run",
    "case": "runs.system",
    "component": "runs.subsystem",
    "list_cases": "runs.catalogue",
    "list_components": "runs.catalogue",
    "match_pile": "analyses.pile_matching.run",
    "page": "pages.writing",
    "pile": "analyses.pile.run",
    "read_run": "runs.run",
    "report": "reports.writing",
    "branch": "runs.continuing",
    "branches": "analyses.study.variants",
    "resume": "analyses.resuming",
    "verify": "runs.verification",
    "rockfall": "analyses.rockfall.run",
    "shed": "runs.projects",
    "simulate": "runs.simulation",
    "study": "analyses.study.run",
}
"""Modules of the public names."""
_ROOMS = ("formulas",)
"""Packages whose names are public under theirs."""

__all__ = [
    "ComponentError",
    "InputRefused",
    "Interval",
    "Problem",
    "RandomValue",
    "Run",
    "RunDoubted",
    "RunFailed",
    "StudyFailed",
    "Subsystem",
    "System",
    "Table",
    "UnknownName",
    "__version__",
    "alone",
    "branch",
    "branches",
    "build_fmu",
    "calibrate",
    "calibrate_rockfall",
    "case",
    "check_fmu",
    "component",
    "converge",
    "converge_exchange",
    "formulas",
    "list_cases",
    "list_components",
    "match_pile",
    "page",
    "pile",
    "read_run",
    "report",
    "resume",
    "rockfall",
    "shed",
    "simulate",
    "study",
    "verify",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("rockshed")
    if name in _ROOMS:
        return import_module(f".{name}", __name__)
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)

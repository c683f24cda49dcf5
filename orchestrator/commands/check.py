"""The command ``rockshed check``: what an FMU declares, and what it does when it is called."""

from pathlib import Path
from typing import Annotated

import typer

from ..checking.check import TIME_LIMIT, check_fmu
from ..checking.junit import junit
from ..core.errors import InputRefused, Problem, all_causes, refusing_unwritable
from ..core.fmu.fmu_slave import FmuFile
from ..files import write_file
from .analysis import options_named
from .options import Json, Quiet, simulated_time
from .screen import CHECK_FAILED, opened

_Fmu = Annotated[
    Path, typer.Argument(metavar="FMU", help="An FMU of FMI 2.0 or 3.0 for co-simulation.")
]
_Probes = Annotated[
    list[str] | None,
    typer.Option(
        "--probe",
        metavar="NAME",
        help="This probe or theme alone, with those that it needs: state/rollback, state. May be "
        "repeated.",
    ),
]
_StepSize = Annotated[
    float | None,
    simulated_time("Communication step; by default that of the FMU's description."),
]
_TimeLimit = Annotated[float, simulated_time("Time after which a process of a probe is ended.")]
_JUnit = Annotated[
    Path | None, typer.Option("--junit", metavar="FILE", help="Write the result as JUnit XML too.")
]

_HEAD = 1000
"""Bytes within which JUnit XML is known by its element."""


def command(
    fmu: _Fmu,
    probe: _Probes = None,
    step_size: _StepSize = None,
    time_limit: _TimeLimit = TIME_LIMIT,
    junit_file: _JUnit = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Check any FMU: description, life cycle, steps, states, wrong values.

    The FMU is run, each probe in processes of its own. Exit code 3 if a probe failed, crashed or
    timed out.
    """
    with opened(quiet, as_json) as screen:
        if junit_file is not None:
            with all_causes(FmuFile(fmu, to_run=False).model_description):
                _refuse_misplaced(junit_file)
        arguments = ("probes", "step_size", "time_limit")
        with options_named(arguments), screen.counting("probes") as counted:
            result = check_fmu(
                fmu,
                probes=probe or (),
                step_size=step_size,
                time_limit=time_limit,
                counted=counted,
            )
        if junit_file is not None:
            with refusing_unwritable(junit_file, "name another file"):
                write_file(junit_file, junit(result))
        if as_json:
            screen.dump(result.as_data())
        else:
            screen.table(result.table())
            screen.say(result.summary)
        if not result.ok:
            raise typer.Exit(CHECK_FAILED)


def _refuse_misplaced(file: Path) -> None:
    """Refuse a place for JUnit XML that is none, before minutes have gone into the check.

    Raises
    ------
    InputRefused
        There is no such folder, or something else than JUnit XML stands there.
    """
    if not file.parent.is_dir():
        raise InputRefused([Problem(str(file.parent), "is no folder", "make it, or name another")])
    if not file.exists():
        return
    with refusing_unwritable(file, "name another file"):
        begin = file.read_bytes()[:_HEAD]
    if b"<testsuite" not in begin:
        what = "is there, is no JUnit XML, and would be overwritten"
        raise InputRefused([Problem(str(file), what, "rename it or name another file")])

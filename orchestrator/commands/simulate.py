"""The command ``rockshed simulate``: one FMU alone, with inputs from a table."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import InputRefused, Problem, RunFailed, all_causes
from ..core.fmu.fmu_slave import FmuFile
from ..runs.alone import alone
from ..runs.run import Run
from ..runs.signals import read_signals
from ..runs.simulation import simulate
from ..runs.system import System
from .analysis import options_named
from .assignments import values_of
from .options import Json, NoFigures, Quiet, Strict, simulated_time
from .results_place import look_at_folder, results_folder
from .run import show_run
from .screen import Screen, opened
from .streams import stdout_for_results, tell_leftovers

_OPTIONS = (
    "inputs",
    "start_time",
    "stop_time",
    "step_size",
    "output_interval",
    "start_values",
    "output_variables",
    "tolerance",
    "folder",
)
_Fmu = Annotated[
    Path, typer.Argument(metavar="FMU", help="An FMU for co-simulation, of any origin.")
]
_Input = Annotated[
    Path | None,
    typer.Option(
        "--input",
        metavar="FILE.csv",
        help="Inputs over time: the column time (s), then one for each input, in its unit.",
    ),
]
_StartTime = Annotated[float | None, simulated_time("Begin of the run.")]
_StopTime = Annotated[
    float | None,
    simulated_time("End of the run; default is that of the FMU, or of the inputs."),
]
_StepSize = Annotated[
    float | None,
    simulated_time("Communication step; default is what the FMU proposes."),
]
_Interval = Annotated[
    float | None,
    simulated_time("Time between two rows of the results; default the step."),
]
_StartValues = Annotated[
    list[str] | None,
    typer.Option(
        "--start-values",
        metavar="NAME=VALUE",
        help="Another start value of a parameter or input. May be repeated.",
    ),
]
_Variables = Annotated[
    list[str] | None,
    typer.Option(
        "--output-variables",
        metavar="NAME",
        help="Record this variable, * for any text, and no others; default all outputs. May be "
        "repeated.",
    ),
]
_Tolerance = Annotated[
    float | None,
    typer.Option(metavar="NUMBER", help="Relative tolerance of the FMU's solver."),
]
_Folder = Annotated[Path | None, typer.Option(help="Folder of the results; default results/MODEL.")]


def command(
    fmu: _Fmu,
    input_file: _Input = None,
    start_time: _StartTime = None,
    stop_time: _StopTime = None,
    step_size: _StepSize = None,
    output_interval: _Interval = None,
    start_values: _StartValues = None,
    output_variables: _Variables = None,
    tolerance: _Tolerance = None,
    output_dir: _Folder = None,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Simulate one FMU alone, with its inputs from a CSV file.

    Between two rows values of continuous inputs are interpolated, those of all others are held.
    """
    with opened(quiet, as_json) as screen:
        problems: list[Problem] = []
        values = values_of("--start-values", start_values or [], problems)
        with options_named(_OPTIONS), all_causes(*_looks(fmu, input_file, output_dir)):
            if problems:
                raise InputRefused(problems)
            system = alone(
                fmu,
                input_file,
                start_time=start_time,
                stop_time=stop_time,
                step_size=step_size,
                output_interval=output_interval,
                start_values=values,
                output_variables=output_variables or (),
                tolerance=tolerance,
            )
        folder = output_dir or results_folder(system.name, str(fmu), {"fmu_file": str(fmu)}, screen)
        with stdout_for_results():
            done = _run(system, folder, screen)
        show_run(done, screen, not no_figures, strict)


def _looks(
    fmu: Path, inputs: Path | None, folder: Path | None
) -> Iterator[Callable[[], object] | None]:
    """Yield looks at the FMU, at its inputs and at the place of the results."""
    yield FmuFile(fmu).model_description
    yield None if inputs is None else partial(read_signals, inputs)
    yield look_at_folder(folder)


def _run(system: System, folder: Path, screen: Screen) -> Run:
    """Run the system; a run that fails gives what was computed until then."""
    with screen.progress("preparing") as progress:
        tell_leftovers(folder, screen)
        try:
            return simulate(system, folder, progress=progress, note=screen.warn)
        except RunFailed as failure:
            done: Run = failure.run
            return done

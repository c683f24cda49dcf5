"""Check by halved steps: the run once more with half of its steps, and the differences.

The difference shows the error of the steps, as far as it can be seen. A sand whose discs roll and
yield takes another path after the smallest change; there it shows how much the results scatter as
well. The check is kept in the folder of the run.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rockshed.components.common.roles import Role
from rockshed.components.common.units import ms

from ..core.errors import InputRefused, Problem, RunFailed
from ..core.loop.master import Progress
from ..core.results.facts import number_of, table_of
from ..core.results.own_files import add_files, read_data
from ..core.results.reading import StoredRun
from ..core.system.reading import system_from
from ..core.system.system import SystemSpec
from ..files import write_json
from ..metrics import names
from ..metrics.comparison import ComparedRow, rows
from ..metrics.headlines import headlines
from ..metrics.roles import members, parameter
from ..runs.building import Note, silent
from ..runs.request import Request
from ..runs.simulation import simulate
from ..runs.system import System
from ..tables import Table, digits

FILE = "step_halving.json"
"""File of the check in the folder of a run."""
CHEAP = 10.0
"""Time (s) that a run may have taken to be repeated without being asked for."""
_JUDGED = (
    *(names.PEAK_TRANSMITTED, names.PEAK_ROCK, names.PENETRATION, names.DEFLECTION),
    *(names.PEAK_MOMENT, names.PEAK_REACTION, names.STATIC_STIFFNESS),
)
"""Metrics by which the check is judged."""


@dataclass(frozen=True)
class StepHalving:
    """Metrics of a run, and those with half of its steps.

    Attributes
    ----------
    steps : mapping of str to float
        Steps (s) of the repeated run.
    values : mapping of str to tuple of float
        By the name of a headline metric: of the run, and with half of its steps (SI).
    table : Table
        The same as they are shown.
    """

    steps: Mapping[str, float]
    values: Mapping[str, tuple[float, float]]
    table: Table

    @property
    def largest(self) -> float:
        """Largest difference of forces, penetration, deflection and moment, as a part of each."""
        judged = [
            abs(theirs / ours - 1.0)
            for name, (ours, theirs) in self.values.items()
            if ours and names.without_component(name) in _JUDGED
        ]
        return max(judged, default=0.0)


def is_cheap(run: StoredRun) -> bool:
    """Tell whether a run took so little time that it may be repeated without being asked for.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    spent = number_of(table_of(run.provenance, "wall_time"), "exchanges")
    return run.status == "complete" and spent is not None and spent <= CHEAP


def kept(run: StoredRun) -> StepHalving | None:
    """Return the check that was kept with a run; None if there is none of this run.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    content = read_data(run.folder / FILE)
    if content.get("of") != run.provenance.get("started"):
        return None
    with suppress(KeyError, TypeError, ValueError):
        values = {str(n): (float(a), float(b)) for n, (a, b) in content["values"].items()}
        steps = {str(name): float(step) for name, step in content["steps"].items()}
        cells = [[str(cell) for cell in row] for row in content["rows"]]
        made = _table()
        for row in cells:
            made.add(*row)
        return StepHalving(steps, values, made)
    return None


def step_halving(
    run: StoredRun, progress: Progress | None = None, note: Note = silent
) -> StepHalving:
    """Run again with half of the exchange step and of all internal steps, and compare.

    Parameters
    ----------
    run : StoredRun
        Complete.
    progress : Progress, optional
        Called with the time reached and the stop time (s).
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    StepHalving
        Which is kept in the folder of the run, if that can be written.

    Raises
    ------
    InputRefused
        The run cannot be made again as it was.
    """
    system = _halved(run, note)
    try:
        again = simulate(system, progress=progress)
    except RunFailed as failure:
        raise _refusal(f"with half of the steps it failed: {failure}") from failure
    if again.status != "complete":
        raise KeyboardInterrupt
    made = _compared(run, again, _steps(system.spec))
    _keep(run.folder, run, made)
    return made


def _refusal(reason: str, remedy: str = "leave the check out") -> InputRefused:
    return InputRefused([Problem("check", reason, remedy)])


def _halved(run: StoredRun, note: Note) -> System:
    """Make the system of a run again, with half of its steps."""
    told = run.provenance.get("request")
    if not isinstance(told, Mapping):
        raise _refusal("the run was made of no case and no file, and cannot be made again")
    try:
        request = Request(**told)
    except TypeError as error:
        raise _refusal("another version of rockshed made the run", "run it again") from error
    system = System.prepared(request, note)
    if _without_files(system.spec.model_dump(mode="json")) != _without_files(
        run.provenance["system"]
    ):
        reason = f"{told['target']} is not what it was when the run was made"
        raise _refusal(reason, "run it again, and report on that run")
    return replace(system, job=replace(system.job, system=_with_half_steps(run, system.spec)))


def _without_files(system: Mapping[str, Any]) -> dict[str, Any]:
    """Return a system without the places of its FMUs, which do not matter."""
    components = {
        name: {key: value for key, value in told.items() if key != "fmu"}
        for name, told in system["components"].items()
    }
    return {**system, "components": components}


def _with_half_steps(run: StoredRun, system: SystemSpec) -> SystemSpec:
    data = system.model_dump()
    data["exchange_step"] = 0.5 * data["exchange_step"]
    if data["output_interval"] is None:
        data["output_interval"] = system.exchange_step
    for member in members(run, Role.INTERNAL_STEP):
        told = data["components"][member.component]
        told["step"] = told["step"] and 0.5 * told["step"]
        step = float(parameter(run, member.component, Role.INTERNAL_STEP) or 0.0)
        if step > 0.0:
            told["parameters"][member.variable] = 0.5 * step
    return system_from(_recording_no_states(data), system.name)


def _recording_no_states(data: Mapping[str, Any]) -> dict[str, Any]:
    components = {
        name: {**told, "record_states": False} for name, told in data["components"].items()
    }
    return {**data, "components": components}


def _steps(system: SystemSpec) -> dict[str, float]:
    """Return exchange step and internal steps (s) of a system."""
    found = {"exchange": float(system.exchange_step)}
    for name, told in system.components.items():
        step = told.parameters.get("internal_step")
        if isinstance(step, float):
            found[name] = step
    return found


def _table() -> Table:
    titles = ("run", "half of the steps", "difference")
    return Table(("quantity", "unit", *titles), right=titles)


def _compared(run: StoredRun, again: StoredRun, steps: Mapping[str, float]) -> StepHalving:
    with_half = {metric.name: float(metric.value) for metric in headlines(again)}
    values = {
        metric.name: (float(metric.value), with_half[metric.name])
        for metric in headlines(run)
        if metric.name in with_half
    }
    made = _table()
    for ours, theirs in zip(rows(run, {}), rows(again, {}), strict=False):
        if ours.label and (ours.label, ours.unit) == (theirs.label, theirs.unit):
            made.add(ours.label, ours.unit, ours.computed, theirs.computed, _percent(ours, theirs))
    return StepHalving(steps, values, made)


def _percent(ours: ComparedRow, theirs: ComparedRow) -> str:
    """Return the difference of two values as they are shown; nothing of shares that are errors."""
    with suppress(ValueError, ZeroDivisionError):
        return f"{100.0 * (float(theirs.computed) / float(ours.computed) - 1.0):+.1f} %"
    return ""


def _keep(folder: Path, run: StoredRun, made: StepHalving) -> None:
    content = {
        "of": run.provenance.get("started"),
        "steps": dict(made.steps),
        "values": {name: list(pair) for name, pair in made.values.items()},
        "rows": [list(row) for row in made.table.rows],
    }
    with suppress(OSError):  # a folder that cannot be written: the check is shown all the same
        write_json(folder / FILE, content)
        add_files(folder, [folder / FILE])


def in_words(made: StepHalving) -> str:
    """Return the steps of the repeated run in a sentence.

    Parameters
    ----------
    made : StepHalving
        The check.
    """
    told = ", ".join(f"{name} {digits(step / ms)}" for name, step in made.steps.items())
    judged = "of forces, penetration, deflection and moment"
    return (
        f"The run was made once more with half of its steps (ms: {told}). The largest difference "
        f"{judged} is {100.0 * made.largest:.2g} %."
    )

"""The band of the effective width: a project run again with the smallest and the largest rule."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ...core.errors import InputRefused, Problem
from ...metrics.headlines import headlines
from ...metrics.reported import reported
from ...runs.batch import COMPLETE, Counted, Outcome, Task, run_all, uncounted
from ...runs.building import Note, silent
from ...runs.request import Request
from ...runs.run import Run
from ...sites.shed.effective_width import Spread, band

FIELD = "cushion.effective_width"
_SAME = 0.01
"""Part by which a width may differ from that of the run and is not computed again."""


def width_band(
    run: Run, request: Request, *, note: Note = silent, counted: Counted = uncounted
) -> dict[str, Any]:
    """Run a project with the smallest and the largest effective width of all rules.

    Parameters
    ----------
    run : Run
        Of the project.
    request : Request
        What was asked for.
    note : callable
        Called with a line for each FMU that is built.
    counted : callable
        Called with the number of runs that have ended, and of all.

    Returns
    -------
    dict
        ``low``, ``run`` and ``high``: ``width`` (m) and ``metrics``, by name, of each; plain data
        for ``run.json``. Every number that the run has in its table is there.

    Raises
    ------
    InputRefused
        It is no run of a project, or one of the runs has no result.
    """
    spread, own = _design(run)
    named = dict(zip(("low", "high"), band(spread), strict=True))
    shown = [*headlines(run), *(entry.metric for entry in reported(run))]
    values = {metric.name: float(metric.value) for metric in shown}
    found = {"run": {"width": own, "metrics": values}}
    other = {name: width for name, width in named.items() if abs(width / own - 1.0) > _SAME}
    tasks = {name: _task(request, width, _recorded(run)) for name, width in other.items()}
    outcomes = run_all(list(tasks.values()), note=note, counted=counted)
    _refuse_failed({named[name]: outcomes[task.key] for name, task in tasks.items()})
    for name, task in tasks.items():
        metrics = outcomes[task.key].metrics
        others = {each: metrics[each] for each in values if each in metrics}
        found[name] = {"width": named[name], "metrics": others}
    return {name: found.get(name, found["run"]) for name in ("low", "run", "high")}


def _design(run: Run) -> tuple[Spread, float]:
    """Return what the rules depend on, and the effective width of a run (m)."""
    design = run.provenance.get("design", {})
    try:
        roof, cushion = design["roof"], design["cushion"]
        spacing = float(roof["spacing"]) if roof["kind"] == "girders" else 0.0
        spread = Spread(float(design["rock"]["radius"]), float(cushion["thickness"]), spacing)
        return spread, float(cushion["effective_width"])
    except KeyError as missing:
        text = "has no band of the effective width: it is no run of a project"
        remedy = "`rockshed init` writes a project"
        raise InputRefused(
            [Problem(str(run.provenance.get("name", "run")), text, remedy)]
        ) from missing


def _recorded(run: Run) -> tuple[str, ...]:
    """Return what a run has recorded, as patterns of each component."""
    wanted = run.provenance["system"].get("record", ["*"])
    every = [f"{name}.*" for name in run.provenance["components"]]
    return tuple(part for pattern in wanted for part in (every if pattern == "*" else [pattern]))


def _task(request: Request, width: float, recorded: tuple[str, ...]) -> Task:
    values = {**request.values, FIELD: float(f"{width:.6g}")}
    return Task(replace(request, values=values, in_process=False), columns=recorded)


def _refuse_failed(outcomes: Mapping[float, Outcome]) -> None:
    problems = [
        Problem(f"effective width {width:.3g} m", outcome.error or outcome.status)
        for width, outcome in outcomes.items()
        if outcome.status != COMPLETE
    ]
    if problems:
        raise InputRefused(problems)

"""A run or an analysis that was ended goes on."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

from ..core.results.reading import undamaged
from ..runs import continuing
from ..runs.building import Note, silent
from ..runs.run import Run
from ..runs.system import System
from .asked import Asked, find_asked
from .frame import Result, StageProgress, no_progress

_Again = Callable[[StageProgress, Note], Result]
"""Carries out an analysis."""


def resume(
    folder: str | Path,
    *,
    system: System | None = None,
    progress: Callable[[float, float], None] | None = None,
    strict: bool = False,
) -> Run | Result:
    """Let a run or an analysis go on that was killed, interrupted or has failed.

    Its results are those of one that nothing has ended, to the bit. A run begins at the last
    checkpoint but one and has to come by the last one with the same values: an FMU whose
    serialized state does not hold everything is found out. A study goes on from the runs that have
    ended, and so do a calibration of a sand and a convergence study; a campaign from the trials,
    and a calibration of a pile or of a slope from the values that it has computed.

    Parameters
    ----------
    folder : str or Path
        Folder of the results: of a run with ``checkpoint_every``, or of an analysis.
    system : System, optional
        For a run with components of one's own in this process: the same system.
    progress : callable, optional
        Of a run: called with the time reached and the stop time (s), every now and then.
    strict : bool
        Take a complete run with any warning for an error.

    Returns
    -------
    Run or Result
        Complete, or a run with the status ``interrupted`` after Ctrl-C. Of a run that is complete
        already, its results.

    Raises
    ------
    InputRefused
        There is nothing that could go on; files, FMUs, kernels or versions are others than before,
        or an FMU does not take its state back. What there is stays.
    RunFailed
        The run could not go on; its attribute ``run`` has the results until then.
    StudyFailed, CampaignFailed, ClusterFailed
        The study or campaign could not go on; what has ended is kept.
    RunDoubted
        With ``strict``, the run is complete and has warnings.

    Examples
    --------
    >>> import rockshed, tempfile
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> with tempfile.TemporaryDirectory() as place:
    ...     done = rockshed.simulate(system, f"{place}/run", checkpoint_every=2e-4)
    ...     again = rockshed.resume(f"{place}/run")
    >>> again.status
    'complete'
    """
    asked = find_asked(Path(folder))
    if asked is not None:
        return go_on(asked)
    return continuing.resume(folder, system=system, progress=progress, strict=strict)


def go_on(
    asked: Asked,
    *,
    pictures: bool | None = None,
    progress: StageProgress = no_progress,
    note: Note = silent,
) -> Result:
    """Let an analysis go on that was begun and has not ended.

    Parameters
    ----------
    asked : Asked
        The analysis.
    pictures : bool, optional
        Whether figures are drawn and saved too; by default as it was asked.
    progress : callable
        Called with a stage, and the numbers of its pieces that are done and of all.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    Result
        Of the analysis.

    Raises
    ------
    InputRefused, StudyFailed, CampaignFailed, ClusterFailed
        As the analysis does.
    """
    with undamaged(asked.file):
        again = _KINDS[asked.kind](asked, pictures)
    return again(progress, note)


def _study(asked: Asked, pictures: bool | None) -> _Again:
    from .study.arguments import arguments_from
    from .study.run import carry_out_study

    given = arguments_from(asked.arguments)
    chosen = replace(given, pictures=given.pictures if pictures is None else pictures)
    return lambda progress, note: carry_out_study(chosen, asked.folder, progress, note)


def _campaign(asked: Asked, pictures: bool | None) -> _Again:
    from .rockfall.arguments import campaign_arguments_from
    from .rockfall.run import carry_out_campaign

    given = campaign_arguments_from(asked.arguments)
    chosen = replace(given, pictures=given.pictures if pictures is None else pictures)
    return lambda progress, note: carry_out_campaign(chosen, asked.folder, progress)


def _calibration(asked: Asked, pictures: bool | None) -> _Again:
    from .calibration.measurement import from_data
    from .calibration.run import calibrate

    measurement = from_data(asked.arguments["measurement"])
    again = _with_arguments(calibrate, asked, pictures, measurement=measurement)
    return lambda progress, note: again(progress=progress, note=note)


def _meshes(asked: Asked, pictures: bool | None) -> _Again:
    from .convergence.run import converge

    again = _with_arguments(converge, asked, pictures)
    return lambda progress, note: again(progress=progress, note=note)


def _exchange_steps(asked: Asked, pictures: bool | None) -> _Again:
    from .exchange_steps.run import converge_exchange

    again = _with_arguments(converge_exchange, asked, pictures)
    return lambda progress, note: again(progress=progress, note=note)


def _pile_matching(asked: Asked, pictures: bool | None) -> _Again:
    from .pile_matching.run import match_pile

    again = _with_arguments(match_pile, asked, pictures)
    return lambda progress, note: again(progress=progress)


def _back_analysis(asked: Asked, pictures: bool | None) -> _Again:
    from .back_analysis.run import calibrate_rockfall

    again = _with_arguments(calibrate_rockfall, asked, pictures)
    return lambda progress, note: again(progress=progress)


def _with_arguments(
    function: Callable[..., Result], asked: Asked, pictures: bool | None, **replaced: Any
) -> Callable[..., Result]:
    """Return a function with the arguments that were asked.

    Raises
    ------
    TypeError
        It does not take them: they are damaged.
    """
    given = {**asked.arguments, **replaced, "folder": asked.folder}
    given |= {} if pictures is None else {"pictures": pictures}
    signature(function).bind(**given)
    return partial(function, **given)


_KINDS: Mapping[str, Callable[[Asked, bool | None], _Again]] = {
    "study": _study,
    "rockfall": _campaign,
    "calibration": _calibration,
    "convergence": _meshes,
    "exchange-steps": _exchange_steps,
    "pile matching": _pile_matching,
    "rockfall-calibration": _back_analysis,
}
"""Readers of the arguments of an analysis, by its kind."""

"""Warnings of a run, and doubts about its metrics: whether they can be trusted."""

import math
from collections.abc import Iterator

import numpy as np

from rockshed.components.common.roles import Role
from rockshed.components.common.units import kN, mm, ms

from ..core.results.changes import changes_of
from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import contents, names
from .cushion import cushions, still_sinking, thickness_at_start
from .energy import driven, scenario_work, structures
from .headlines import headlines
from .roles import column, members, members_of, owners, parameter, parameters, recorded
from .utilisation import exceeded

_RESIDUAL_LIMIT = 0.01
"""Part of the impact energy that may be missing in the balance."""
_UNBALANCED_LIMIT = 1e-3
"""Unbalanced-force ratio at the start up to which a cushion counts as at rest."""
_WEIGHT_LIMIT = 0.1
"""Random packs differ from their mean weight, and walls carry some of it."""
_THINNEST = 3.0
"""Diameters of a grain that a layer needs under the body to be a cushion."""

_PEAKS = {
    names.PEAK_TRANSMITTED: names.PEAK_TRANSMITTED_AT,
    names.PEAK_ROCK: names.PEAK_ROCK_AT,
    names.PEAK_MOMENT: names.PEAK_MOMENT_AT,
    names.PEAK_SHEAR: names.PEAK_SHEAR_AT,
    names.PEAK_REACTION: names.PEAK_REACTION_AT,
}
"""Largest values, and their times."""
_NO_DEFLECTION = 1e-9
"""Change (m) of a deflection up to which nothing has loaded a structure."""


def warnings(run: StoredRun) -> list[str]:
    """Return the warnings of a run and the doubts about its metrics.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of str
        A sentence each, with a remedy.
    """
    told = list(run.provenance.get("warnings", []))
    if not run.time.size:
        return told
    found = headlines(run)
    texts = [
        *meaningless(run),
        *told,
        *_ended_too_early(run, found),
        *exceeded(run, found),
        *_open_balance(run, found),
        *(text for structure in structures(run) for text in _other_weight(run, structure)),
        *(text for cushion in cushions(run) for text in _restless(run, cushion)),
        *(text for cushion in cushions(run) for text in _bottomed_out(run, cushion, found)),
        *(text for cushion in cushions(run) for text in _against_a_wall(run, cushion)),
    ]
    return list(dict.fromkeys(texts))


def meaningless(run: StoredRun) -> list[str]:
    """Return what makes the whole run meaningless, whatever its metrics are.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of str
        Sentences that come before all other warnings.
    """
    return [
        *([] if driven(run) else _different_gravity(run)),
        *(text for cushion in cushions(run) for text in _of_cushion(run, cushion)),
        *(text for structure in structures(run) for text in _unloaded(run, structure)),
    ]


def _different_gravity(run: StoredRun) -> Iterator[str]:
    """Doubt a body and a cushion that do not fall alike."""
    weighed = [*owners(run, Role.STRIKING), *cushions(run)]
    found = [member for member in members(run, Role.GRAVITY) if member.component in weighed]
    given = {member.column: parameter(run, member.component, Role.GRAVITY) for member in found}
    values = {name: float(value) for name, value in given.items() if value is not None}
    if len(set(values.values())) > 1:
        listed = ", ".join(f"{name} = {value:g}" for name, value in values.items())
        yield f"rock and cushion do not fall alike: {listed} m/s2; give all the same"


def _of_cushion(run: StoredRun, cushion: str) -> Iterator[str]:
    known = contents.measures(run, cushion)
    if known is not None:
        for reason in known.doubts(parameters(run, cushion), structures(run)):
            yield f"the {cushion} {reason}"
    yield from _no_cushion(run, cushion)
    if not driven(run):
        yield from _untouched(run, cushion)
        yield from _gone_through(run, cushion)
        yield from _gone_sideways(run, cushion)


def _thickness(run: StoredRun, cushion: str) -> float:
    """Return the height (m) of a cushion's surface over its base at the start, inf if unknown."""
    thickness = thickness_at_start(run, cushion)
    return math.inf if thickness is None else thickness


def _no_cushion(run: StoredRun, cushion: str) -> Iterator[str]:
    """Doubt a layer that is hardly thicker than a grain."""
    radius = parameter(run, cushion, Role.GRAIN_RADIUS)
    thickness = _thickness(run, cushion)
    if radius is None or thickness >= _THINNEST * 2.0 * float(radius):
        return
    yield (
        f"the {cushion} is no cushion: it is {thickness / mm:.3g} mm high where the rock is, and "
        f"one disc is {2.0 * float(radius) / mm:g} mm thick; give it more discs"
    )


def _untouched(run: StoredRun, cushion: str) -> Iterator[str]:
    """Doubt an impact without contact."""
    force = column(run, cushion, Role.ON_BODY)
    if force is None or run.status != "complete" or run.series[force].any():
        return
    where = "; " + _on_its_way(run, cushion)
    yield f"the rock has never touched the {cushion}: there is no impact in this run{where}"


def _on_its_way(run: StoredRun, cushion: str) -> str:
    """Say where a body was when the run ended, and where it was going."""
    name = column(run, cushion, Role.ABOVE_SURFACE)
    if name is None or run.series["time"].size < 2:
        return "check its place and velocity, and the stop time"
    time, above = run.series["time"], run.series[name]
    distance = float(above[-1])
    sinking = float(above[-2] - above[-1]) / float(time[-1] - time[-2])
    if distance <= 0.0:
        return "it ends below the level of the surface; check its place and velocity"
    if sinking <= 0.0:
        return f"it ends {distance / mm:.4g} mm above the surface and moves away from it"
    arrives = distance / sinking
    return (
        f"it ends {distance / mm:.4g} mm above the surface and needs some {arrives / ms:.3g} ms "
        "more: raise the stop time, or check its place"
    )


def _gone_through(run: StoredRun, cushion: str) -> Iterator[str]:
    """Doubt an impact that went through the base, which is no model of anything."""
    name = column(run, cushion, Role.PENETRATION)
    thickness = _thickness(run, cushion)
    if name is None or not run.series[name].size:
        return
    depth = float(run.series[name].max())
    if depth > 2.0 * thickness:
        yield (
            f"the rock has gone through the {cushion} and what carries it, by "
            f"{(depth - thickness) / mm:.4g} mm: the impact is beyond this model, and what came "
            "after means nothing"
        )


def _gone_sideways(run: StoredRun, cushion: str) -> Iterator[str]:
    """Doubt an impact after which the body is no longer above the box of the cushion."""
    left, width = (parameter(run, cushion, role) for role in (Role.BOX_LEFT, Role.BOX_WIDTH))
    force = column(run, cushion, Role.ON_BODY)
    places = [member.column for member in recorded(run, Role.STRIKING_PLACE)]
    if left is None or width is None or force is None or len(places) != 1:
        return
    beside = np.abs(run.series[places[0]] - (left + 0.5 * width)) > 0.5 * width
    touched = np.logical_or.accumulate(run.series[force] != 0.0)
    rows = np.flatnonzero(beside & touched)
    if rows.size:
        when = f"{float(run.series['time'][rows[0]]) / ms:.4g} ms"
        yield (
            f"the rock leaves the {cushion} sideways: at {when} its centre is beyond the box, "
            f"which reaches from x = {left:g} m to {left + width:g} m; what came after is no "
            "impact on a cushion: move the rock, or widen the box"
        )


def _ended_too_early(run: StoredRun, found: list[Metric]) -> Iterator[str]:
    """Doubt the largest values of an impact that its run has cut off."""
    forces = [column(run, cushion, Role.ON_BODY) for cushion in cushions(run)]
    hit = any(run.series[force].any() for force in forces if force)
    if run.status != "complete" or driven(run) or not hit:
        return
    end = float(run.time[-1])
    ends = f"the run ends at {end / ms:.4g} ms"
    if still_sinking(run):
        yield (
            f"{ends}, before the rock has come to a stop: largest values and penetration are those "
            "until then; raise the stop time"
        )
        return
    times = {metric.name: metric.value for metric in found}
    cut = [name for name, at in _PEAKS.items() if at in times and _is(float(times[at]), end)]
    if cut:
        yield f"{ends}, with the largest value of {', '.join(cut)} so far: raise the stop time"


def _is(time: float, end: float) -> bool:
    """Tell whether a time is that of the end."""
    return math.isclose(time, end, rel_tol=1e-9)


def _unloaded(run: StoredRun, structure: str) -> Iterator[str]:
    """Doubt a structure that an impact leaves as it was."""
    name = column(run, structure, Role.DEFLECTION)
    if name is None or run.status != "complete" or not owners(run, Role.STRIKING):
        return
    deflection = run.series[name]
    if np.ptp(deflection) <= _NO_DEFLECTION:
        stays = f"{float(deflection[0]) / mm:.4g} mm"
        yield (
            f"the {structure} is never loaded: its deflection stays {stays} from the start to the "
            "end; check what rests on it, its connections and the stop time"
        )


def _open_balance(run: StoredRun, found: list[Metric]) -> Iterator[str]:
    """Doubt an energy balance that does not close."""
    name = names.RESIDUAL_SHARE
    whole = "impact energy"
    if driven(run):
        name = names.RESIDUAL_WORK_SHARE
        whole = "work of the machine"
    share = next((float(metric.value) for metric in found if metric.name == name), None)
    if share is not None and not abs(share) <= _RESIDUAL_LIMIT:
        remedy = "do not trust the figures, reduce the steps"
        if _has_unknown_work(run):
            remedy = (
                "it has not what faults of the scenario make, and what that imposes elsewhere than "
                "on power ports; see whether it closes without them"
            )
        elif changes := changes_of(run.provenance):
            when = " and ".join(f"{change.at / ms:.4g} ms" for change in changes)
            remedy = (
                f"it has not the work of what was set at {when}; see whether it closes "
                "in the run that this is a variant of"
            )
        missing = f"{100.0 * share:+.3g} % of the {whole}"
        yield f"the balance of energy does not close: {missing}; {remedy}"


def _has_unknown_work(run: StoredRun) -> bool:
    """Tell whether a scenario has done work on the system that nobody counts."""
    scenario = (run.provenance.get("system") or {}).get("scenario") or {}
    return any(scenario.values()) and ("fault" in scenario or scenario_work(run) is None)


def _other_weight(run: StoredRun, structure: str) -> Iterator[str]:
    """Doubt a structure that was bent by another weight than that of the cushion on it."""
    pressing = [
        float(run.series[name][0])
        for cushion in cushions(run)
        if (name := column(run, cushion, Role.TRANSMITTED))
    ]
    assumed = float(parameter(run, structure, Role.CUSHION_WEIGHT) or 0.0)
    named = [m.column for m in members_of(run, structure, Role.CUSHION_WEIGHT)]
    if len(pressing) != 1 or not assumed or abs(pressing[0] / assumed - 1.0) <= _WEIGHT_LIMIT:
        return
    yield (
        f"the {structure} does not start at rest: it was bent by {assumed / kN:.4g} kN and the "
        f"cushion presses with {pressing[0] / kN:.4g} kN; set {named[0]}={pressing[0]:.6g}"
    )


def _restless(run: StoredRun, cushion: str) -> Iterator[str]:
    """Doubt a cushion that was moving before the impact."""
    name = column(run, cushion, Role.UNBALANCED)
    if name is None or not parameter(run, cushion, Role.GRAVITY):  # it is counted in gravity
        return
    ratio = float(run.series[name][0])
    if not ratio <= _UNBALANCED_LIMIT:
        variable = name.removeprefix(f"{cushion}.")
        yield (
            f"the {cushion} was not at rest at the start ({variable} {ratio:.2g}, "
            f"at most {_UNBALANCED_LIMIT:g}): raise settling.time"
        )


def _bottomed_out(run: StoredRun, cushion: str, found: list[Metric]) -> Iterator[str]:
    """Warn of a body that comes nearer to the base than a grain is thick."""
    radius = parameter(run, cushion, Role.GRAIN_RADIUS)
    wanted = (names.CLEARANCE, names.of_component(cushion, names.CLEARANCE))
    clearance = next((float(m.value) for m in found if m.name in wanted), None)
    if clearance is None or radius is None or clearance >= 2.0 * float(radius):
        return
    if clearance < -_thickness(run, cushion):
        return  # told first
    where = f"presses {-clearance / mm:.1f} mm into"
    if clearance > 0.0:
        where = f"comes within {clearance / mm:.1f} mm of"
    yield (
        f"the rock bottoms out: it {where} the base, and a sand disc is "
        f"{2.0 * float(radius) / mm:g} mm thick; the cushion is too thin for this impact"
    )


def _against_a_wall(run: StoredRun, cushion: str) -> Iterator[str]:
    """Warn of a body that meets a side wall in the cushion: its force is the wall's too."""
    left, width = (parameter(run, cushion, role) for role in (Role.BOX_LEFT, Role.BOX_WIDTH))
    places = recorded(run, Role.STRIKING_PLACE)
    depth, force = (column(run, cushion, role) for role in (Role.PENETRATION, Role.ON_BODY))
    if left is None or width is None or len(places) != 1 or depth is None or force is None:
        return
    radius = parameter(run, places[0].component, Role.BODY_RADIUS)
    if radius is None or driven(run):
        return
    beside = np.abs(run.series[places[0].column] - (left + 0.5 * width))
    meets = (beside > 0.5 * width - radius) & (beside < 0.5 * width)
    rows = np.flatnonzero(meets & (run.series[depth] > 0.0) & (run.series[force] != 0.0))
    if rows.size:
        when = f"{float(run.series['time'][rows[0]]) / ms:.4g} ms"
        yield (
            f"the rock meets a side wall of the {cushion} at {when}, "
            f"{float(run.series[depth][rows[0]]) / mm:.3g} mm deep: walls are rigid, and from then "
            "on the force on the rock is theirs too; take a rock that strikes farther from the "
            "end, or widen the cushion"
        )

"""Warnings of a run, and doubts about its metrics: whether they can be trusted."""

from collections.abc import Iterator

from rockshed.components.common.roles import Role
from rockshed.components.common.units import kN, mm

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .cushion import cushions
from .energy import driven, structures
from .headlines import headlines
from .roles import column, members, parameter

_RESIDUAL_LIMIT = 0.01
"""Part of the impact energy that may be missing in the balance."""
_UNBALANCED_LIMIT = 1e-3
"""Unbalanced-force ratio at the start up to which a cushion counts as at rest."""
_WEIGHT_LIMIT = 0.1
"""Random packs differ from their mean weight, and walls carry some of it."""


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
    return [
        *told,
        *_open_balance(run, found),
        *(text for structure in structures(run) for text in _other_weight(run, structure)),
        *(text for cushion in cushions(run) for text in _restless(run, cushion)),
        *(text for cushion in cushions(run) for text in _bottomed_out(run, cushion, found)),
    ]


def _open_balance(run: StoredRun, found: list[Metric]) -> Iterator[str]:
    """Doubt an energy balance that does not close."""
    name = names.RESIDUAL_SHARE
    whole = "impact energy"
    if driven(run):
        name = names.RESIDUAL_WORK_SHARE
        whole = "work of the machine"
    share = next((float(metric.value) for metric in found if metric.name == name), None)
    if share is not None and not abs(share) <= _RESIDUAL_LIMIT:
        yield (
            f"the balance of energy does not close: {100.0 * share:+.3g} % of the {whole}; "
            "do not trust the figures, reduce the steps"
        )


def _other_weight(run: StoredRun, structure: str) -> Iterator[str]:
    """Doubt a structure that was bent by another weight than that of the cushion on it."""
    pressing = [
        float(run.series[name][0])
        for cushion in cushions(run)
        if (name := column(run, cushion, Role.TRANSMITTED))
    ]
    assumed = float(parameter(run, structure, Role.CUSHION_WEIGHT) or 0.0)
    named = [m.column for m in members(run, Role.CUSHION_WEIGHT) if m.component == structure]
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
    where = f"presses {-clearance / mm:.1f} mm into"
    if clearance > 0.0:
        where = f"comes within {clearance / mm:.1f} mm of"
    yield (
        f"the rock bottoms out: it {where} the base, and a sand disc is "
        f"{2.0 * float(radius) / mm:g} mm thick; the cushion is too thin for this impact"
    )

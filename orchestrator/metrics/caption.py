"""Caption of a run: what was run, in short lines."""

import math
from collections.abc import Mapping
from typing import Any

from rockshed.components.common.roles import Role
from rockshed.components.common.units import ms

from ..core.results.reading import StoredRun
from ..tables import digits
from . import contents
from .divergence import note_of
from .roles import parameter, parameters

_MOST = 12
"""Changed values, or components, that a line of the caption names."""
_LONGEST, _LONGEST_DESCRIPTION = 60, 300
"""Letters of a name or value, and of a description, at most."""


def caption(run: StoredRun) -> list[str]:
    """Return the caption of a run.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of str
        Case; differences from it, if there are any; models of the components; exchange and steps.
    """
    facts = run.provenance
    description = _cut(facts["system"]["description"], _LONGEST_DESCRIPTION)
    changed = _changed(facts.get("differences", {}))
    return [
        f"{_cut(facts['name'], _LONGEST)}: {description}".removesuffix(": "),
        *filter(None, [changed and f"changed: {changed}", *models(run)]),
        scheme(run),
        *note_of(run),
    ]


def _changed(differences: Mapping[str, Any]) -> str:
    """Return the first of the values that are other than in the case, and how many more there are.

    Numbers have four digits, of whole ones all.
    """
    words = [
        f"{_cut(name, _LONGEST)} = {_cut(_written(value), _LONGEST)}"
        for name, value in list(differences.items())[:_MOST]
    ]
    more = len(differences) - len(words)
    return ", ".join(words) + (f" and {more} more, see run.json" if more else "")


def _written(value: Any) -> str:
    return digits(value, 4) if isinstance(value, float) and math.isfinite(value) else str(value)


def _cut(text: str, letters: int) -> str:
    return text if len(text) <= letters else f"{text[:letters]}..."


def models(run: StoredRun) -> list[str]:
    """Return a line on each component that was computed by one of several models; equal lines once.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    lines = [
        str(known.description(parameters(run, component)))
        for component in run.provenance["components"]
        if (known := contents.measures(run, component))
    ]
    return list(dict.fromkeys(lines))


def scheme(run: StoredRun) -> str:
    """Return how values were exchanged, and with which steps.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    facts, system = run.provenance, run.provenance["system"]
    steps = {name: _step(run, name, system) for name in facts["components"]}
    told = [f", {_cut(name, _LONGEST)} {step:g}" for name, step in steps.items() if step]
    more = f", {len(told) - _MOST} more" if len(told) > _MOST else ""
    shown = "".join(told[:_MOST]) + more
    coupling = f"{system['master']} master"
    if "coupling" in facts:
        coupling = f"coupling {facts['coupling']}"
    exchange = f"{system['exchange_step'] / ms:g}"
    if adaptive := system.get("adaptive"):
        exchange += f" to {adaptive['largest_step'] / ms:g}, adaptive"
    return f"{coupling}: steps in ms: exchange {exchange}{shown}"


def _step(run: StoredRun, component: str, system: Mapping[str, Any]) -> float:
    """Return the longest internal step (ms) of a component; 0 if it names none.

    It is never longer than the communication step.
    """
    told = system.get("components", {}).get(component, {})
    communication = told.get("step") or system["exchange_step"]
    own = float(parameter(run, component, Role.INTERNAL_STEP) or 0.0)
    return float(min(own, communication) / ms)

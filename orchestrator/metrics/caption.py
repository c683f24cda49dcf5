"""Caption of a run: what was run, in short lines."""

from collections.abc import Mapping
from typing import Any

from rockshed.components.common.roles import Role
from rockshed.components.common.units import ms

from ..core.results.reading import StoredRun
from . import contents
from .roles import parameter, parameters


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
    differences = facts.get("differences", {})
    changed = ", ".join(f"{name} = {value}" for name, value in differences.items())
    return [
        f"{facts['name']}: {facts['system']['description']}".removesuffix(": "),
        *filter(None, [changed and f"changed: {changed}", *models(run)]),
        scheme(run),
    ]


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
    shown = "".join(f", {name} {step:g}" for name, step in steps.items() if step)
    coupling = f"{system['master']} master"
    if "coupling" in facts:
        coupling = f"coupling {facts['coupling']}"
    return f"{coupling}: steps in ms: exchange {system['exchange_step'] / ms:g}{shown}"


def _step(run: StoredRun, component: str, system: Mapping[str, Any]) -> float:
    """Return the longest internal step (ms) of a component; 0 if it names none.

    It is never longer than the communication step.
    """
    told = system.get("components", {}).get(component, {})
    communication = told.get("step") or system["exchange_step"]
    own = float(parameter(run, component, Role.INTERNAL_STEP) or 0.0)
    return float(min(own, communication) / ms)

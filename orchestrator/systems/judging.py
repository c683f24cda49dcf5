"""Answers of masters held against the truth, and against the reference master."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from .measured import MasterRun
from .system import ImpactSystem, NumberArray

_MOST_WORDS = 160
_PATH = re.compile(r"(/[\w.+-]+){2,}")


def judged(
    system: ImpactSystem,
    names: tuple[str, str, float],
    answer: Mapping[str, Any],
    reference: Mapping[str, Any],
) -> MasterRun:
    """Return what an answer of a master is worth.

    Parameters
    ----------
    system : ImpactSystem
        The system.
    names : tuple
        Master, kind of FMUs, exchange step (s).
    answer : mapping
        Of the master: times, values, processor time; or the reason why there are none.
    reference : mapping
        Answer of the reference master with this step; empty where there is none.
    """
    master, variant, step = names
    exchanges = answer.get("exchanges", round(system.stop_time / step))
    facts = (system.name, master, variant, step, exchanges)
    if "reason" in answer:
        return MasterRun(*facts, reason=_shortened(answer["reason"]))
    values, times = _series(answer, system.quantity), np.array(answer["times"])
    if not np.isfinite(values).all():
        return MasterRun(*facts, reason="values that are no finite numbers")
    return MasterRun(
        *facts,
        error=float(np.abs(values - system.truth(times)).max()) / system.scale,
        energy=_made(system, answer),
        cost=answer["cpu"],
        deviation=_deviation(system, values, reference),
    )


def _deviation(
    system: ImpactSystem, values: NumberArray, reference: Mapping[str, Any]
) -> float | None:
    """Return the largest difference from the reference; some masters show no start."""
    if "values" not in reference:
        return None
    expected = _series(reference, system.quantity)
    common = min(len(values), len(expected))
    largest = np.abs(values[-common:] - expected[-common:]).max()
    return float(largest) / system.scale


def _made(system: ImpactSystem, answer: Mapping[str, Any]) -> float | None:
    """Return the energy that the coupling has made, as a part of the impact energy."""
    if not system.energies:
        return None
    end = sum(float(answer["values"][each][-1]) for each in system.energies)
    made = (end - system.start_energy) / system.impact_energy
    return made if np.isfinite(made) else None


def _series(answer: Mapping[str, Any], name: str) -> NumberArray:
    return np.array(answer["values"][name], dtype=float)


def _shortened(words: str) -> str:
    """Return words without folders, cut where they are many."""
    told = _PATH.sub(lambda found: found[0].rpartition("/")[2], words)
    return told if len(told) <= _MOST_WORDS else told[: _MOST_WORDS - 3] + "..."

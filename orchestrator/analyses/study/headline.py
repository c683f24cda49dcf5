"""Metrics of a study that are told first, and their units on screen."""

from collections.abc import Sequence

import numpy as np

from rockshed.components.common.units import kN, mm

from ...core.results.metric import identifier
from ...metrics import names
from .records import StudyRecords, values_of

FIRST = tuple(
    identifier(name)
    for name in (
        names.SETTLED_ROCK,
        names.SETTLED_TRANSMITTED,
        names.PEAK_TRANSMITTED,
        names.PENETRATION,
        names.PEAK_MOMENT,
        names.PEAK_SHEAR,
        names.DEFLECTION,
        names.PEAK_REACTION,
        "permanent set",
    )
)
"""Metrics that a designer asks for first, in the order of the tables."""
UTILISATION = identifier(names.utilisation(""))
"""Beginning of the identifiers of utilisations."""
MOST_OTHERS = 8
"""Metrics of a system that has none of the known ones."""
_SIDE_ISSUES = ("_at", "_integral", "_minimum", "_place")
_COUNTS = ("exchanges", "simulated_time")
_SCREEN = {
    "N": ("kN", kN),
    "N.m": ("kN m", kN),
    "J": ("kJ", 1e3),
    "Pa": ("MPa", 1e6),
    "m": ("mm", mm),
    "s": ("ms", 1e-3),
}
"""Unit on screen, and its size in SI, by SI unit."""


def headline_metrics(records: StudyRecords) -> list[str]:
    """Return the identifiers of the metrics that are told where none are asked for.

    Parameters
    ----------
    records : StudyRecords
        Of the study.

    Returns
    -------
    list of str
        Forces, penetration, moment, deflection and utilisation as far as there are any; of another
        system, the first metrics that vary.
    """
    found = [name for name in FIRST if name in records.names]
    found += [name for name in records.names if name.startswith(UTILISATION)]
    if found:
        return found
    varying = [name for name in records.names if _varies(records, name)]
    return varying[:MOST_OTHERS]


def is_main(name: str) -> bool:
    """Tell whether a metric is worth telling: no count, and not where or when another one is.

    Parameters
    ----------
    name : str
        Its identifier.
    """
    return name not in _COUNTS and not name.endswith(_SIDE_ISSUES)


def _varies(records: StudyRecords, name: str) -> bool:
    if not is_main(name):
        return False
    values = values_of(records.complete, name)
    return len(values) > 1 and bool(np.ptp(values))


def on_screen(unit: str) -> tuple[str, float]:
    """Return the unit in which a metric is shown, and its size in SI.

    Parameters
    ----------
    unit : str
        SI unit.
    """
    return _SCREEN.get(unit, ("" if unit == "1" else unit, 1.0))


def titled(records: StudyRecords, metric: str) -> str:
    """Return a metric in words with its unit on screen.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metric : str
        Identifier.
    """
    name = records.names[metric]
    unit, _ = on_screen(name.unit)
    return f"{name.words} ({unit})" if unit else name.words


def scaled(records: StudyRecords, metrics: Sequence[str]) -> dict[str, float]:
    """Return the size in SI of the unit on screen of each metric."""
    return {name: on_screen(records.names[name].unit)[1] for name in metrics}

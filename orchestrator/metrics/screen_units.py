"""Units in which a run is shown: those of its paper beside SI, and kJ where energies are large."""

from rockshed.components.common.units import SCREEN_UNITS, kJ

from ..core.results.reading import StoredRun
from .energy import impact_energy

_OF_PAPERS = "kgf"
"""Begins the units that only papers have."""
_LARGE_ENERGY = 10.0 * kJ
"""Impact energy (J) from which on energies are shown in kJ."""


def is_shown_in(unit: str, run: StoredRun) -> bool:
    """Tell whether a second unit is shown for a run.

    Parameters
    ----------
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`.
    run : StoredRun
        The run.

    Returns
    -------
    bool
        kgf for the cases of papers, whose references are in kgf, and for no project or system of
        one's own.
    """
    return not unit.startswith(_OF_PAPERS) or "case" in run.provenance


def screen_unit(unit: str, run: StoredRun) -> str:
    """Return the unit in which a quantity of a run is shown.

    Parameters
    ----------
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`.
    run : StoredRun
        The run.

    Returns
    -------
    str
        kJ in the place of J where the impact energy is large; else the unit itself.
    """
    return "kJ" if unit == "J" and (impact_energy(run) or 0.0) >= _LARGE_ENERGY else unit


def screen_size(unit: str, run: StoredRun) -> float:
    """Return the size (SI) of the unit in which a quantity of a run is shown.

    Parameters
    ----------
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`.
    run : StoredRun
        The run.
    """
    return SCREEN_UNITS[screen_unit(unit, run)]

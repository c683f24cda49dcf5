"""The table of a calibration for a person, in the units of the paper."""

from collections.abc import Sequence

from rockshed.components.common.units import cm, kgf

from ...tables import Table
from .fit import Fit
from .search import Calibration

E_BAR = kgf / cm**2
"""Unit (Pa) in which E_bar is shown."""
HEADINGS = (
    "measurement",
    "rotation",
    "k (kgf/cm)",
    "E_bar (kgf/cm²)",
    "±",
    "exponent",
    "error of the curve",
    "printed",
    "to printed",
)
"""Titles of the columns."""


def cells(calibrations: Sequence[Calibration]) -> list[list[str]]:
    """Return the rows of the table.

    Parameters
    ----------
    calibrations : sequence of Calibration
        The best first.

    Returns
    -------
    list of list of str
        Each measurement with each model; a cell for each of :data:`HEADINGS`.
    """
    return [_cells(made.rotation, fit) for made in calibrations for fit in made.fits]


def _cells(rotation: str, fit: Fit) -> list[str]:
    printed = fit.measured.printed
    return [
        fit.measured.name,
        rotation,
        f"{fit.measured.stiffness / kgf * cm:.1f}",
        f"{fit.modulus / E_BAR:.1f}",
        f"{fit.uncertainty / E_BAR:.1f}",
        f"{fit.exponent:.2f}",
        f"{100 * fit.misfit:.1f} %" if fit.measured.is_curve else "",
        f"{printed / E_BAR:.1f}" if printed else "",
        f"{100 * (fit.modulus / printed - 1):+.0f} %" if printed else "",
    ]


def modulus_table(calibrations: Sequence[Calibration]) -> Table:
    """Return the table of a calibration.

    Parameters
    ----------
    calibrations : sequence of Calibration
        The best first.

    Returns
    -------
    Table
        Without the columns in which nothing stands.
    """
    rows = cells(calibrations)
    shown = [i for i in range(len(HEADINGS)) if any(row[i] for row in rows)]
    table = Table([HEADINGS[i] for i in shown], right=HEADINGS[2:])
    for row in rows:
        table.add(*(row[i] for i in shown))
    return table


def settings(calibration: Calibration) -> list[str]:
    """Return the changes in the case of the static test, as ``name=value``."""
    return [f"{name}={value}" for name, value in calibration.values.items()]


def notes(best: Calibration, was_chosen: bool) -> list[str]:
    """Return remarks on a calibration.

    Parameters
    ----------
    best : Calibration
        Of all models the one that fits best.
    was_chosen : bool
        Whether there were others.

    Returns
    -------
    list of str
        A sentence each.
    """
    samples = len({push.seed for push in best.pushes})
    scatter = "±: standard deviation of the E_bar that single samples ask for"
    if best.fits[0].measured.is_curve:
        scatter += ", and error of the curve, together"
    sentences = [
        f"rotation {best.rotation}: {', '.join(settings(best))}; {len(best.pushes)} static tests, "
        f"{samples} samples",
        scatter,
    ]
    if was_chosen:
        sentences.append(f"rotation {best.rotation} fits best, by the error of the curve")
    return sentences

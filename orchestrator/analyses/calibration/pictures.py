"""The picture of a calibration: curves, or spring constants of the tests over E_bar."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rockshed.components.common.units import cm, kgf, kN

from ...pictures.style import (
    GREY,
    INK,
    ROCK,
    TRANSMITTED,
    WIDTH,
    legend,
    literal,
    reference_line,
    second_scale,
)
from ..drawing import drawn
from ..frame import Drawing
from .fit import Fit
from .search import Calibration
from .tables import E_BAR

if TYPE_CHECKING:
    from .result import CalibrationResult

_STIFFNESS = kgf / cm
"""Unit (N/m) in which spring constants are shown."""


def drawings(result: "CalibrationResult") -> dict[str, Drawing]:
    """Return a function for the figure of a calibration.

    Parameters
    ----------
    result : CalibrationResult
        With one model or several.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    return {"calibration": partial(overview, result)}


def overview(result: "CalibrationResult") -> Figure:
    """Draw a calibration.

    Parameters
    ----------
    result : CalibrationResult
        With one model or several.

    Returns
    -------
    matplotlib.figure.Figure
        A measured curve with those that were fitted to it, or the spring constants of the computed
        tests over E_bar, with the E_bar of the measured ones.
    """
    with drawn(result.notes, WIDTH, 3.8) as figure:
        axes = figure.subplots()
        if result.best.measured.is_curve:
            _curves(axes, result.calibrations)
        else:
            _constants(axes, result.calibrations[0])
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        legend(axes)
    return figure


def _curves(axes: Axes, calibrations: Sequence[Calibration]) -> None:
    measured = calibrations[0].fits[0].measured
    depth = measured.depth / cm
    label = f"measured: {literal(measured.name)}"
    axes.plot(depth, measured.load / kN, "s", color=INK, markersize=3.5, label=label)
    for made, colour in zip(calibrations, (TRANSMITTED, ROCK)):
        fit = made.fits[0]
        modulus = f"E_bar {fit.modulus / E_BAR:.1f} ± {fit.uncertainty / E_BAR:.1f} kgf/cm²"
        label = f"rotation {made.rotation}, {modulus}, error {100 * fit.misfit:.1f} %"
        axes.plot(depth, fit.load / kN, color=colour, label=label)
        low = (fit.load - fit.load_spread) / kN
        high = (fit.load + fit.load_spread) / kN
        axes.fill_between(depth, low, high, color=colour, alpha=0.2, linewidth=0)
    axes.set(xlabel="penetration (cm)", ylabel="load (kN)")
    second_scale(axes, kN / kgf, "(kgf)")


def _constants(axes: Axes, calibration: Calibration) -> None:
    depth = float(calibration.fits[0].measured.depth[-1])
    moduli = np.array([push.modulus for push in calibration.pushes]) / E_BAR
    loads = np.array([float(push.curve.at(depth)) for push in calibration.pushes])
    label = "computed static tests, one sample each"
    axes.plot(
        moduli,
        loads / depth / _STIFFNESS,
        "o",
        color=TRANSMITTED,
        markersize=2.5,
        alpha=0.5,
        label=label,
    )
    _power_law(axes, calibration.fits[0], np.linspace(moduli.min(), moduli.max(), 60))
    _measured(axes, calibration.fits)
    axes.axhline(0.0, color=GREY, linewidth=0.7)
    axes.set(xlabel="fictitious modulus E_bar (kgf/cm²)")
    axes.set(ylabel="secant spring constant k (kgf/cm)")


def _power_law(axes: Axes, fit: Fit, moduli: np.ndarray) -> None:
    """Draw the fitted spring constant over E_bar (kgf/cm2)."""
    stiffness = float(fit.load[-1] / fit.measured.depth[-1]) / _STIFFNESS
    line = stiffness * (moduli / (fit.modulus / E_BAR)) ** fit.exponent
    label = f"fit: k goes with E_bar to the {fit.exponent:.2f}"
    axes.plot(moduli, line, color=TRANSMITTED, linewidth=1.0, label=label)


def _measured(axes: Axes, fits: Sequence[Fit]) -> None:
    """Draw the measured spring constants at the E_bar that they ask for, and at printed ones."""
    stiffness = [fit.measured.stiffness / _STIFFNESS for fit in fits]
    axes.errorbar(
        [fit.modulus / E_BAR for fit in fits],
        stiffness,
        xerr=[fit.uncertainty / E_BAR for fit in fits],
        fmt="s",
        color=ROCK,
        markersize=4.5,
        linewidth=1.0,
        label="measured k, at the E_bar found",
    )
    printed = [fit.measured.printed for fit in fits]
    if any(modulus is None for modulus in printed):
        text = f"measured, {stiffness[0]:.1f} kgf/cm"
        reference_line(axes, stiffness[0], text, dashes=":")
    else:
        axes.plot(
            [modulus / E_BAR for modulus in printed if modulus is not None],
            stiffness,
            "s",
            color=INK,
            markersize=4.5,
            markerfacecolor="none",
            label="measured k, at the E_bar printed in table 4",
        )

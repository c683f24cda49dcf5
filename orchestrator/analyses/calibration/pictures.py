"""What a calibration has found: measured and computed curves, or the spring constants of the tests over E_bar."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from rockshed.components.common.units import cm, kgf, kN

from ...pictures.style import (
    GREY,
    INK,
    ROCK,
    TRANSMITTED,
    WIDTH,
    captioned,
    reference_line,
    second_scale,
)
from .run import Calibration, Fit

_E_BAR = kgf / cm**2


def draw(
    calibrations: Sequence[Calibration],
    printed: Mapping[str, float],
    caption: Sequence[str],
    file: Path,
) -> None:
    """A curve with what was fitted to it, or k over E_bar with the E_bar that were found and printed."""
    with captioned(caption, file, WIDTH, 3.8) as made:
        axes = made.subplots()
        if calibrations[0].fits[0].measured.is_curve:
            _curves(
                axes, [(calibration.rotation, calibration.fits[0]) for calibration in calibrations]
            )
        else:
            _constants(axes, calibrations[0], printed)
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="upper left")


def _curves(axes: Axes, fits: Sequence[tuple[str, Fit]]) -> None:
    measured = fits[0][1].measured
    axes.plot(
        measured.depth / cm,
        measured.load / kN,
        "s",
        color=INK,
        markersize=3.5,
        label=f"measured: {measured.name}",
    )
    for (rotation, fit), colour in zip(fits, (TRANSMITTED, ROCK)):
        name = (
            f"rotation {rotation}, E_bar {fit.modulus / _E_BAR:.1f} ± {fit.uncertainty / _E_BAR:.1f} kgf/cm², "
            f"error {100 * fit.misfit:.1f} %"
        )
        axes.plot(measured.depth / cm, fit.load / kN, color=colour, label=name)
        axes.fill_between(
            measured.depth / cm,
            (fit.load - fit.load_spread) / kN,
            (fit.load + fit.load_spread) / kN,
            color=colour,
            alpha=0.2,
            linewidth=0,
        )
    axes.set(xlabel="penetration (cm)", ylabel="load (kN)")
    second_scale(axes, kN / kgf, "(kgf)")


def _constants(axes: Axes, calibration: Calibration, printed: Mapping[str, float]) -> None:
    depth, unit = float(calibration.fits[0].measured.depth[-1]), kgf / cm
    found = [
        (push.modulus / _E_BAR, float(push.curve.at(depth)) / depth / unit)
        for push in calibration.pushes
    ]
    axes.plot(
        *zip(*found),
        "o",
        color=TRANSMITTED,
        markersize=2.5,
        alpha=0.5,
        label="computed static tests, one sample each",
    )
    fit = calibration.fits[0]
    moduli = np.linspace(min(x for x, _ in found), max(x for x, _ in found), 60)
    line = float(fit.load[-1]) / depth / unit * (moduli / (fit.modulus / _E_BAR)) ** fit.exponent
    axes.plot(
        moduli,
        line,
        color=TRANSMITTED,
        linewidth=1.0,
        label=f"fit: k goes with E_bar to the {fit.exponent:.2f}",
    )
    wanted = [
        (
            fit.modulus / _E_BAR,
            float(fit.measured.load[-1]) / depth / unit,
            fit.uncertainty / _E_BAR,
        )
        for fit in calibration.fits
    ]
    axes.errorbar(
        [x for x, _, _ in wanted],
        [y for _, y, _ in wanted],
        xerr=[e for _, _, e in wanted],
        fmt="s",
        color=ROCK,
        markersize=4.5,
        linewidth=1.0,
        label="measured k, at the E_bar found",
    )
    if printed:
        axes.plot(
            [printed[fit.measured.name] / _E_BAR for fit in calibration.fits],
            [y for _, y, _ in wanted],
            "s",
            color=INK,
            markersize=4.5,
            markerfacecolor="none",
            label="measured k, at the E_bar printed in table 4",
        )
    else:
        reference_line(axes, wanted[0][1], f"measured, {wanted[0][1]:.1f} kgf/cm", dashes=":")
    axes.axhline(0.0, color=GREY, linewidth=0.7)
    axes.set(
        xlabel="fictitious modulus E_bar (kgf/cm²)", ylabel="secant spring constant k (kgf/cm)"
    )

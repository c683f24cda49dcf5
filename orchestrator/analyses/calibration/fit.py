"""The fit of E_bar to computed static tests.

Near the modulus that is sought, loads go with a power of E_bar (about 1), which is fitted; so every
test says which E_bar its sample would need.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import cm, kgf

from ...core.errors import InputRefused, Problem
from ...metrics.load_curve import LoadCurve
from .measurement import Measurement

_FLAT = 0.2
"""Exponent of the load over E_bar below which E_bar cannot be told from a load."""


@dataclass(frozen=True)
class Push:
    """A computed static test.

    Attributes
    ----------
    modulus : float
        Fictitious modulus (Pa).
    seed : int
        Number of the sample.
    curve : LoadCurve
        Load over penetration.
    """

    modulus: float
    seed: int
    curve: LoadCurve


@dataclass(frozen=True)
class Fit:
    """The modulus that belongs to a measurement, and the curve that the model has with it.

    Attributes
    ----------
    measured : Measurement
        To which it was fitted.
    modulus : float
        Fictitious modulus E_bar (Pa).
    spread : float
        Standard deviation (Pa) of the E_bar that each test alone asks for, as one specimen would.
    misfit : float
        Root mean square of computed less measured load / that of the measured one; the E_bar that
        each point alone asks for scatter by about that.
    exponent : float
        Loads go with E_bar to this power.
    load, load_spread : array of float, shape (n,)
        Computed at the measured penetrations, mean and standard deviation over the tests (N).
    """

    measured: Measurement
    modulus: float
    spread: float
    misfit: float
    exponent: float
    load: NDArray[np.float64]
    load_spread: NDArray[np.float64]

    @property
    def uncertainty(self) -> float:
        """Standard uncertainty (Pa): scatter of the samples and misfit of the curve together."""
        return math.hypot(self.spread, self.modulus * self.misfit / self.exponent)


class Unreachable(InputRefused):
    """The sand does not have such loads with any E_bar."""


def strength(measured: Measurement, curve: LoadCurve) -> float:
    """Return computed loads / measured ones.

    Parameters
    ----------
    measured : Measurement
        With penetrations and loads.
    curve : LoadCurve
        Of a computed test.

    Returns
    -------
    float
        By least squares; 0 where the sand carries nothing.
    """
    computed = curve.at(measured.depth)
    common = float(computed @ measured.load)
    return float(computed @ computed) / common if common > 0.0 else 0.0


def fit(measured: Measurement, pushes: Sequence[Push]) -> Fit:
    """Fit E_bar to a measurement.

    Parameters
    ----------
    measured : Measurement
        With penetrations and loads.
    pushes : sequence of Push
        Tests with several moduli and samples, three at least.

    Returns
    -------
    Fit
        Modulus and curve.

    Raises
    ------
    Unreachable
        The load does not rise with E_bar.
    """
    moduli = np.array([push.modulus for push in pushes])
    strengths = np.array([strength(measured, push.curve) for push in pushes])
    exponent = _exponent(moduli, strengths)
    if not exponent > _FLAT:
        raise unreachable(measured, pushes)
    wanted = np.log(moduli) - np.log(strengths) / exponent
    modulus = float(np.exp(wanted.mean()))
    loads = np.array(
        [push.curve.at(measured.depth) * (modulus / push.modulus) ** exponent for push in pushes]
    )
    load = loads.mean(axis=0)
    return Fit(
        measured=measured,
        modulus=modulus,
        spread=modulus * float(np.std(wanted, ddof=2)),
        misfit=_misfit(measured, load) if measured.is_curve else 0.0,
        exponent=exponent,
        load=load,
        load_spread=loads.std(axis=0, ddof=1),
    )


def _misfit(measured: Measurement, load: NDArray[np.float64]) -> float:
    """Return the root mean square of computed less measured load / that of the measured one."""
    return float(np.sqrt(np.sum((load - measured.load) ** 2) / np.sum(measured.load**2)))


def _exponent(moduli: NDArray[np.float64], strengths: NDArray[np.float64]) -> float:
    """Return the slope of the logarithms; NaN where a sample carries nothing."""
    if not (strengths > 0.0).all():
        return math.nan
    return float(np.polyfit(np.log(moduli), np.log(strengths), 1)[0])


def unreachable(measured: Measurement, pushes: Sequence[Push]) -> Unreachable:
    """Return the refusal of a measurement, with the loads that the sand reaches.

    Parameters
    ----------
    measured : Measurement
        Out of reach.
    pushes : sequence of Push
        Tests that were tried.

    Returns
    -------
    Unreachable
        In terms of the spring constant at the deepest measured point.
    """
    depth = float(measured.depth[-1])
    reached = [float(push.curve.at(depth)) / depth / kgf * cm for push in pushes]
    moduli = [push.modulus / kgf * cm**2 for push in pushes]
    wanted = float(measured.load[-1]) / depth / kgf * cm
    text = (
        f"a spring constant of {wanted:.3g} kgf/cm at {depth / cm:g} cm is out of reach: the sand "
        f"has {min(reached):.3g} to {max(reached):.3g} kgf/cm for E_bar from {min(moduli):.3g} to "
        f"{max(moduli):.3g} kgf/cm2"
    )
    remedy = "another model of the sand (rotation, sand.packing), or look at the measurement"
    return Unreachable([Problem(measured.name, text, remedy)])

"""St. Venant's problem in closed form: a rigid mass strikes an elastic rod.

The toe of the rod reflects the part alpha of every wave. With lambda = Z/M, tau = 2 L/c and f the
velocity of the wave that leaves the head, b = alpha f(t - tau) that of the one that comes back,
M (f + b)' = -Z (f - b) gives the transform

    f = V0 / (s + lambda) / (1 + alpha exp(-s tau) (s - lambda)/(s + lambda))

and thus

    f(t) = V0 sum over n of (-alpha)^n exp(-lambda t_n) L_n(2 lambda t_n),     t_n = t - n tau >= 0,

L_n the Laguerre polynomials: every reflection has its term. Valid until the force first falls to
zero: mass and rod then separate.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq
from scipy.special import eval_laguerre

_SAMPLES = 400
"""Times between two reflections at which the sign of the force is examined."""


@dataclass(frozen=True)
class StVenant:
    """A rigid mass that strikes the head of an elastic rod.

    Attributes
    ----------
    mass : float
        Of the rigid body, M (kg).
    speed : float
        With which it strikes, V0 (m/s, downwards).
    impedance : float
        Of the rod, Z (N s/m).
    travel_time : float
        Of a wave through the rod, L/c (s).
    reflection : float
        Part alpha of a wave that the toe reflects, from -1 (fixed) to 1 (free).
    """

    mass: float
    speed: float
    impedance: float
    travel_time: float
    reflection: float

    @property
    def first_force(self) -> float:
        """Force when the mass strikes (N)."""
        return self.impedance * self.speed

    def wave(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the velocity f of the wave that leaves the head.

        Parameters
        ----------
        time : array_like
            Times since the mass struck (s).

        Returns
        -------
        ndarray
            Velocities (m/s), in the shape of ``time``.
        """
        times = np.asarray(time, dtype=float)
        rate, period = self.impedance / self.mass, 2.0 * self.travel_time
        total = np.zeros_like(times)
        for n in range(self._reflections(float(times.max(initial=0.0))) + 1):
            since = times - n * period
            there = since >= 0.0
            term = (-self.reflection) ** n * np.exp(
                -rate * since, where=there, out=np.zeros_like(times)
            )
            total += np.where(
                there, term * eval_laguerre(n, 2.0 * rate * np.maximum(since, 0.0)), 0.0
            )
        return self.speed * total

    def force(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the force between mass and head.

        Parameters
        ----------
        time : array_like
            Times since the mass struck (s).

        Returns
        -------
        ndarray
            Forces (N, compression positive), in the shape of ``time``; where the force jumps, the
            value after the jump.
        """
        return self.impedance * (self.wave(time) - self._returned(time))

    def velocity(self, time: ArrayLike) -> NDArray[np.float64]:
        """Return the velocity of the mass.

        Parameters
        ----------
        time : array_like
            Times since the mass struck (s).

        Returns
        -------
        ndarray
            Velocities (m/s, downwards), in the shape of ``time``.
        """
        return self.wave(time) + self._returned(time)

    def separation(self, reflections: int = 60) -> float | None:
        """Return the time at which the force first falls to zero.

        Parameters
        ----------
        reflections : int
            Number of reflections that are examined.

        Returns
        -------
        float or None
            Time (s); None if the force does not fall to zero before this number of reflections.
        """
        period = 2.0 * self.travel_time
        for n in range(reflections):
            times = n * period + period * np.linspace(0.0, 1.0, _SAMPLES, endpoint=False)
            forces = self.force(times)
            if forces[0] <= 0.0:
                return n * period
            below = np.flatnonzero(forces <= 0.0)
            if below.size:
                ends = times[below[0] - 1], times[below[0]]
                return float(
                    brentq(
                        lambda time: float(self.force(time)), *ends, xtol=1e-15 * period, rtol=1e-14
                    )
                )
            last = (n + 1) * period * (1.0 - 1e-12)
            if self.force(last) <= 0.0:
                return float(
                    brentq(
                        lambda time: float(self.force(time)),
                        times[-1],
                        last,
                        xtol=1e-15 * period,
                        rtol=1e-14,
                    )
                )
        return None

    def rebound(self) -> float | None:
        """Return the velocity of the mass after the separation.

        Returns
        -------
        float or None
            Velocity (m/s, downwards: negative where it jumps back); None if there is no separation.
        """
        time = self.separation()
        return None if time is None else float(self.velocity(time))

    def _returned(self, time: ArrayLike) -> NDArray[np.float64]:
        return self.reflection * self.wave(np.asarray(time, dtype=float) - 2.0 * self.travel_time)

    def _reflections(self, time: float) -> int:
        return max(0, int(time / (2.0 * self.travel_time) + 1e-9))

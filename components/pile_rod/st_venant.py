"""St. Venant's problem in closed form: a rigid mass strikes an elastic rod whose toe reflects the part alpha of every wave.

With lambda = Z/M, tau = 2 L/c and f the velocity of the wave that leaves the head, b = alpha f(t - tau) that of the one that comes
back, M (f + b)' = -Z (f - b) gives the transform f = V0 / (s + lambda) / (1 + alpha exp(-s tau) (s - lambda)/(s + lambda)) and thus

    f(t) = V0 sum over n of (-alpha)^n exp(-lambda t_n) L_n(2 lambda t_n),     t_n = t - n tau >= 0,

L_n the Laguerre polynomials: every reflection has its term. Valid until the force first falls to zero: mass and rod then separate.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq
from scipy.special import eval_laguerre

_SAMPLES = 400
"""Times between two reflections at which a change of sign is looked for."""


@dataclass(frozen=True)
class StVenant:
    """The problem. mass (kg), its velocity ``speed`` (m/s, downwards), impedance of the rod (N s/m), travel time L/c (s), and the
    reflection alpha at the toe, from -1 (fixed) to 1 (free).
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
        """Velocity f (m/s) of the wave that leaves the head at these times (s)."""
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
        """Force between mass and head (N, compression positive) at these times (s); where it jumps, the value after the jump."""
        return self.impedance * (self.wave(time) - self._returned(time))

    def velocity(self, time: ArrayLike) -> NDArray[np.float64]:
        """Velocity of the mass (m/s, downwards) at these times (s)."""
        return self.wave(time) + self._returned(time)

    def separation(self, reflections: int = 60) -> float | None:
        """Time (s) at which the force first falls to zero; None if it does not before this number of reflections."""
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
        """Velocity of the mass (m/s, downwards: negative where it jumps back) after the separation; None if there is none."""
        time = self.separation()
        return None if time is None else float(self.velocity(time))

    def _returned(self, time: ArrayLike) -> NDArray[np.float64]:
        return self.reflection * self.wave(np.asarray(time, dtype=float) - 2.0 * self.travel_time)

    def _reflections(self, time: float) -> int:
        return max(0, int(time / (2.0 * self.travel_time) + 1e-9))

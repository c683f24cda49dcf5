"""From a guess of the interface's values, and what came back, to the next guess.

All methods look for the z with G(z) = z, where one evaluation of G is one iteration: z are the
values that components are given, G(z) those that come back. They differ in what they learn from
residuals r = G(z) - z.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from ..loop.tables import FloatTable

_MOST_COLUMNS = 60
"""Differences that are kept, at most."""
_REUSED = 6
"""Windows whose differences are kept."""
_DEPENDENT = 1e-7
"""Part of a difference that has to be new, else it is left out."""
_STANDING = 1e-6
"""Part by which the residual that is left has to change, else the method stands."""
_LARGEST_RELAXATION = 1.0
_SMALLEST_RELAXATION = 1e-4


class Accelerator:
    """Interface of a method that looks for values which come back as they were given."""

    def begin(self) -> None:
        """Begin the iterations of another window."""

    def next(self, guess: FloatTable, result: FloatTable, scale: FloatTable) -> FloatTable:
        """Return the next guess.

        Parameters
        ----------
        guess, result : array of float, shape (n,)
            z and G(z) of this iteration.
        scale : array of float, shape (n,)
            Amount of each value, above 0, by which different units are made comparable.
        """
        raise NotImplementedError

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what is known from earlier windows, arrays by name."""
        return {}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""


class FixedPoint(Accelerator):
    """Takes the part of each residual that the two newest ones suggest (Aitken [1]_).

    References
    ----------
    .. [1] Küttler and Wall, Fixed-point fluid-structure interaction solvers with dynamic
       relaxation, Computational Mechanics 43 (2008), 61-72, equation (44).
    """

    def __init__(self) -> None:
        self._relaxation = np.array([_LARGEST_RELAXATION])
        self._before: FloatTable | None = None

    def begin(self) -> None:
        """Begin with the relaxation that was last."""
        self._before = None
        size = abs(float(self._relaxation[0]))
        self._relaxation[0] = min(max(size, _SMALLEST_RELAXATION), _LARGEST_RELAXATION)

    def next(self, guess: FloatTable, result: FloatTable, scale: FloatTable) -> FloatTable:
        """Return the guess that the relaxed residual leads to."""
        residual = result - guess
        if self._before is not None:
            change = (residual - self._before) / scale
            size = float(change @ change)
            if size > 0.0:
                part = float((self._before / scale) @ change) / size
                found = -float(self._relaxation[0]) * part
                self._relaxation[0] = np.clip(found, -_LARGEST_RELAXATION, _LARGEST_RELAXATION)
        self._before = residual
        return guess + float(self._relaxation[0]) * residual

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return the relaxation that was used last."""
        return {"relaxation": self._relaxation}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on with a relaxation that :meth:`memory` gave."""
        self._relaxation = memory["relaxation"].copy()


class LeastSquares(Accelerator):
    """Combines what came back so that the residuals cancel as far as they can.

    With the differences V of residuals and W of results it takes G(z) - W c, where c makes
    r - V c smallest. Within a window this is Anderson's method without damping [1]_; with the
    differences of earlier windows it is the interface quasi-Newton method IQN-ILS [2]_. Columns
    that depend on newer ones are left out [3]_.

    Where the newest difference makes r - V c no smaller, the next guess would be one that was made
    before, and teach nothing: the method would stand there for ever, as GMRES only does for a step
    [4]_. Then the next guess is G(z), whose difference is a new one.

    Parameters
    ----------
    size : int
        Number of values.
    windows : int
        Windows whose differences are kept, at least the present one.

    References
    ----------
    .. [1] Walker and Ni, Anderson acceleration for fixed-point iterations, SIAM J. Numer. Anal. 49
       (2011), 1715-1735.
    .. [2] Degroote, Bathe and Vierendeels, Performance of a new partitioned procedure versus a
       monolithic procedure in fluid-structure interaction, Computers & Structures 87 (2009),
       793-801.
    .. [3] Haelterman et al., Improving the performance of the partitioned QN-ILS procedure for
       fluid-structure interaction problems: filtering, Computers & Structures 171 (2016), 9-17.
    .. [4] Potra and Engler, A characterization of the behavior of the Anderson acceleration on
       linear problems, Linear Algebra and its Applications 438 (2013), 1002-1011.
    """

    def __init__(self, size: int, windows: int) -> None:
        self._windows = windows
        self._residuals = np.zeros((_MOST_COLUMNS, size))
        self._results = np.zeros((_MOST_COLUMNS, size))
        self._ages = np.full(_MOST_COLUMNS, -1, np.int64)
        self._before: tuple[FloatTable, FloatTable] | None = None
        self._left: FloatTable | None = None

    def begin(self) -> None:
        """Begin a window; what is too old is forgotten."""
        self._before = None
        self._left = None
        self._ages[self._ages >= 0] += 1
        self._ages[self._ages >= self._windows] = -1

    def next(self, guess: FloatTable, result: FloatTable, scale: FloatTable) -> FloatTable:
        """Return the guess whose residual would be smallest, as far as is known."""
        residual = result - guess
        if self._before is not None:
            self._learn(residual - self._before[0], result - self._before[1])
        self._before = residual, result
        known = int(np.count_nonzero(self._ages >= 0))
        with _libraries().limit(limits=1, user_api="blas"):
            weights, places = _combination(self._residuals[:known] / scale, residual / scale)
            left = (residual - weights @ self._residuals[places]) / scale
            stands = self._left is not None and _is_same(left, self._left, residual / scale)
            self._left = left
            return result if stands else result - weights @ self._results[places]

    def _learn(self, residual: FloatTable, result: FloatTable) -> None:
        """Put a pair of differences in front of the others."""
        if not np.any(residual):
            return
        for table, newest in ((self._residuals, residual), (self._results, result)):
            table[1:] = table[:-1].copy()
            table[0] = newest
        self._ages[1:] = self._ages[:-1].copy()
        self._ages[0] = 0

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return the differences and their ages."""
        return {"residuals": self._residuals, "results": self._results, "ages": self._ages}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over differences and ages."""
        self._residuals = memory["residuals"].copy()
        self._results = memory["results"].copy()
        self._ages = memory["ages"].copy()


@cache
def _libraries() -> ThreadpoolController:
    """Return the libraries of linear algebra of this process.

    They get one thread: sums of several threads are rounded otherwise with each number of
    threads, and threads that wait for tables as small as these take more time than the sums.
    """
    return ThreadpoolController()


def _is_same(left: FloatTable, before: FloatTable, residual: FloatTable) -> bool:
    """Tell whether a residual that combinations leave is that of before, and not rounding."""
    size = float(np.linalg.norm(left))
    is_rounding = size <= _DEPENDENT * float(np.linalg.norm(residual))
    return not is_rounding and float(np.linalg.norm(left - before)) <= _STANDING * size


def _combination(
    rows: NDArray[np.float64], aim: FloatTable
) -> tuple[FloatTable, NDArray[np.int64]]:
    """Return the weights of the rows that come nearest to an aim together, and which rows.

    Rows that hardly differ from a combination of those before them are left out.
    """
    places = np.arange(min(len(rows), aim.size))
    while places.size:
        q, r = np.linalg.qr(rows[places].T)
        sizes = np.sqrt(np.einsum("ij,ij->j", r, r))
        new = np.abs(np.diagonal(r))
        is_new = new > _DEPENDENT * np.maximum(sizes, np.finfo(float).tiny)
        if is_new.all():
            return np.linalg.solve(r, q.T @ aim), places
        places = places[is_new]
    return np.zeros(0), places


def acceleration_of(method: str, size: int) -> Accelerator:
    """Return a method by its name in a system, for so many values."""
    if method == "fixed_point":
        return FixedPoint()
    return LeastSquares(size, _REUSED if method == "quasi_newton" else 1)

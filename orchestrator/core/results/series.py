"""A variable of a run over time, with its unit."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Series(NDArrayOperatorsMixin):
    """A recorded variable over time. Arithmetic, numpy and matplotlib take it as its values.

    Attributes
    ----------
    name : str
        ``component.variable``.
    unit : str
        FMI unit of the values, ``1`` where there is none.
    description : str
        Of the variable, as its FMU has it.
    time : array of float, shape (n,)
        Simulated time of each value (s).
    values : array of float, shape (n,)
        In ``unit``.
    """

    name: str
    unit: str
    description: str
    time: NDArray[np.float64]
    values: NDArray[np.float64]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype) if copy else np.asarray(self.values, dtype)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        plain = [entry.values if isinstance(entry, Series) else entry for entry in inputs]
        return getattr(ufunc, method)(*plain, **options)

    def max(self, **options: Any) -> Any:
        """Return the largest value, in ``unit``; numpy passes its options."""
        return self.values.max(**options)

    def min(self, **options: Any) -> Any:
        """Return the least value, in ``unit``; numpy passes its options."""
        return self.values.min(**options)

    def __len__(self) -> int:
        return int(self.values.size)

    def __getitem__(self, place: Any) -> Any:
        return self.values[place]

    def __iter__(self) -> Iterator[float]:
        return iter(self.values.tolist())

    def __repr__(self) -> str:
        head = f"<{self.name} ({self.unit})"
        if not len(self):
            return f"{head}: no values>"
        span = f"t = {self.time[0]:.6g} to {self.time[-1]:.6g} s"
        reach = f"{self.values.min():.6g} to {self.values.max():.6g}"
        return f"{head}: {len(self)} values, {span}, {reach}>"

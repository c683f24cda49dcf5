"""Variables of a run over time, with their units."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
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

    def _repr_html_(self) -> str:
        return SeriesTable(self.time, {self.name: self})._repr_html_()


@dataclass(frozen=True, eq=False, repr=False)
class SeriesTable(Mapping[str, Series]):
    """Several variables of a run over the same time, by name, in the order of the results.

    Attributes
    ----------
    time : array of float, shape (n,)
        Simulated time of each row (s).
    series : mapping of str to Series
        The variables.
    """

    time: NDArray[np.float64]
    series: Mapping[str, Series]

    @property
    def values_by_row(self) -> NDArray[np.float64]:
        """All values, shape (n, variables), a column for each variable, in its unit."""
        return np.column_stack([entry.values for entry in self.series.values()])

    def to_pandas(self) -> Any:
        """Return the variables as a pandas table. pandas has to be installed.

        Returns
        -------
        pandas.DataFrame
            A column for each variable, ``time`` (s) as the index.
        """
        import pyarrow as pa

        columns = {"time": self.time, **{name: s.values for name, s in self.series.items()}}
        return pa.table(columns).to_pandas().set_index("time")

    def __getitem__(self, name: str) -> Series:
        return self.series[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.series)

    def __len__(self) -> int:
        return len(self.series)

    def __repr__(self) -> str:
        return "\n".join(map(repr, self.series.values()))

    def _repr_html_(self) -> str:
        titles = ("variable", "unit", "values", "first", "last", "least", "largest", "description")
        head = "".join(f"<th>{title}</th>" for title in titles)
        body = "".join(f"<tr>{''.join(_cells(entry))}</tr>" for entry in self.series.values())
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cells(series: Series) -> Iterator[str]:
    """Yield the cells of a variable in a table of a notebook."""
    values = series.values
    shown = (values[0], values[-1], values.min(), values.max()) if values.size else ()
    numbers = [f"{value:.6g}" for value in shown] or [""] * 4
    for text in (series.name, series.unit, str(values.size), *numbers, series.description):
        yield f"<td>{escape(text)}</td>"

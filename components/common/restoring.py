"""Whether serialized numbers can be a state of a component.

A state may come from a file that somebody has damaged or made up. Kernels use some of its numbers
as indices without looking at them again, so all are looked at before they are taken over.
"""

import numpy as np
from numpy.typing import NDArray

from .ports import IndexRange, Layout, Sizes

TABLE_DIFFERS = "its table of arrays is not that of this component"
NUMBER_NOT_FINITE = "a number in it is not finite"
INDEX_WRONG = "an index in %s is out of its range"
"""Reasons, which a native FMU gives too; the last as a format of printf: of an array's name."""


def state_problem(
    layout: Layout,
    sizes: Sizes,
    values: NDArray[np.float64],
    integers: NDArray[np.int64],
    computed: bool,
) -> str:
    """Return why numbers cannot be a state.

    Parameters
    ----------
    layout : Layout
        Declarations of the component.
    sizes : mapping of str to int
        Sizes that it is built with.
    values : ndarray, shape (w + x,)
        The buffers ``w`` and ``x``, one behind the other.
    integers : ndarray of int64, shape (k,)
        The buffer ``k``.
    computed : bool
        Whether the component was initialised. Before, its hidden arrays hold nothing.

    Returns
    -------
    str
        The first reason; empty if there is none.
    """
    table, length, *_ = layout.table(sizes)
    if integers[: len(table)].tolist() != table:
        return TABLE_DIFFERS
    if not np.isfinite(values).all():
        return NUMBER_NOT_FINITE
    if computed:
        for indices in layout.index_ranges(sizes):
            if not _in_range(indices, integers if indices.integer else values[length:]):
                return INDEX_WRONG % indices.array
    return ""


def _in_range(indices: IndexRange, buffer: NDArray[np.float64] | NDArray[np.int64]) -> bool:
    """Tell whether all indices are whole numbers in their range."""
    numbers, declared = buffer[indices.places], indices.declared
    lowest, width = declared.bits
    if lowest or width < 64:
        numbers = (numbers >> lowest) & ((1 << width) - 1)  # type: ignore[operator]
    allowed = (numbers >= indices.low) & (numbers <= indices.high)
    if not allowed.all() or (numbers % declared.multiple).any():
        return False
    if not indices.integer and (numbers % 1.0).any():
        return False
    return not declared.ascending or bool((np.diff(numbers) >= 0).all())

"""Columns of a result table, with unit and description in the metadata of each field."""

from collections.abc import Sequence
from typing import Any

WORK_OF_SCENARIO = "coupling.scenario.work"
"""Column with the work (J) of what a scenario imposes on power ports."""
ArrowColumn = tuple[Any, Any]
"""Values of a column, and its field: name, type and metadata."""


def result_column(name: str, values: Any, unit: str, description: str) -> ArrowColumn:
    """Make a column of a result table.

    Parameters
    ----------
    name, unit, description : str
        FMI unit, ``1`` where there is none.
    values : array or sequence
        NaN and None become null.

    Returns
    -------
    ArrowColumn
    """
    import pyarrow as pa

    array = values if isinstance(values, pa.Array) else pa.array(values, from_pandas=True)
    return array, pa.field(name, array.type, metadata={"unit": unit, "description": description})


def result_table(columns: Sequence[ArrowColumn]) -> Any:
    """Join columns to an Arrow table."""
    import pyarrow as pa

    return pa.table(
        [array for array, _ in columns], schema=pa.schema([field for _, field in columns])
    )

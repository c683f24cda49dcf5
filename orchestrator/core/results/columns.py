"""Columns of a result table, with unit and description in the metadata of each field."""

from collections.abc import Sequence
from typing import Any

Column = tuple[Any, Any]
"""Values and field."""


def result_column(name: str, values: Any, unit: str, description: str) -> Column:
    """A column; NaN and None are null."""
    import pyarrow as pa

    array = values if isinstance(values, pa.Array) else pa.array(values, from_pandas=True)
    return array, pa.field(name, array.type, metadata={"unit": unit, "description": description})


def result_table(columns: Sequence[Column]) -> Any:
    """The columns as an Arrow table."""
    import pyarrow as pa

    return pa.table(
        [array for array, _ in columns], schema=pa.schema([field for _, field in columns])
    )

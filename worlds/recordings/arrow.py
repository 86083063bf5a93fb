"""Columns of a recording to and from an Arrow table: NaN here, null there."""

from collections.abc import Mapping

import pyarrow as pa

from groundwalk.arrays import FloatArray


def to_table(columns: Mapping[str, FloatArray]) -> pa.Table:
    """The columns as an Arrow table; a NaN becomes a null."""
    return pa.table(
        {name: pa.array(values, from_pandas=True) for name, values in columns.items()}
    )


def from_table(table: pa.Table) -> dict[str, FloatArray]:
    """The columns of a table of numbers of any kind; a null becomes a NaN.

    Integers that no float equals are rounded.
    """
    return {
        name: values.cast(pa.float64(), safe=False).to_numpy()
        for name, values in zip(table.column_names, table.columns, strict=True)
    }

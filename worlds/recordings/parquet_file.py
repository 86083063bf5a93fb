"""Reads and writes a recording's columns and metadata as Parquet."""

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from worlds.recordings.columns import check_names

_KEY = b"groundwalk"


def read_parquet(path: Path) -> tuple[dict[str, FloatArray], bytes | None]:
    """Read the columns and the metadata text.

    Args:
      path: the file.

    Returns:
      The columns, and the text or None where there is none.

    Raises:
      BadRecordingError: it is no whole Parquet file, or its columns are not those of
        a recording.
      OSError: the file system does not give it.
    """
    with path.open("rb") as file:
        try:
            parquet = pq.ParquetFile(file, page_checksum_verification=True)
            schema = parquet.schema_arrow
            _check_schema(schema)
            table = parquet.read()
        except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
            reason = str(error).splitlines()[0]
            raise BadRecordingError(f"cannot be read as Parquet: {reason}") from error
    return from_table(table), (schema.metadata or {}).get(_KEY)


def parquet_bytes(columns: Mapping[str, FloatArray], metadata: str) -> bytes:
    """The content of a Parquet file.

    Args:
      columns: values by name, of equal length.
      metadata: JSON text.
    """
    table = to_table(columns).replace_schema_metadata({_KEY: metadata})
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content


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


def _check_schema(schema: pa.Schema) -> None:
    check_names(schema.names)
    for column in schema:
        kind = column.type
        is_number = pa.types.is_floating(kind) or pa.types.is_integer(kind)
        # Some writers give a column without any value the type null.
        if not (is_number or pa.types.is_decimal(kind) or pa.types.is_null(kind)):
            raise BadRecordingError(f"column {column.name!r} holds {kind}, not numbers")

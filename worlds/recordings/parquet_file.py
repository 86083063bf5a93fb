"""Reads and writes the columns and metadata of a recording as Parquet."""

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from worlds.recordings.columns import check_names

_KEY = b"groundwalk"


def read_parquet(path: Path) -> tuple[dict[str, FloatArray], bytes | None]:
    """Read the columns and the metadata of a recording from a Parquet file.

    Returns:
      Values (rows,) by column name, NaN where one is missing; and the metadata as JSON
      text, None if the file has none.

    Raises:
      BadRecordingError: the file is damaged or no Parquet file, or its columns are not
        those of a recording.
      OSError: the file cannot be read.
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
    """Turn columns (rows,) and metadata, a JSON text, into a Parquet file's content."""
    table = to_table(columns).replace_schema_metadata({_KEY: metadata})
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def to_table(columns: Mapping[str, FloatArray]) -> pa.Table:
    """Turn columns (rows,) by name into an Arrow table; a NaN becomes a null."""
    return pa.table(
        {name: pa.array(values, from_pandas=True) for name, values in columns.items()}
    )


def from_table(table: pa.Table) -> dict[str, FloatArray]:
    """Turn an Arrow table of numbers into float columns (rows,) by name.

    A null becomes a NaN; an integer that no float equals is rounded.
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

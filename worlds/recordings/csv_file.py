"""Reads and writes the columns of a recording as CSV."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import BinaryIO

import pyarrow as pa
import pyarrow.csv

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from worlds.recordings.columns import check_names
from worlds.recordings.parquet_file import from_table, to_table
from worlds.recordings.values import bad_value

_OTHER_SEPARATORS = (";", "\t", "|")
"""Characters other than the comma that programs write between the columns of a CSV."""


def read_csv(path: Path) -> dict[str, FloatArray]:
    """Read columns (rows,) by name; missing values, empty cells or `nan`, become NaN.

    Args:
      path: a CSV file in UTF-8, with commas and with column names in the first line.

    Raises:
      BadRecordingError: the text is no such CSV, its columns are not those of a
        recording, or a cell holds no number.
      OSError: the file cannot be read.
    """
    names = _header(path)
    separator = next((one for one in _OTHER_SEPARATORS if one in "".join(names)), "")
    if len(names) == 1 and separator:
        raise BadRecordingError(
            f"its columns are separated by {separator!r}; a recording has commas "
            "between columns and points in numbers"
        )
    check_names(names)
    schema = pa.schema([(name, pa.float64()) for name in names])
    with path.open("rb") as file:
        return from_table(pa.Table.from_batches(_batches(file, names), schema))


def csv_bytes(columns: Mapping[str, FloatArray]) -> bytes:
    """Turn columns (rows,) into CSV, with enough digits to read back equal floats."""
    sink = pa.BufferOutputStream()
    pa.csv.write_csv(to_table(columns), sink)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def _header(path: Path) -> list[str]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return next(csv.reader(file), [])
    except (UnicodeDecodeError, csv.Error) as error:
        raise BadRecordingError(f"cannot be read as CSV: {error}") from error


def _batches(file: BinaryIO, names: Sequence[str]) -> Iterator[pa.RecordBatch]:
    """Read blocks of rows below a CSV file's header; `names` are its column names.

    Cells are read as text before they become numbers, so that errors can name a cell.
    """
    uneven: list[pa.csv.InvalidRow] = []

    def stop(row: pa.csv.InvalidRow) -> str:
        uneven.append(row)
        return "error"

    start = 0
    try:
        for batch in pa.csv.open_csv(
            file,
            pa.csv.ReadOptions(use_threads=False, column_names=names, skip_rows=1),
            pa.csv.ParseOptions(invalid_row_handler=stop),
            pa.csv.ConvertOptions(
                column_types=dict.fromkeys(names, pa.string()),
                null_values=[""],
                strings_can_be_null=True,
            ),
        ):
            yield _numbers(batch, start)
            start += batch.num_rows
    except pa.ArrowException as error:
        raise _unreadable(error, uneven) from error


def _unreadable(
    error: Exception, uneven: Sequence[pa.csv.InvalidRow]
) -> BadRecordingError:
    if not uneven:
        return BadRecordingError(f"cannot be read as CSV: {error}")
    line = uneven[0]  # lines count from 1, and the header is the first
    return BadRecordingError(
        f"row {line.number - 2} (counted from 0) has {line.actual_columns} cells, "
        f"the header has {line.expected_columns}"
    )


def _numbers(batch: pa.RecordBatch, start: int) -> pa.RecordBatch:
    """Turn a batch of text into floats; its first row is row `start` of the file."""
    columns = []
    for name, cells in zip(batch.schema.names, batch.columns, strict=True):
        try:
            columns.append(cells.cast(pa.float64()))
        except pa.ArrowInvalid:
            row = next(i for i, cell in enumerate(cells) if not _is_number(cell))
            text = cells[row].as_py()
            raise bad_value(name, start + row, f"{text!r} is not a number") from None
    return pa.record_batch(columns, names=batch.schema.names)


def _is_number(cell: pa.StringScalar) -> bool:
    try:
        cell.cast(pa.float64())
    except pa.ArrowInvalid:
        return False
    return True

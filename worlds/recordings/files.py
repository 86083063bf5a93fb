"""Reads and writes recordings: Parquet, or CSV with metadata in a .json file beside."""

import csv
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from groundwalk.files import write_bytes, write_text
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording, bad_value, check_names

_KEY = b"groundwalk"


def read_parquet(path: Path) -> tuple[dict[str, FloatArray], bytes | None]:
    """Columns (rows,) by name of a recording, and its metadata as JSON text, if any.

    A missing value is NaN. Raises BadRecordingError if the file is damaged, is no
    Parquet file or lacks columns, and OSError if it cannot be read.
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
    return _from_table(table), (schema.metadata or {}).get(_KEY)


def _from_table(table: pa.Table) -> dict[str, FloatArray]:
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


_OTHER_SEPARATORS = (";", "\t", "|")
"""Characters other than the comma that programs write between the columns of a CSV."""


def read_csv(path: Path) -> dict[str, FloatArray]:
    """Read columns (rows,) by name; missing values, empty cells or `nan`, become NaN.

    The file is UTF-8, has commas, and column names in its first line. Raises
    BadRecordingError if it is no such CSV or no recording, OSError if it cannot be
    read.
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
        return _from_table(pa.Table.from_batches(_batches(file, names), schema))


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


def read_recording(path: Path, metadata: RecordingMetadata | None = None) -> Recording:
    """Read a recording and check all of its columns and metadata.

    Args:
      path: a `.parquet` or a `.csv` file. A CSV file has an empty cell (or `nan`)
        where a value is missing, and its metadata in a `.json` file of the same name.
      metadata: used instead of the file's own metadata; None to read those.

    Raises:
      BadRecordingError: the file cannot be read or is no recording. The message names
        the file, and the column and row of the first fault.

    Example:
      >>> recording = read_recording(Path("walk.parquet"))
      >>> recording.joint_values("position", recording.joints).shape
    """
    is_csv = _is_csv(path)
    with _naming(path):
        if path.stat().st_size == 0:
            raise BadRecordingError("the file is empty (0 bytes)")
        if is_csv:
            columns = read_csv(path)
        else:
            columns, text = read_parquet(path)
    if metadata is None:
        metadata = _metadata_beside(path) if is_csv else _metadata_inside(path, text)
    with _naming(path):
        return Recording(columns, metadata)


def write_recording(recording: Recording, path: Path) -> None:
    """Write a recording into a file, atomically; equal recordings give equal bytes.

    The path must end with .parquet or .csv. Missing values (NaN) become nulls (Parquet)
    or empty cells (CSV); all other values are read back bit by bit. Beside a `.csv`
    file, a `.json` file is written.

    Example:
      >>> write_recording(recording, Path("swing.parquet"))
    """
    is_csv, text = _is_csv(path), recording.metadata.to_json()
    columns = recording.columns.items()
    # A NaN becomes a null.
    table = pa.table({name: pa.array(v, from_pandas=True) for name, v in columns})
    sink = pa.BufferOutputStream()
    if is_csv:
        write_text(path.with_suffix(".json"), text + "\n")
        pa.csv.write_csv(table, sink)
    else:
        table = table.replace_schema_metadata({_KEY: text})
        pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    write_bytes(path, sink.getvalue().to_pybytes())


def _is_csv(path: Path) -> bool:
    suffix = path.suffix.lower()
    if suffix not in (".csv", ".parquet"):
        raise BadRecordingError(f"{path}: a recording is a .parquet or a .csv file")
    return suffix == ".csv"


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Put the file's path in front of the message of an error raised inside."""
    try:
        yield
    except BadRecordingError as error:
        raise BadRecordingError(f"{path}: {error}") from error
    except FileNotFoundError as error:
        raise BadRecordingError(f"{path}: no such file") from error
    except OSError as error:
        reason = error.strerror or error
        raise BadRecordingError(f"{path}: cannot be read: {reason}") from error


def _metadata_beside(path: Path) -> RecordingMetadata:
    beside = path.with_suffix(".json")
    if not beside.exists():
        raise BadRecordingError(
            f"{path}: a CSV file says nothing of robot, base and source; write "
            f'{beside.name} beside it, such as {{"format": 1, "robot": "nao", "base": '
            f'"floating", "source": "..."}}, or give the metadata as an argument'
        )
    with _naming(beside):
        return RecordingMetadata.from_json(beside.read_bytes())


def _metadata_inside(path: Path, text: bytes | None) -> RecordingMetadata:
    with _naming(path):
        if text is None:
            raise BadRecordingError(
                "no metadata under the key 'groundwalk'; write them into the file or "
                "give them as an argument"
            )
        return RecordingMetadata.from_json(text)

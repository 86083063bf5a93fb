"""Reads and writes recordings: Parquet, or CSV with metadata in a .json file beside."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from groundwalk.errors import BadRecordingError
from groundwalk.files import write_bytes, write_text
from worlds.recordings.csv_file import csv_bytes, read_csv
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.parquet_file import parquet_bytes, read_parquet
from worlds.recordings.recording import Recording


def read_recording(path: Path, metadata: RecordingMetadata | None = None) -> Recording:
    """Read a recording and check all of its columns and metadata.

    Args:
      path: a `.parquet` or a `.csv` file. A CSV file has an empty cell (or `nan`)
        where a value is missing, and its metadata in a `.json` file of the same name.
      metadata: used instead of the file's own metadata; None to read those.

    Raises:
      BadRecordingError: the file cannot be read or is no recording. The message names
        the file, and the column and row of the first fault.
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

    Missing values (NaN) become nulls (Parquet) or empty cells (CSV); all other values
    are read back bit by bit. Beside a `.csv` file, a `.json` file is written.

    Raises:
      BadRecordingError: the path ends with neither .parquet nor .csv.

    Example:
      >>> write_recording(recording, Path("swing.parquet"))
    """
    if _is_csv(path):
        write_text(path.with_suffix(".json"), recording.metadata.to_json() + "\n")
        write_bytes(path, csv_bytes(recording.columns))
    else:
        text = recording.metadata.to_json()
        write_bytes(path, parquet_bytes(recording.columns, text))


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

"""Reads CSV tables of any program: names of columns, and numbers of some of them."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, UnknownNameError

_SEPARATORS = ",;\t|"
_MISSING = ("", "nan", "NaN", "NAN", "null", "None", "NA")


@dataclass(frozen=True, eq=False)
class ForeignTable:
    """A table of text: its file, and the cells (rows,) of each column by its name."""

    path: Path
    cells: Mapping[str, pa.ChunkedArray]
    decimal_comma: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in the file's order."""
        return tuple(self.cells)

    def numbers(self, name: str) -> FloatArray:
        """The numbers (rows,) of a column; a missing one is NaN.

        Raises:
          UnknownNameError: there is no such column.
          ForeignFileError: a cell holds something else; names its row.
        """
        if name not in self.cells:
            raise UnknownNameError(f"column of {self.path}", name, self.cells)
        texts = self._plain(self.cells[name])
        try:
            values: FloatArray = texts.cast(pa.float64()).to_numpy()
        except pa.ArrowInvalid:
            row = next(
                k for k, text in enumerate(texts) if not _is_number(text.as_py())
            )
            raise ForeignFileError(
                f"{self.path}: column {name!r}, row {row} (counted from 0): "
                f"{texts[row].as_py()!r} is not a number"
            ) from None
        return values

    def is_numeric(self, name: str) -> bool:
        """Whether the first cell of a column that is not empty holds a number."""
        texts = self._plain(self.cells[name]).drop_null()
        return bool(len(texts)) and _is_number(texts[0].as_py())

    def _plain(self, cells: pa.ChunkedArray) -> pa.ChunkedArray:
        """Cells as Arrow reads numbers; a missing one is null."""
        texts = pc.utf8_trim_whitespace(cells)
        if self.decimal_comma:
            texts = pc.replace_substring(texts, ",", ".")
        missing = pc.is_in(texts, pa.array(_MISSING))
        return pc.if_else(missing, pa.scalar(None, pa.string()), texts)


def read_table(path: Path) -> ForeignTable:
    """Read a CSV file with names of columns in its first line.

    Commas, semicolons, tabs or bars separate the columns; with one of the latter three
    numbers may have a comma for the point.

    Raises:
      ForeignFileError: the file is missing, empty or no table.
    """
    names, separator = _header(path)
    uneven: list[pa.csv.InvalidRow] = []

    def stop(row: pa.csv.InvalidRow) -> str:
        uneven.append(row)
        return "error"

    try:
        table = pa.csv.read_csv(
            path,
            pa.csv.ReadOptions(use_threads=False, column_names=names, skip_rows=1),
            pa.csv.ParseOptions(delimiter=separator, invalid_row_handler=stop),
            pa.csv.ConvertOptions(column_types=dict.fromkeys(names, pa.string())),
        )
    except (pa.ArrowException, OSError) as error:
        if uneven:
            row = uneven[0]
            raise ForeignFileError(
                f"{path}: row {row.number - 2} (counted from 0) has "
                f"{row.actual_columns} cells, the header {row.expected_columns}"
            ) from error
        reason = str(error).partition("\n")[0]
        raise ForeignFileError(f"{path}: cannot be read as CSV: {reason}") from error
    if not table.num_rows:
        raise ForeignFileError(f"{path}: no row is below the header")
    cells = dict(zip(names, table.columns, strict=True))
    return ForeignTable(path, cells, decimal_comma=separator != ",")


def _header(path: Path) -> tuple[list[str], str]:
    """Names of the columns, and what separates them."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            line = file.readline()
    except FileNotFoundError:
        raise ForeignFileError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ForeignFileError(f"{path}: cannot be read as CSV: {error}") from error
    if not line.strip():
        raise ForeignFileError(f"{path}: the first line has no names of columns")
    separator = max(_SEPARATORS, key=line.count)
    names = [
        name.strip().lstrip("#").strip()
        for name in next(csv.reader([line], delimiter=separator))
    ]
    if all(_is_number(name) for name in names):
        raise ForeignFileError(
            f"{path}: the first line holds numbers; write the columns' names there"
        )
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ForeignFileError(f"{path}: two columns are called {twice[0]!r}")
    return names, separator


def _is_number(text: str | None) -> bool:
    if text is None:
        return True
    try:
        pa.scalar(text).cast(pa.float64())
    except pa.ArrowInvalid:
        return False
    return True

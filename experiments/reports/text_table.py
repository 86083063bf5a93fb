"""Tables on standard output: set in columns, on a terminal with colours."""

import sys
from collections.abc import Sequence


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table; into a file or a pipe as plain lines that are never wrapped.

    Args:
      columns: their headings; only texts of the last one are wrapped.
      rows: of as many texts each.
    """
    if not sys.stdout.isatty():
        print(*_aligned([columns, *rows]), sep="\n")
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Column, Table

    last = len(columns) - 1
    headings = [
        Column(escape(text), no_wrap=column < last)
        for column, text in enumerate(columns)
    ]
    table = Table(*headings, box=None, pad_edge=False)
    for row in rows:
        table.add_row(*map(escape, row))
    Console().print(table)


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]

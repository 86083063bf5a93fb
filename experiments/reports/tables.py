"""Tables and results on standard output: coloured on a terminal, plain in a pipe."""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

Scores = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Speed and falls (the fields of a `Score`) by world, "sim" or "real", and gait."""

SCORE_HEADINGS = ("world", "gait", "speed [cm/s]", "falls")
"""Headings of the table of scores, whose rows `score_rows` makes."""


def print_table(
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    colours: Sequence[str] = (),
) -> None:
    """Print a table; in a file or pipe (and without rich) lines are never wrapped.

    On a terminal only the last column is wrapped, and `colours`, such as "red", are
    those of each row's first cell.

    Example:
      >>> print_table(["robot", "joints"], [["nao", "22"]])
      robot  joints
      nao    22
    """
    try:
        from rich.console import Console
        from rich.table import Column, Table
        from rich.text import Text
    except ImportError:
        plain = True
    else:
        plain = not sys.stdout.isatty()
    if plain:
        print(*_aligned([columns, *rows]), sep="\n")
        return
    last = len(columns) - 1
    headings = [
        Column(Text(text), no_wrap=column < last) for column, text in enumerate(columns)
    ]
    table = Table(*headings, box=None, pad_edge=False)
    for i, (first, *others) in enumerate(rows):
        coloured = Text(first, style=colours[i] if colours else "")
        table.add_row(coloured, *map(Text, others))
    Console().print(table)


def score_rows(scores: Scores) -> list[tuple[str, str, str, str]]:
    """Rows (world, gait, speed [cm/s], falls) of texts, one for each world and gait."""
    return [
        (
            world,
            gait,
            f"{score['speed_cm_s']:.1f} ± {score['speed_std']:.1f}",
            f"{score['falls']}/{score['trials']}",
        )
        for world, gaits in scores.items()
        for gait, score in gaits.items()
    ]


def print_result(
    as_json: bool,
    result: Mapping[str, Any],
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    folder: Path,
) -> None:
    """Print a run's result as JSON, or as a table with the path of the run's folder."""
    if as_json:
        print_json(result)
    else:
        print_table(columns, rows)
        print_folder(folder)


def print_json(result: Mapping[str, Any]) -> None:
    """Print a result as JSON, the only text on standard output, for other programs."""
    print(json.dumps(result, indent=1))


def print_folder(folder: Path) -> None:
    """Print the path of the run folder, which holds pages, pictures and recordings."""
    print(f"Results written to {folder}")


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]

"""Scores as a table on the console."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

Scores = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""World, then gait, then the fields of a `Score`."""


def table_rows(scores: Scores) -> list[tuple[str, str, str, str]]:
    """World, gait, speed with its spread, and falls, as text."""
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


def print_scores(scores: Scores, folder: Path) -> None:
    """Print the table, and where the run's files are."""
    from rich.console import Console
    from rich.table import Table

    table = Table("world", "gait", "speed [cm/s]", "falls", box=None)
    for row in table_rows(scores):
        table.add_row(*row)
    console = Console(width=None if sys.stdout.isatty() else 80, highlight=False)
    console.print(table)
    console.print(f"everything else is in {folder}")


def print_json(result: Mapping[str, Any]) -> None:
    """Print a result for programs: nothing else goes to standard output."""
    print(json.dumps(result, indent=1))

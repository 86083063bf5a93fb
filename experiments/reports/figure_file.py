"""Figures as PNG files."""

import io
from pathlib import Path
from typing import TYPE_CHECKING

from groundwalk.files import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_figure(figure: "Figure", path: Path) -> None:
    """Write a figure as a PNG file, whole or not at all.

    Args:
      figure: a figure made without pyplot, which therefore needs no closing.
      path: the file.
    """
    png = io.BytesIO()
    figure.savefig(png, format="png")
    write_bytes(path, png.getvalue())

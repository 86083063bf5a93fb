"""Figures as PNG files."""

import io
from pathlib import Path
from typing import TYPE_CHECKING

from groundwalk.files import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_figure(figure: "Figure", path: Path) -> None:
    """Write a figure as PNG, the file at once.

    Args:
      figure: made by itself, without pyplot, so that nobody else has to close it.
      path: the file.
    """
    png = io.BytesIO()
    figure.savefig(png, format="png")
    write_bytes(path, png.getvalue())

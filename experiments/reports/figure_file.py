"""Writes Matplotlib figures as PNG files."""

import io
from pathlib import Path
from typing import TYPE_CHECKING

from groundwalk.files import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_figure(figure: "Figure", path: Path) -> None:
    """Write a figure as a PNG file; after an error no partial file remains.

    The figure must be made without pyplot, so that it need not be closed.
    """
    png = io.BytesIO()
    figure.savefig(png, format="png")
    write_bytes(path, png.getvalue())

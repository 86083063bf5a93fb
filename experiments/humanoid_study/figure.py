"""One picture of several robots' walks, all of one scale."""

from collections.abc import Mapping
from pathlib import Path

from experiments.reports.figure_file import write_figure
from experiments.seeing.scenes import make_scenes
from experiments.seeing.walk_figure import walk_figure
from experiments.seeing.walk_strip import walk_strip
from worlds import Recording

COLUMNS = 3
DOTS_PER_INCH = 80
"""Three panels are as wide as a page of text can show."""


def draw_humanoids(recordings: Mapping[str, Recording], path: Path) -> None:
    """Draw a walk of each robot into a PNG file, three side by side.

    Args:
      recordings: by the name of the scene.
      path: the file.
    """
    strips = [walk_strip(scene) for scene in make_scenes(recordings)]
    placed = {f"{i % COLUMNS}/{i // COLUMNS}": strip for i, strip in enumerate(strips)}
    write_figure(walk_figure(placed, DOTS_PER_INCH), path)

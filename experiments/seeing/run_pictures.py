"""Draws a run: its search, its walks, and its recordings in Rerun."""

from pathlib import Path

from experiments.runs.folder import HISTORY, RECORDINGS, RunFolder
from experiments.seeing.scenes import make_scenes, read_recordings
from experiments.seeing.search_figure import draw_search
from experiments.seeing.walk_figure import draw_walk
from groundwalk.errors import RunFolderError
from worlds.rerun_files.log import write_rrd

SEARCH_PICTURE, WALK_PICTURE, WALK_RERUN = "search.png", "walk.png", "walk.rrd"
OVERLAY = "overlay.rrd"


def picture_run(folder: RunFolder) -> None:
    """Draw a run's history and all of its recordings, as far as there are any."""
    picture_search(folder)
    recordings = read_recordings(folder.path / RECORDINGS)
    if recordings:
        draw_walk(recordings, folder.path / WALK_PICTURE)
        write_rrd(folder.path / WALK_RERUN, make_scenes(recordings))


def picture_search(folder: RunFolder) -> Path | None:
    """Draw a run's search, unless that was done since its last generation.

    Returns:
      The picture; None if there is no history, as before the first generation.

    Raises:
      RunFolderError: the history is damaged.
    """
    history, picture = folder.path / HISTORY, folder.path / SEARCH_PICTURE
    if not history.exists():
        return None
    if not picture.exists() or picture.stat().st_mtime < history.stat().st_mtime:
        generations = folder.read_json(HISTORY).get("generations")
        if not generations:
            raise RunFolderError(f"{history} holds no generations")
        draw_search(generations, picture)
    return picture

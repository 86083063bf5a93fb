"""Draws the search and the walks of a run, and writes its recordings for Rerun."""

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
    """Draw a run's search and walks, and write a Rerun file, as far as it has data."""
    picture_search(folder)
    recordings = read_recordings(folder.path / RECORDINGS)
    if recordings:
        draw_walk(recordings, folder.path / WALK_PICTURE)
        write_rrd(folder.path / WALK_RERUN, make_scenes(recordings))


def picture_search(folder: RunFolder) -> Path | None:
    """Draw a run's search, unless the picture is newer than the last generation.

    The result is the picture's path; None if the run has no finished generation.

    Raises:
      RunFolderError: the file with the search's history is damaged.
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

"""Writes several recordings: all of them or, after an error, none."""

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from groundwalk.errors import BadValueError
from worlds.recordings.files import write_recording
from worlds.recordings.recording import Recording


def write_recordings(recordings: Mapping[Path, Recording]) -> None:
    """Write recordings into files that must not exist yet.

    They are first written into a folder beside, whose name begins with a point, and
    then moved. After an error nothing of them is left, nor of the folders they need.

    Args:
      recordings: by path; each ends with .parquet or .csv, and all share one folder.

    Raises:
      BadValueError: a file exists already, or the json file beside a CSV does.
      OSError: the files cannot be written.

    Example:
      >>> write_recordings({Path("air/1.parquet"): one, Path("air/2.parquet"): other})
    """
    for path in recordings:
        for file in (path, *([path.with_suffix(".json")] if _is_csv(path) else [])):
            if file.exists():
                raise BadValueError(f"{file} exists already: choose another --out")
    (folder,) = {path.parent for path in recordings}
    made = _missing(folder)
    written: list[Path] = []
    partial: Path | None = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        partial = Path(tempfile.mkdtemp(prefix=".partial-", dir=folder))
        for path, recording in recordings.items():
            write_recording(recording, partial / path.name)
        for file in sorted(partial.iterdir()):
            # A link, unlike renaming, never replaces a file that came meanwhile.
            os.link(file, folder / file.name)
            written.append(folder / file.name)
    except BaseException:
        for file in written:
            file.unlink()
        _remove(partial)
        for one in made:
            if one.is_dir() and not any(one.iterdir()):
                one.rmdir()
        raise
    _remove(partial)


def _is_csv(path: Path) -> bool:
    return path.suffix.lower() == ".csv"


def _missing(folder: Path) -> list[Path]:
    """The folders that must be made for a folder to exist, the innermost first."""
    return [one for one in (folder, *folder.parents) if not one.exists()]


def _remove(partial: Path | None) -> None:
    if partial is not None:
        shutil.rmtree(partial, ignore_errors=True)

"""`groundwalk visualize`: show recordings and searches in Rerun."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from experiments.command_line import run_verb
from experiments.runs.folder import RunFolder, check_new
from experiments.seeing.run_pictures import OVERLAY, WALK_RERUN, picture_search
from experiments.seeing.scenes import (
    make_scenes,
    read_run,
    read_with_model,
    scene_names,
)
from experiments.seeing.visualize_search import visualize_search
from groundwalk.errors import BadRecordingError, BadValueError, RunFolderError
from worlds import Recording
from worlds.rerun_files.log import write_rrd
from worlds.rerun_files.viewer import open_viewer

_HEAD_BYTES = 4096
"""Number of bytes at the start of a .rrd file in which the word "groundwalk", which
marks files that groundwalk has written, is looked for."""


@dataclass(frozen=True)
class Visualize:
    """Show recordings in Rerun: robot, ground, balance, joints, forces, support.

    All recordings go into one .rrd file, side by side. For a run folder, these are all
    its recordings; its search is written to a separate file, search.rrd, and drawn as a
    picture. A diagnosis already has an overlay.rrd, whose name is printed.
    See docs/seeing.md.

    Attributes:
      paths: run folders, or recordings (.parquet or .csv).
      out: the .rrd file to write; by default walk.rrd in a run folder, the recording's
        name with .rrd beside it, or comparison.rrd beside the first of several.
      open: open the files in Rerun's viewer, which only this machine can reach.
      json: print the names of the files as JSON.
    """

    paths: Annotated[tuple[Path, ...], tyro.conf.Positional] = ()
    out: Path | None = None
    open: bool = False
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse paths that do not exist, and an output file that exists."""
        check_paths(self.paths)
        if self.out is not None:
            check_new(self.out, ".rrd")


def main(config: Visualize) -> None:
    """Write the Rerun files and the picture of the search, and print their names."""
    runs = [RunFolder.at(path) for path in config.paths if path.is_dir()]
    pictures = [*filter(None, map(picture_search, runs))]
    recordings = gather(config.paths)
    overlays = [run.path / OVERLAY for run in runs if run.has(OVERLAY)]
    if not recordings and (config.out or not (pictures or overlays)):
        raise RunFolderError(
            f"{config.paths[0]} holds no recordings: the run did not get there"
        )
    files = [*overlays, *filter(None, map(visualize_search, runs))]
    rerun = None
    if recordings:
        rerun = config.out or default_out(config.paths)
        write_rrd(rerun, make_scenes(recordings))
        files.insert(0, rerun)
    if config.json:
        written = {
            "rrd": rerun and str(rerun),
            "overlays": list(map(str, overlays)),
            "searches": [str(one) for one in files if one not in (rerun, *overlays)],
            "pictures": list(map(str, pictures)),
        }
        print(json.dumps(written, indent=1))
    else:
        print(*pictures, *files, sep="\n")
    if config.open:
        open_viewer(files)


def check_paths(paths: Sequence[Path]) -> None:
    """Refuse paths that do not exist (BadRecordingError), or none (BadValueError)."""
    if not paths:
        raise BadValueError("no run folder and no recording is given; name some")
    for path in paths:
        if not path.exists():
            raise BadRecordingError(f"{path}: there is no such run folder or recording")


def gather(paths: Sequence[Path]) -> dict[str, Recording]:
    """Read recordings of run folders and files, by the names that are shown.

    With several paths, the name of a run's recording begins with that of its folder.
    """
    recordings = {}
    stems = scene_names(path.resolve().with_suffix("").name for path in paths)
    for stem, path in zip(stems, paths, strict=True):
        if not path.is_dir():
            recordings[stem] = read_with_model(path)
            continue
        prefix = f"{stem}/" if len(paths) > 1 else ""
        of_run = read_run(path)
        recordings.update({prefix + name: one for name, one in of_run.items()})
    return recordings


def default_out(paths: Sequence[Path]) -> Path:
    """The .rrd file that is written without --out; refuses one of other programs."""
    first = paths[0]
    out = first / WALK_RERUN if first.is_dir() else first.with_suffix(".rrd")
    if len(paths) > 1:
        out = first.parent / "comparison.rrd"
    if out.exists() and not _is_ours(out):
        raise BadValueError(
            f"{out} exists and is no file of groundwalk: choose another --out"
        )
    return out


def _is_ours(path: Path) -> bool:
    """Whether a file is a Rerun file that groundwalk has written."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    return head.startswith(b"RRF") and b"groundwalk" in head


if __name__ == "__main__":
    run_verb(Visualize, main)

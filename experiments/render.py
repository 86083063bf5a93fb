"""`groundwalk render`: pictures and films of walks, without a display."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from experiments.command_line import run_verb
from experiments.runs.folder import check_new
from experiments.seeing.film import Film, film_bytes, strip_bytes
from experiments.seeing.scenes import make_scenes
from experiments.visualize import check_paths, gather
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.files import write_bytes

STRIP, FILMS = ".png", (".gif", ".mp4")
_BOUNDS = {
    "duration": (0.1, 60.0),
    "frames": (1, 50),
    "rate": (1.0, 50.0),
    "width": (64, 2000),
    "height": (64, 2000),
}


@dataclass(frozen=True)
class Render:
    """Draw walks: a film strip (.png), or a film (.gif, .mp4 with the program ffmpeg).

    No display and no graphics driver is needed. A film shows several recordings side by
    side, at the same times; a strip shows them below each other.

    Attributes:
      paths: run folders, or recordings (.parquet or .csv).
      out: the file to write; its ending decides between strip and film.
      only: show only recordings whose name, or file name, contains one of these words.
      start: time of the first picture [s]; by default chosen to show the fall or,
        without a fall, the middle of the walk.
      duration: length of the part that is shown [s].
      frames: number of pictures in a strip, at equal distances in time.
      rate: pictures per second of a film.
      width: width of each walk's picture in pixels.
      height: height of each walk's picture in pixels.
      balance: show forces at the feet, support polygon, ZMP and centre of mass.
    """

    paths: Annotated[tuple[Path, ...], tyro.conf.Positional] = ()
    out: Path = Path("walk.png")
    only: tuple[str, ...] = ()
    start: float | None = None
    duration: float = 3.0
    frames: int = 6
    rate: float = 12.5
    width: int = 320
    height: int = 320
    balance: bool = False

    def __post_init__(self) -> None:
        """Refuse values out of bounds, and an output file that exists."""
        check_paths(self.paths)
        if self.out.suffix not in (STRIP, *FILMS):
            raise BadValueError(f"{self.out} must end with .png, .gif or .mp4")
        check_new(self.out)
        if self.start is not None and not math.isfinite(self.start):
            raise BadValueError(f"start is {self.start}; it must be a time in seconds")
        for name, (least, most) in _BOUNDS.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise BadValueError(f"{name} is {value}; from {least:g} to {most:g}")


def main(config: Render) -> None:
    """Draw the pictures, and print the file's name."""
    words = [word.replace("_", "/") for word in config.only]  # sim_tuned: sim/tuned
    recordings = {
        name: recording
        for name, recording in gather(config.paths).items()
        if not words or any(word in name.replace("_", "/") for word in words)
    }
    if not recordings:
        raise RunFolderError(
            f"{config.paths[0]} holds no recordings"
            + (f" with {' or '.join(config.only)} in their name" if config.only else "")
        )
    size, part = (config.width, config.height), (config.start, config.duration)
    film = Film(make_scenes(recordings), size, *part, config.balance)
    if config.out.suffix == STRIP:
        content = strip_bytes(film, config.frames)
    else:
        content = film_bytes(film, config.rate, config.out.suffix)
    write_bytes(config.out, content)
    print(config.out)


if __name__ == "__main__":
    run_verb(Render, main)

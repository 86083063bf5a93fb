"""Repeats the worst falls of a terrain stress test, and writes their recordings."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from experiments.runs.extras import extra
from experiments.runs.folder import RECORDINGS, RunFolder
from experiments.runs.gait_files import short_name
from experiments.stress.curves import Cell, trials_of
from experiments.stress.families import Place
from experiments.stress.walks import Trial, Walk, walk_at
from walk_engine import Gait
from worlds import write_recording
from worlds.rerun_files.log import write_rrd


class _Config(Protocol):
    @property
    def worst(self) -> int: ...
    @property
    def seed(self) -> int: ...
    @property
    def threads(self) -> int: ...


def write_worst(
    folder: RunFolder,
    config: _Config,
    gaits: Mapping[str, Gait],
    cells: Sequence[Cell],
) -> list[dict[str, object]]:
    """Write recordings and Rerun files of each robot's, world's and gait's worst falls.

    The walks are simulated again: the same seeds give the same bits, so that the test
    need not keep the recordings of all trials.

    Args:
      folder: the run's folder; files that it already holds are not changed.
      config: number of falls, seed and threads.
      gaits: the gaits by name.
      cells: all cells (trials at one place) of the test.

    Returns:
      Place, trial and file name of each fall, as JSON values.
    """
    written: list[dict[str, object]] = []
    for robot, world in dict.fromkeys((c["robot"], c["world"]) for c in cells):
        own = [c for c in cells if (c["robot"], c["world"]) == (robot, world)]
        for gait in gaits:
            worst = worst_falls(own, gait, config.worst)
            name = f"worst_{short_name(robot)}_{world}_{gait}.rrd"
            if worst and not folder.has(name):
                walks = list(_again(worst, gaits, config.seed, config.threads))
                _write(folder, name, walks)
            written += [
                {"file": name, "place": place.label, **vars(trial)}
                for place, trial in worst
            ]
    return written


def worst_falls(
    cells: Sequence[Cell], gait: str, count: int
) -> list[tuple[Place, Trial]]:
    """Choose a gait's worst falls: on the mildest ground, after the shortest distance.

    Args:
      cells: cells (trials at one place) of one robot and world; those of a family of
        ground are in order from mild to hard.
      gait: name of the gait.
      count: largest number of falls; at most one is taken from each family.
    """
    found: list[tuple[int, float, Place, Trial]] = []
    for family in dict.fromkeys(cell["family"] for cell in cells):
        own = [cell for cell in cells if cell["family"] == family]
        falls = [
            (rung, trial.distance_m, _place(cell), trial)
            for rung, cell in enumerate(own)
            for trial in trials_of(cell, gait)
            if trial.fell
        ]
        if falls:
            found.append(min(falls, key=lambda fall: fall[:2]))
    found.sort(key=lambda fall: fall[:2])
    return [(place, trial) for _, _, place, trial in found[:count]]


def _place(cell: Cell) -> Place:
    return Place(cell["robot"], cell["world"], cell["family"], cell["severity"])


def _again(
    worst: Sequence[tuple[Place, Trial]],
    gaits: Mapping[str, Gait],
    seed: int,
    threads: int,
) -> Iterator[Walk]:
    for place, trial in worst:
        yield from walk_at(place, gaits, [(trial.gait, trial.number)], seed, threads)


def _write(folder: RunFolder, name: str, walks: Sequence[Walk]) -> None:
    for walk in walks:
        stem = walk.scene.name.replace("/", "_")
        path = folder.path / RECORDINGS / f"{stem}.parquet"
        write_recording(walk.scene.recording, path)
    with extra(name):
        write_rrd(folder.path / name, [walk.scene for walk in walks])

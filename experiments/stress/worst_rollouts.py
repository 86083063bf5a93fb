"""Repeats the worst falls of a terrain stress test, and writes their recordings."""

from collections.abc import Mapping, Sequence

from experiments.runs.extras import extra
from experiments.runs.folder import RECORDINGS, RunFolder
from experiments.runs.gait_files import short_name
from experiments.stress.curves import Cell, trials_of
from experiments.stress.families import Place
from experiments.stress.walks import Trial, walk_at
from walk_engine import Gait
from worlds import write_recording
from worlds.rerun_files.log import write_rrd
from worlds.scenes.scene import Scene


def write_worst(
    folder: RunFolder,
    gaits: Mapping[str, Gait],
    cells: Sequence[Cell],
    count: int,
    seed: int,
    threads: int,
) -> list[dict[str, object]]:
    """Write recordings and Rerun files of each robot's, world's and gait's worst falls.

    These are at most `count` each. The walks are simulated again: the same seed gives
    the same bits, so that the test need not keep the recordings of all trials. Files
    that the run's folder already holds are not changed. Seed and threads are those of
    the test; the result is place, trial and file name of each fall, as JSON values.
    """
    written: list[dict[str, object]] = []
    for robot, world in dict.fromkeys((c["robot"], c["world"]) for c in cells):
        own = [c for c in cells if (c["robot"], c["world"]) == (robot, world)]
        for gait in gaits:
            worst = worst_falls(own, gait, count)
            name = f"worst_{short_name(robot)}_{world}_{gait}.rrd"
            if worst and not folder.has(name):
                scenes = [
                    scene
                    for place, trial in worst
                    for _, scene in walk_at(
                        place, gaits, [(trial.gait, trial.number)], seed, threads
                    )
                ]
                _write(folder, name, scenes)
            written += [
                {"file": name, "place": place.label, **vars(trial)}
                for place, trial in worst
            ]
    return written


def worst_falls(
    cells: Sequence[Cell], gait: str, count: int
) -> list[tuple[Place, Trial]]:
    """Choose a gait's worst falls: on the mildest ground, after the shortest distance.

    The cells (trials at one place) are of one robot and world, those of a family of
    ground in order from mild to hard. At most one fall is taken from each family.
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


def _write(folder: RunFolder, name: str, scenes: Sequence[Scene]) -> None:
    for scene in scenes:
        path = folder.path / RECORDINGS / f"{scene.name.replace('/', '_')}.parquet"
        write_recording(scene.recording, path)
    with extra(name):
        write_rrd(folder.path / name, scenes)

"""`groundwalk terrain-stress`: find the roughest ground on which gaits still walk."""

import dataclasses
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import tyro

import robots
import worlds
from experiments.command_line import run_verb
from experiments.reports.tables import print_result
from experiments.runs.extras import extra
from experiments.runs.folder import HISTORY, RECORDINGS, RESULT, RunFolder, open_run
from experiments.runs.gait_files import load_gaits, short_name
from experiments.runs.options import RunOptions, check_at_least
from experiments.runs.progress import progress
from experiments.stress.curves import Cell, curves_of, trials_of
from experiments.stress.families import FAMILIES, FLAT, Place, leg_length_m
from experiments.stress.figure import draw_stress
from experiments.stress.page import HALF_HEADINGS, half_rows, write_stress_page
from experiments.stress.walks import Trial, walk_at
from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import Gait
from worlds import write_recording
from worlds.rerun_files.log import write_rrd
from worlds.scenes.scene import Scene

VERB = "terrain-stress"


@dataclass(frozen=True)
class TerrainStress(RunOptions):
    """Let gaits walk on harder and harder ground: speed, falls and their causes.

    The result is, for each family of ground, the severity at which half of the trials
    fall. A run that was stopped is continued with --resume.

    Attributes:
      gaits: names (`groundwalk list gaits`), .json files with a gait, or run folders of
        optimize-gait.
      worlds: the worlds to walk in: sim, real or both.
      robots: names (`groundwalk list robots`), or .urdf or .toml files.
      families: kinds of difficult ground, friction and softness among them. Flat ground
        is always tried.
      rungs: number of severities of a family, from mild to hard, each the same factor
        from the one before.
      trials: number of trials of each gait at each severity, each on its own ground.
      worst: number of falls, of each gait and world, that are kept as Rerun files.
      threads: processor threads; 0 for all.
    """

    gaits: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    worlds: tuple[str, ...] = ("sim", "real")
    robots: tuple[str, ...] = ("nao",)
    families: tuple[str, ...] = tuple(FAMILIES)
    rungs: int = 5
    trials: int = 8
    worst: int = 3
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        if not (self.gaits or self.resume):
            raise BadValueError("no gait is given; name one, such as start")
        for name in ("worlds", "robots", "families"):
            given = getattr(self, name)
            if not given or len(set(given)) < len(given):
                raise BadValueError(f"{name} are {given}; each one once, at least one")
        load_gaits(self.gaits)
        for world in self.worlds:
            worlds.kind(world)
        for robot in self.robots:
            leg_length_m(robots.get(robot))
        for family in self.families:
            if family not in FAMILIES:
                raise UnknownNameError("family of ground", family, FAMILIES)
        check_at_least(self, trials=1, rungs=2, worst=0, threads=0)
        super().__post_init__()

    @property
    def places(self) -> list[Place]:
        """All combinations of robot, world, family of ground and severity, in order."""
        found = []
        for robot, world in itertools.product(self.robots, self.worlds):
            leg_m = leg_length_m(robots.get(robot))
            found.append(Place(robot, world, FLAT, 0.0))
            for name in self.families:
                ladder = FAMILIES[name].severities(self.rungs, leg_m).tolist()
                found += [Place(robot, world, name, severity) for severity in ladder]
        return found


def main(config: TerrainStress) -> None:
    """Run all trials; a resumed run skips those that it has done."""
    folder, config = open_run(VERB, config)
    gaits = load_gaits(config.gaits)
    cells = _walk_cells(folder, config, gaits)
    curves = curves_of(cells)
    worst = write_worst(folder, gaits, cells, config.worst, config.seed, config.threads)
    result = {"curves": curves, "worst": worst}
    folder.write_json(RESULT, result)
    with extra("the pictures"):
        draw_stress(curves, folder.path)
    write_stress_page(folder, curves)
    rows = half_rows(curves)
    print_result(config.json, result, HALF_HEADINGS, rows, folder.path)


def _walk_cells(
    folder: RunFolder, config: TerrainStress, gaits: Mapping[str, Gait]
) -> list[dict[str, Any]]:
    """Compute all cells that the run folder does not hold yet.

    A cell is the trials of all gaits for one robot, world, family of ground and
    severity. It depends on the seed alone: a resumed run has the same result.
    """
    state = _state(folder, gaits)
    cells: list[dict[str, Any]] = state["cells"]
    rows = [(gait, number) for number in range(config.trials) for gait in gaits]
    places = config.places
    with progress("trials", len(places) * len(rows), len(cells) * len(rows)) as bar:
        for place in places[len(cells) :]:
            own = config.seed, config.threads
            walks = walk_at(place, gaits, rows, *own, bar.advance)
            trials = [dataclasses.asdict(trial) for trial, _ in walks]
            cells.append({**dataclasses.asdict(place), "trials": trials})
            folder.write_json(HISTORY, state)
    return cells


def _state(folder: RunFolder, gaits: Mapping[str, Gait]) -> dict[str, Any]:
    """The stored state of a run; BadValueError if a gait has changed since it began."""
    now = {name: dict(gait) for name, gait in gaits.items()}
    state = folder.read_json(HISTORY) if folder.has(HISTORY) else {"gaits": now}
    if state["gaits"] != now:
        raise BadValueError(
            f"a gait of {folder.path} has changed since the run began; begin another"
        )
    return {"cells": [], **state}


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


if __name__ == "__main__":
    run_verb(TerrainStress, main)

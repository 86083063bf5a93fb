"""`groundwalk terrain-stress`: find the roughest ground on which gaits still walk."""

import dataclasses
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import tyro

import robots
import worlds
from experiments.command_line import run_verb
from experiments.reports.tables import print_result
from experiments.runs.extras import extra
from experiments.runs.folder import HISTORY, RESULT, RunFolder, open_run
from experiments.runs.gait_files import load_gaits
from experiments.runs.options import RunOptions, check_at_least
from experiments.runs.progress import progress
from experiments.stress.curves import curves_of
from experiments.stress.families import FAMILIES, FLAT, Place, leg_length_m
from experiments.stress.figure import draw_stress
from experiments.stress.page import HALF_HEADINGS, half_rows, write_stress_page
from experiments.stress.walks import walk_at
from experiments.stress.worst_rollouts import write_worst
from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import Gait

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


if __name__ == "__main__":
    run_verb(TerrainStress, main)

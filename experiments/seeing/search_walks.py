"""Repeats the walks of a search's best gaits, so that they can be shown."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import robots
from experiments.runs.progress import progress
from experiments.walking.gait_search import SearchPlan, rate
from experiments.walking.recorder import Recorder
from terrain import Heightfield, TerrainSpec
from walk_engine import Gait
from worlds import End, RecordingMetadata
from worlds.rerun_files.search_history import SearchWalk
from worlds.scenes.scene import Scene

_NEEDED = ("robot", "terrain", "sim", "seed", "threads")


def search_plan(stored: Mapping[str, Any]) -> SearchPlan:
    """Make the options of a search from the content of its run's `config.json`.

    Raises:
      GroundwalkError: a robot or gait file does not exist, or a value is invalid.
    """
    given = {name: stored[name] for name in _NEEDED if name in stored}
    if given.get("sim") is not None:
        given["sim"] = Path(given["sim"])
    return SearchPlan(**given)


def walk_again(plan: SearchPlan, best: Sequence[Gait]) -> list[SearchWalk]:
    """Repeat the walk with which the best gait of each generation was rated.

    The robots walk side by side in one sim, each on its generation's ground.

    Args:
      plan: options of the search.
      best: the best gait of each generation, from the first one on.
    """
    description = robots.get(plan.robot)
    specs = plan.grounds(len(best))
    grounds = _shared([spec.make() for spec in specs])
    recorder = Recorder(description, range(len(best)))
    with progress("best gaits walk", len(best)) as bar:
        trials, rewards = rate(
            plan, best, grounds, recorder=recorder, on_end=bar.advance
        )
    walks = []
    for k, gait in enumerate(best):
        about = _metadata(plan, specs[k], gait, f"generation {k}", trials.ended[k])
        recording = recorder.recording(k, about)
        scene = Scene(f"generation-{k}", recording, description, grounds[k])
        distance_m, time_s = float(trials.distance_m[k]), float(trials.time_s[k])
        walks.append(SearchWalk(scene, distance_m, time_s, float(rewards[k])))
    return walks


def _metadata(
    plan: SearchPlan, ground: TerrainSpec, gait: Gait, of: str, end: End
) -> RecordingMetadata:
    return RecordingMetadata(
        robot=plan.robot,
        base="floating",
        source=f"groundwalk, the best gait of {of} of a search",
        terrain=ground.to_json(),
        gait=dict(gait),
        world="sim",
        end=str(end),
    )


def _shared(grounds: Sequence[Heightfield]) -> list[Heightfield]:
    """Replace grounds that are all equal by one object: the sim loads it only once."""
    first = grounds[0]
    if all(np.array_equal(first.heights_m, one.heights_m) for one in grounds):
        return [first] * len(grounds)
    return list(grounds)

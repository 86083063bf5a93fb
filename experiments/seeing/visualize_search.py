"""Writes a Rerun file of a run's search, with a walk of each generation's best gait."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import robots
from experiments.runs.folder import CONFIG, HISTORY, RunFolder
from experiments.runs.progress import progress
from experiments.walking.gait_search import SEARCH_VERB, SearchPlan, rate
from experiments.walking.recorder import Recorder
from groundwalk.arrays import FloatArray
from groundwalk.errors import GroundwalkError, RunFolderError
from terrain import Heightfield
from walk_engine import Gait
from walk_engine.gait import PARAMETERS
from worlds import RecordingMetadata
from worlds.rerun_files.search_history import SearchHistory, SearchWalk
from worlds.scenes.scene import Scene

_NEEDED = ("robot", "terrain", "sim", "seed", "threads")


def search_plan(stored: Mapping[str, Any]) -> SearchPlan:
    """Make the options of a search from the content of its run's `config.json`."""
    given = {name: stored[name] for name in _NEEDED if name in stored}
    if given.get("sim") is not None:
        given["sim"] = Path(given["sim"])
    return SearchPlan(**given)


def walk_again(plan: SearchPlan, best: Sequence[Gait]) -> list[SearchWalk]:
    """Repeat the walk with which the best gait of each generation was rated.

    The robots walk side by side in one sim, each on its generation's ground.
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
        about = RecordingMetadata(
            robot=plan.robot,
            base="floating",
            source=f"groundwalk, the best gait of generation {k} of a search",
            terrain=specs[k].to_json(),
            gait=dict(gait),
            world="sim",
            end=str(trials.ended[k]),
        )
        recording = recorder.recording(k, about)
        scene = Scene(f"generation-{k}", recording, description, grounds[k])
        distance_m, time_s = float(trials.distance_m[k]), float(trials.time_s[k])
        walks.append(SearchWalk(scene, distance_m, time_s, float(rewards[k])))
    return walks


def _shared(grounds: Sequence[Heightfield]) -> list[Heightfield]:
    """Replace grounds that are all equal by one object: the sim loads it only once."""
    first = grounds[0]
    if all(np.array_equal(first.heights_m, one.heights_m) for one in grounds):
        return [first] * len(grounds)
    return list(grounds)


SEARCH_RERUN = "search.rrd"

Entries = Sequence[Mapping[str, Any]]


def visualize_search(folder: RunFolder) -> Path | None:
    """Write a Rerun file of a run's search, if it has one; its best gaits walk again.

    Runs of earlier versions of groundwalk did not store the best gaits. If these cannot
    walk again, the file's text on each generation says why.
    """
    if not folder.has(HISTORY):
        return None
    path = folder.path / HISTORY
    entries = folder.read_json(HISTORY).get("generations")
    if not entries:
        raise RunFolderError(f"{path} holds no generations")
    try:
        history = read_history(entries)
    except (KeyError, TypeError, ValueError) as error:
        raise RunFolderError(f"{path} is damaged: {error!r}") from None
    from worlds.rerun_files.search import write_search  # it takes a second to load

    identity = hashlib.sha256(json.dumps(entries).encode()).hexdigest()[:32]
    rerun = folder.path / SEARCH_RERUN
    write_search(rerun, _with_walks(folder, history, entries), identity)
    return rerun


def _with_walks(
    folder: RunFolder, history: SearchHistory, entries: Entries
) -> SearchHistory:
    """Add a walk of each generation's best gait, or the reason why there is none."""
    if not all(entry.get("best_gait") for entry in entries):
        return history
    try:
        stored = folder.read_json(CONFIG)
        if stored.get("verb") != SEARCH_VERB:
            raise RunFolderError(
                f"{CONFIG} is of {stored.get('verb')!r}, not {SEARCH_VERB!r}"
            )
        best = [Gait.from_mapping(entry["best_gait"]) for entry in entries]
        return history._replace(walks=walk_again(search_plan(stored), best))
    except GroundwalkError as error:
        return history._replace(no_walks=str(error))


def read_history(entries: Entries) -> SearchHistory:
    """Turn the records of a search's generations into columns over the generations.

    Records of earlier versions have no `best_gait`; gait parameters that no record has
    are left out.
    """
    mean = _columns(entries, "mean_gait")
    ranges = np.array([parameter.high - parameter.low for parameter in PARAMETERS])
    spread = {}
    if all(len(entry["spread"]) == len(PARAMETERS) for entry in entries):
        values = np.array([entry["spread"] for entry in entries]) * ranges
        columns = zip(PARAMETERS, values.T, strict=True)
        spread = {parameter.name: column for parameter, column in columns}
    return SearchHistory(
        rewards=[np.array(entry["rewards"], float) for entry in entries],
        falls=np.array([entry["falls"] for entry in entries], float),
        mean_reward=np.array([entry["mean_reward"] for entry in entries], float),
        mean=mean,
        spread={name: spread[name] for name in mean if name in spread},
        best=_columns(entries, "best_gait"),
        units={"reward": "cm/s"} | {one.name: one.unit for one in PARAMETERS},
    )


def _columns(entries: Entries, key: str) -> dict[str, FloatArray]:
    """By parameter: (generations,) values in the gait stored under `key`, or NaN."""
    gaits = [entry.get(key, {}) for entry in entries]
    return {
        parameter.name: np.array([gait.get(parameter.name, np.nan) for gait in gaits])
        for parameter in PARAMETERS
        if any(parameter.name in gait for gait in gaits)
    }

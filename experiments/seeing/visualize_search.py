"""Writes a Rerun file of a run's search, with a walk of each generation's best gait."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.folder import CONFIG, HISTORY, RunFolder
from experiments.seeing.search_walks import search_plan, walk_again
from experiments.walking.gait_search import SEARCH_VERB
from groundwalk.arrays import FloatArray
from groundwalk.errors import GroundwalkError, RunFolderError
from walk_engine import Gait
from walk_engine.gait import PARAMETERS
from worlds.rerun_files.search_history import SearchHistory

SEARCH_RERUN = "search.rrd"

Entries = Sequence[Mapping[str, Any]]


def visualize_search(folder: RunFolder) -> Path | None:
    """Write a Rerun file of a run's search; its best gaits walk again for this.

    Runs of earlier versions of groundwalk did not store the best gaits. If these cannot
    walk again, the file's text on each generation says why.

    Returns:
      The path of the file; None if the run has no finished generation.

    Raises:
      RunFolderError: the file with the search's history is damaged.
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

    Raises:
      KeyError: a record lacks a value that every version stores.
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
    """Each parameter (generations,) of the entries' gait `key`; NaN where missing."""
    gaits = [entry.get(key, {}) for entry in entries]
    return {
        parameter.name: np.array([gait.get(parameter.name, np.nan) for gait in gaits])
        for parameter in PARAMETERS
        if any(parameter.name in gait for gait in gaits)
    }

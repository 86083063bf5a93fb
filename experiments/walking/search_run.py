"""A gait search from its first to its last generation, with checkpoints."""

import pickle
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.progress import progress
from experiments.walking.search import GaitSearch
from groundwalk.arrays import FloatArray
from groundwalk.errors import RunFolderError
from groundwalk.files import write_bytes
from walk_engine import Gait

Entry = dict[str, Any]
"""What one generation came to; `mean_reward` [cm/s] among it."""

MEAN = "mean_gait"

RATINGS = 10
"""How often every generation's mean gait is rated after the search."""


def run_search(
    checkpoint: Path,
    begin: Callable[[], GaitSearch],
    generation: Callable[[int, GaitSearch], Entry],
    generations: int,
    note: Callable[[list[Entry]], object] = lambda entries: None,
) -> FloatArray:
    """The mean gaits of a search, from the one it begins at to the last.

    The generations of a checkpoint are not run again.

    Args:
      checkpoint: a file that is written after every generation.
      begin: makes the search if there is no checkpoint.
      generation: asks, rates and tells; given the generation's number.
      generations: how many there shall be in all.
      note: is given all entries after every generation; each has the `mean_gait`
        that it began with.

    Returns:
      (generations + 1, 16) vectors.

    Raises:
      RunFolderError: the checkpoint is damaged, or too old.
    """
    search, entries = _read(checkpoint) if checkpoint.exists() else (begin(), [])
    with progress("search", generations, done=len(entries)) as bar:
        for number in range(len(entries), generations):
            mean = dict(search.mean)
            entry = generation(number, search)
            entries.append({"generation": number, MEAN: mean, **entry})
            state = {"search": search.to_bytes(), "history": entries}
            write_bytes(checkpoint, pickle.dumps(state))
            note(entries)
            bar.advance(f"mean gait {entries[-1]['mean_reward']:.1f} cm/s")
    means = [Gait.from_mapping(entry[MEAN]) for entry in entries]
    return np.array([mean.to_vector() for mean in (*means, search.mean)])


def best_mean(means: FloatArray, ratings: Sequence[FloatArray]) -> Gait:
    """The mean gait with the best rewards.

    The mean moves where the good samples are, and from one generation to the next that
    may be over a cliff, as fast gaits have neighbours that fall at once. So the last
    one is not the answer: all are rated again, with other random numbers.

    Args:
      means: (n, 16) vectors, as `run_search` returns them.
      ratings: (n,) rewards [cm/s] for each time that they were rated.
    """
    return Gait.from_vector(means[np.mean(ratings, axis=0).argmax()])


def _read(checkpoint: Path) -> tuple[GaitSearch, list[Entry]]:
    try:
        state = pickle.loads(checkpoint.read_bytes())
    except (pickle.UnpicklingError, EOFError, ValueError) as error:
        raise RunFolderError(f"{checkpoint} is damaged: {error}") from None
    search, entries = GaitSearch.from_bytes(state["search"]), state["history"]
    if not all(MEAN in entry for entry in entries):
        raise RunFolderError(
            f"{checkpoint} is of an earlier version, which did not keep the mean "
            "gaits; begin again in another folder"
        )
    return search, entries

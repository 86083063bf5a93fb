"""A gait search from its first to its last generation, with checkpoints."""

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

from experiments.progress import progress
from experiments.search import GaitSearch
from groundwalk.errors import RunFolderError
from groundwalk.files import write_bytes

Entry = dict[str, Any]
"""What one generation came to; `mean_reward` [cm/s] among it."""


def run_search(
    checkpoint: Path,
    begin: Callable[[], GaitSearch],
    generation: Callable[[int, GaitSearch], Entry],
    generations: int,
    note: Callable[[list[Entry]], object] = lambda entries: None,
) -> tuple[GaitSearch, list[Entry]]:
    """The search after all its generations, and what each came to.

    The generations of a checkpoint are not run again.

    Args:
      checkpoint: a file that is written after every generation.
      begin: makes the search if there is no checkpoint.
      generation: asks, rates and tells; given the generation's number.
      generations: how many there shall be in all.
      note: is given all entries after every generation.

    Raises:
      RunFolderError: the checkpoint is damaged.
    """
    search, entries = _read(checkpoint) if checkpoint.exists() else (begin(), [])
    with progress("search", generations, done=len(entries)) as bar:
        for number in range(len(entries), generations):
            entries.append({"generation": number, **generation(number, search)})
            state = {"search": search.to_bytes(), "history": entries}
            write_bytes(checkpoint, pickle.dumps(state))
            note(entries)
            bar.advance(f"mean gait {entries[-1]['mean_reward']:.1f} cm/s")
    return search, entries


def _read(checkpoint: Path) -> tuple[GaitSearch, list[Entry]]:
    try:
        state = pickle.loads(checkpoint.read_bytes())
    except (pickle.UnpicklingError, EOFError, ValueError) as error:
        raise RunFolderError(f"{checkpoint} is damaged: {error}") from None
    return GaitSearch.from_bytes(state["search"]), state["history"]

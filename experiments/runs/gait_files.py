"""Loads gaits that users give by name, as a JSON file, or as a run folder."""

from collections.abc import Sequence
from pathlib import Path

from experiments.runs.folder import FILE_ENDS, RESULT
from groundwalk.errors import BadValueError
from walk_engine import Gait, gaits


def load_gait(name: str) -> Gait:
    """Load a gait by its name, from a JSON file, or from the run folder of a search.

    Raises:
      GroundwalkError: there is no such gait, file or folder, or it holds no gait.
    """
    path = Path(name)
    if name not in gaits.names() and path.is_dir():
        path /= RESULT
    return Gait.load(path) if path.suffix == ".json" else gaits.get(name)


def load_gaits(names: Sequence[str]) -> dict[str, Gait]:
    """Load gaits by names, from JSON files or from run folders, by their short names.

    Raises:
      BadValueError: two gaits have the same short name.
    """
    loaded: dict[str, Gait] = {}
    for name in names:
        short = short_name(name)
        if short in loaded:
            raise BadValueError(
                f"two gaits are called {short!r}; rename one of their files"
            )
        loaded[short] = load_gait(name)
    return loaded


def short_name(name: str) -> str:
    """Shorten the name of a gait or robot, which may be a file, for tables and files.

    The result is a file's name without its ending; of a run folder, or of the
    `result.json` in it, the folder's name.

    Example:
      >>> short_name("gaits/fast.json"), short_name("runs/mine/result.json")
      ('fast', 'mine')
    """
    path = Path(name)
    if path.name == RESULT:
        return path.resolve().parent.name
    return path.stem if path.suffix in FILE_ENDS else path.name

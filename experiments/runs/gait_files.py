"""Gaits as users name them: by name, as a JSON file, or as a run folder."""

from collections.abc import Sequence
from pathlib import Path

from experiments.runs.folder import RESULT
from groundwalk.errors import BadValueError
from walk_engine import Gait, gaits


def load_gait(name: str) -> Gait:
    """Load a gait.

    Args:
      name: name of a gait (`groundwalk list gaits`), a JSON file with one, or the run
        folder of a search.

    Raises:
      GroundwalkError: there is no such gait, file or folder, or it holds no gait.
    """
    path = Path(name)
    if name not in gaits.names() and path.is_dir():
        path /= RESULT
    return Gait.load(path) if path.suffix == ".json" else gaits.get(name)


def load_gaits(names: Sequence[str]) -> dict[str, Gait]:
    """Load gaits and give them short names.

    The short name of a file is its own without the ending. That of a run folder, or of
    a `result.json` in it, is the folder's name.

    Args:
      names: gaits as `load_gait` takes them.

    Raises:
      BadValueError: two gaits have the same short name.
    """
    loaded: dict[str, Gait] = {}
    for name in names:
        path = Path(name)
        short = path.resolve().parent.name if path.name == RESULT else path.stem
        if path.is_dir():
            short = path.resolve().name
        if short in loaded:
            raise BadValueError(
                f"two gaits are called {short!r}; rename one of their files"
            )
        loaded[short] = load_gait(name)
    return loaded

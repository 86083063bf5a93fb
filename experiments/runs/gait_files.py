"""Gaits as users name them: by name, or as a JSON file that holds one."""

from collections.abc import Sequence
from pathlib import Path

from experiments.runs.folder import RESULT
from groundwalk.errors import BadValueError
from walk_engine import Gait, gaits


def load_gait(name: str) -> Gait:
    """A gait by its name, or from a JSON file such as a run's `result.json`.

    Raises:
      GroundwalkError: there is no such gait or file, or it holds no gait.
    """
    return Gait.load(Path(name)) if name.endswith(".json") else gaits.get(name)


def load_gaits(names: Sequence[str]) -> dict[str, Gait]:
    """Gaits under short names: a file's own, or its folder's for a `result.json`.

    Raises:
      BadValueError: two of them would have the same short name.
    """
    loaded: dict[str, Gait] = {}
    for name in names:
        path = Path(name)
        short = path.resolve().parent.name if path.name == RESULT else path.stem
        if short in loaded:
            raise BadValueError(
                f"two gaits are called {short!r}; rename one of their files"
            )
        loaded[short] = load_gait(name)
    return loaded

"""PyBullet without what it says: it greets and warns from C."""

import contextlib
import os
from collections.abc import Iterator
from typing import Any


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """Drop what C code writes to standard output and standard error."""
    kept = [os.dup(1), os.dup(2)]
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        for stream, copy in enumerate(kept, start=1):
            os.dup2(copy, stream)
            os.close(copy)


def import_bullet() -> Any:
    """PyBullet, without its greeting."""
    with silent():
        import pybullet
    return pybullet

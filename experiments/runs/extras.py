"""Results outlive their pictures: what a failed extra costs is one line."""

import contextlib
import sys
from collections.abc import Iterator


@contextlib.contextmanager
def extra(name: str) -> Iterator[None]:
    """Make a picture, an overlay or a page; if that fails, say so and go on.

    A run has its answer before it draws anything, and hours may be in it. So an error
    of any kind within the block becomes one line on stderr, and what comes after the
    block is still written. An interruption by the user passes through.

    Args:
      name: of the file or files that are made, as the line names them.

    Example:
      >>> with extra("walk.png"):
      ...     draw_walk(recordings, path)
    """
    try:
        yield
    except Exception as error:  # whatever a drawing library may raise
        reason = " ".join(str(error).split()) or type(error).__name__
        print(f"groundwalk: {name} is not written: {reason}", file=sys.stderr)

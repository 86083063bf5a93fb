"""A context in which errors are only printed: for pictures and pages of a run."""

import contextlib
import sys
from collections.abc import Iterator


@contextlib.contextmanager
def extra(name: str) -> Iterator[None]:
    """Make a picture, an overlay or a page; if that fails, print one line and go on.

    A run already has its result, perhaps of hours, when it draws. An exception within
    the block is therefore printed as one line on standard error, with the name of the
    file; the program continues after the block. Ctrl-C is not caught.

    Example:
      >>> with extra("walk.png"):
      ...     draw_walk(recordings, path)
    """
    try:
        yield
    except Exception as error:  # whatever a drawing library may raise
        reason = " ".join(str(error).split()) or type(error).__name__
        print(f"groundwalk: {name} is not written: {reason}", file=sys.stderr)

"""Writing files so that a reader never sees half of one."""

import os
from pathlib import Path


def write_bytes(path: Path, content: bytes) -> None:
    """Write content to path at once: to a file beside it, then renamed.

    Args:
      path: the file; its folder is made if it is not there.
      content: everything that the file shall hold.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.partial")
    with partial.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def write_text(path: Path, content: str) -> None:
    """Write UTF-8 text to path at once; see `write_bytes`."""
    write_bytes(path, content.encode())

"""Writes files atomically, so that a reader never sees half of one."""

import os
from pathlib import Path


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file atomically: to a temporary file beside it, which is then renamed.

    The file's folder is made if it does not exist.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.partial")
    with partial.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def write_text(path: Path, content: str) -> None:
    """Write a UTF-8 text file atomically; its folder is made if it does not exist."""
    write_bytes(path, content.encode())

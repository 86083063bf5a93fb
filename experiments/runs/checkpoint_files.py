"""Intermediate results of a run, as files from which it can go on."""

import io
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.search.hooks import Saved
from groundwalk.files import write_bytes

PLAIN = "plain"
"""Name of the array, in an npz file, that holds the JSON part of a result as bytes."""


class CheckpointFiles:
    """A folder of intermediate results, one npz file for each; pickle is never used."""

    def __init__(self, folder: Path) -> None:
        """Use a folder that holds nothing else; the first `save` makes it."""
        self._folder = folder

    def load(self, key: str) -> Saved | None:
        """The result that was saved under a key; None if there is none."""
        path = self._folder / f"{key}.npz"
        if not path.is_file():
            return None
        with np.load(path, allow_pickle=False) as stored:
            arrays = dict(stored)
        return Saved(json.loads(arrays.pop(PLAIN).tobytes()), arrays)

    def save(self, key: str, saved: Saved) -> None:
        """Write a result under a key; after an error no partial file remains."""
        text = np.frombuffer(json.dumps(saved.plain).encode(), np.uint8)
        arrays: dict[str, Any] = {PLAIN: text, **saved.arrays}
        content = io.BytesIO()
        np.savez(content, **arrays)
        write_bytes(self._folder / f"{key}.npz", content.getvalue())

    def exists(self) -> bool:
        """Whether the folder exists, that is, whether a run was interrupted."""
        return self._folder.exists()

    def delete(self) -> None:
        """Delete the folder, which a complete run does not need."""
        shutil.rmtree(self._folder, ignore_errors=True)

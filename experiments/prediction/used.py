"""Tells recordings that a diagnosis has used from new ones, by what is in them."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from diagnosis.traces.read import recording_files
from experiments.reports.origin import shown
from groundwalk.errors import BadRecordingError
from worlds import Recording, read_recording


class Sorted(NamedTuple):
    """Recordings by whether a diagnosis has used them.

    Attributes:
      new: files that it has not seen.
      used: files that it has.
      limits: a sentence for each of its recordings that is no longer there.
    """

    new: tuple[Path, ...]
    used: tuple[Path, ...]
    limits: tuple[str, ...]


def content_of(recording: Recording) -> str:
    """The SHA-256 of all columns of a recording: the same for the same values.

    Neither the file's name nor its format counts, nor do metadata.
    """
    digest = hashlib.sha256()
    for name in sorted(recording.columns):
        values = recording.columns[name] + 0.0  # -0.0 is 0.0
        values[np.isnan(values)] = np.nan  # NaN has many bit patterns
        digest.update(f"{name}\0{len(values)}\0".encode())
        digest.update(values.astype("<f8").tobytes())
    return digest.hexdigest()


def sort_out(paths: Sequence[Path], seen: Sequence[Path]) -> Sorted:
    """Divide recordings (files, or folders of them) into new and used ones.

    Args:
      paths: the recordings that are given.
      seen: those that the diagnosis has used.

    Raises:
      BadRecordingError: one cannot be read, two of `paths` are the same recording, or
        all of them were used.
    """
    known, limits = set[str](), list[str]()
    for path in seen:
        if not path.exists():
            limits.append(
                f"{shown(str(path))}, which the diagnosis used, is no longer there: "
                "whether it is one of these recordings cannot be told."
            )
            continue
        known |= {content_of(read_recording(one)) for one in recording_files([path])}
    new, used, first = list[Path](), list[Path](), dict[str, Path]()
    for path in recording_files(paths):
        content = content_of(read_recording(path))
        if content in first:
            raise BadRecordingError(f"{first[content]} and {path} hold the same rows")
        first[content] = path
        (used if content in known else new).append(path)
    if not new:
        raise BadRecordingError(
            "all of these recordings were used by the diagnosis: give one that it has "
            "not seen"
        )
    return Sorted(tuple(new), tuple(used), tuple(limits))

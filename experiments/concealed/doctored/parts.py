"""Reads real recordings and draws the parts that a case and its reference have."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from experiments.concealed.doctored.robots import RealSet
from groundwalk.errors import BadRecordingError
from worlds.recordings import Recording, read_recording
from worlds.recordings.recording import TIME

STRETCH_S = (20.0, 30.0)
"""Range of a drawn stretch [s] of a recording that is longer than its upper end."""
MOVES = 0.1
"""Reach [rad; m] from which on a joint counts as moving in a recording."""
_MANY = 7
"""With this many recordings or more, a case has three or four of them and a reference
two or three; with fewer, a case has half."""


@dataclass(frozen=True, eq=False)
class Parts:
    """Recordings of a case and of its reference, by name, all different.

    Attributes:
      recordings: those of the case.
      reference: those of the healthy robot.
      wrong_reference: the latter with the label wrong that is wrong in the case, to see
        how large that is beside what differs between recordings; None if no label is.

    Example:
      >>> drawn_parts(data, REAL_SETS["so101"], "nominal.urdf", rng).moving()
    """

    recordings: Mapping[str, Recording]
    reference: Mapping[str, Recording]
    wrong_reference: Mapping[str, Recording] | None = None

    @property
    def reference_as_well(self) -> Mapping[str, Recording]:
        """The reference with the same label wrong, if any is."""
        return self.wrong_reference or self.reference

    def moving(self) -> tuple[str, ...]:
        """Joints that move in the reference, and in two of the case's recordings."""
        twice = min(2, len(self.recordings))
        joints = next(iter(self.recordings.values())).joints
        return tuple(
            joint
            for joint in joints
            if _times(joint, self.recordings.values()) >= twice
            and _times(joint, self.reference.values())
        )


def drawn_parts(
    data: Path, real: RealSet, robot: str, rng: np.random.Generator
) -> Parts:
    """Draw the recordings of a case and of its reference from those of a robot.

    `robot` is the name of the model file for their metadata.
    """
    every = _recordings(data, real, robot)
    if real.pieces > 1:
        pieces = [
            (f"{stem}_{k}", _piece(one, k, real.pieces))
            for stem, one in every.items()
            for k in range(real.pieces)
        ]
        # of each two neighbours one is the reference, so that both know all speeds
        case, reference = list[int](), list[int]()
        for first in range(0, len(pieces), 2):
            swap = int(rng.integers(2))
            case.append(first + swap)
            reference.append(first + 1 - swap)
    else:
        pieces = [(stem, _stretch(one, rng)) for stem, one in every.items()]
        order = rng.permutation(len(pieces)).tolist()
        many = len(pieces) >= _MANY
        size = int(rng.integers(3, 5)) if many else len(pieces) // 2
        others = int(rng.integers(2, 4)) if many else len(pieces) - size
        case, reference = order[:size], order[size : size + others]
    return Parts(_named(pieces, case), _named(pieces, reference))


def rows(recording: Recording, start: int, stop: int) -> Recording:
    """The rows of a recording from `start` to before `stop`; its time begins at 0."""
    columns = {name: values[start:stop] for name, values in recording.columns.items()}
    columns[TIME] = columns[TIME] - columns[TIME][0]
    return replace(recording, columns=columns)


def _recordings(data: Path, real: RealSet, robot: str) -> dict[str, Recording]:
    """All recordings of a robot, with the servos' gains, by name without ending."""
    paths = sorted((data / real.folder).glob(real.files))
    if len(paths) * real.pieces < 2:
        raise BadRecordingError(
            f"{data / real.folder}: a case needs two recordings at least"
        )
    found = {}
    for path in paths:
        read = read_recording(path)
        columns = {
            name: values
            for name, values in read.columns.items()
            if name.split(".")[0] not in real.unused
        }
        given = dict.fromkeys(read.joints, real.gains) if real.gains else {}
        servo = {**{k: v for k, v in given.items() if v}, **read.metadata.servo}
        metadata = replace(read.metadata, robot=robot, servo=servo)
        found[path.stem] = Recording(columns, metadata)
    return found


def _piece(recording: Recording, number: int, count: int) -> Recording:
    """Piece `number` of `count` equally long ones."""
    ends = np.linspace(0, recording.ticks, count + 1).astype(int)
    return rows(recording, int(ends[number]), int(ends[number + 1]))


def _stretch(recording: Recording, rng: np.random.Generator) -> Recording:
    """A drawn stretch of a long recording; a short one whole."""
    length_s = float(rng.uniform(*STRETCH_S))
    share = float(rng.uniform())
    if recording.duration_s <= STRETCH_S[1]:
        return rows(recording, 0, recording.ticks)
    time_s = recording.time_s
    begin_s = time_s[0] + share * (recording.duration_s - length_s)
    start, stop = np.searchsorted(time_s, [begin_s, begin_s + length_s])
    return rows(recording, int(start), int(stop))


def _named(
    pieces: list[tuple[str, Recording]], chosen: Iterable[int]
) -> dict[str, Recording]:
    picked = [pieces[i] for i in chosen]
    return {f"{k}_{stem}": one for k, (stem, one) in enumerate(picked)}


def _times(joint: str, recordings: Iterable[Recording]) -> int:
    """Number of recordings in which a joint moves."""
    reaches = [np.ptp(one.columns[f"position.{joint}"]) for one in recordings]
    return sum(bool(reach >= MOVES) for reach in reaches)

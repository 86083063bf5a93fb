"""How a test case with concealed physics is written, whichever set it is of."""

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.concealed.reading import PLANT_FILE, RECORDINGS, REFERENCE
from groundwalk.files import write_text
from worlds.recordings.files import write_recording
from worlds.recordings.recording import Recording

SOURCE = "groundwalk concealed"
"""What the recordings' metadata name as their source."""


@dataclass(frozen=True, eq=False)
class MadeCase:
    """A test case, ready to be written.

    Attributes:
      robot: name of the robot.
      model: name and text of its model file; None for a robot that its name tells.
      before: the same of the reference, if that has a model of its own.
      base: "fixed" or "floating".
      recordings: by name without ending, in the order of the names.
      reference: recordings of the healthy robot in the same form; may be empty.
      truth: entry of the case in the sealed file (see `scoring.truth.TrueCase`).
    """

    robot: str
    model: tuple[str, str] | None
    base: str
    recordings: Mapping[str, Recording]
    reference: Mapping[str, Recording]
    truth: Mapping[str, Any]
    before: tuple[str, str] | None = None


def case_name(number: int) -> str:
    """The name of a test case by its number, such as "case_007"."""
    return f"case_{number:03d}"


def write_case(cases: Path, truths: Path, name: str, made: MadeCase) -> None:
    """Write a test case: its truth (the hidden effects), then its whole folder.

    `cases` and `truths` are the folders of all cases and truths. The folder of the case
    appears when it is complete.
    """
    unfinished = cases / f".{name}.partial"
    shutil.rmtree(unfinished, ignore_errors=True)
    robot = made.robot
    if made.model is not None:
        robot, text = made.model
        write_text(unfinished / robot, text)
    told = {"robot": robot, "base": made.base}
    if made.before is not None:
        told[REFERENCE], text = made.before
        write_text(unfinished / made.before[0], text)
    content = json.dumps(told, indent=1)
    write_text(unfinished / PLANT_FILE, content + "\n")
    for part, recordings in (
        (RECORDINGS, made.recordings),
        (REFERENCE, made.reference),
    ):
        for stem, recording in recordings.items():
            write_recording(recording, unfinished / part / f"{stem}.parquet")
    write_text(truths / f"{name}.json", json.dumps(made.truth, indent=1) + "\n")
    unfinished.rename(cases / name)

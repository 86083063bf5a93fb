"""Reading what a case shows: its plant, its recordings, those of when all was well."""

import json
from pathlib import Path

from diagnosis.plant.plant import Plant
from diagnosis.traces.read import read_reference, read_traces
from diagnosis.traces.trace import Trace
from groundwalk.errors import RunFolderError

RECORDINGS, REFERENCE, PLANT_FILE = "recordings", "reference", "plant.json"
ANSWERS, BASELINE_ANSWERS = "answers", "baselines"
"""Folders of a set: of the diagnosis' verdicts, and with one for each baseline."""


def read_case(folder: Path) -> tuple[Plant, list[Trace], list[Trace]]:
    """Nominal plant, recordings and reference of a case; not its truth.

    Args:
      folder: of the case; a robot that stands or walks has a reference.

    Raises:
      RunFolderError: the folder holds no case.
      BadRecordingError: a recording cannot be read.
    """
    path = folder / PLANT_FILE
    if not path.is_file():
        raise RunFolderError(f"{folder} holds no case: there is no {PLANT_FILE}")
    robot = json.loads(path.read_text())["robot"]
    source = folder / robot if (folder / robot).exists() else robot
    plant, traces = read_traces(sorted((folder / RECORDINGS).glob("*.parquet")), source)
    wells = sorted((folder / REFERENCE).glob("*.parquet"))
    return plant, traces, read_reference(wells, source, plant)

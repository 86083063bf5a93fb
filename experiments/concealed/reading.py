"""Names of the files of a set of concealed test cases; reads one without its truth."""

import json
from pathlib import Path

from diagnosis import Plant, Reference, Trace, read_reference, read_traces
from groundwalk.errors import RunFolderError

CASES, SEALED, TRUTH, HASH = "cases", "sealed", "truth.json", "sealed.sha256"
"""In the folder of a set: folder of the test cases, folder of the sealed truth, file of
the truth (all hidden effects), and file with its SHA-256."""
RECORDINGS, REFERENCE, PLANT_FILE = "recordings", "reference", "plant.json"
"""In the folder of a test case: folder of recordings, folder of reference recordings
(the healthy robot), and file that names the robot model."""
ANSWERS, BASELINE_ANSWERS = "answers", "baselines"
"""In the folder of a set: folder of the diagnosis' verdicts, and folder with a
subfolder of verdicts for each baseline."""
FORMAT = 1
"""Version of the format of the file with the sealed truth."""


def read_case(folder: Path) -> tuple[Plant, list[Trace], Reference | None]:
    """Robot model, recordings and reference recordings of a test case, not its truth.

    Not all cases have reference recordings.
    """
    path = folder / PLANT_FILE
    if not path.is_file():
        raise RunFolderError(f"{folder} holds no case: there is no {PLANT_FILE}")
    told = json.loads(path.read_text())
    source, then = (
        folder / robot if (folder / robot).exists() else robot
        for robot in (told["robot"], told.get(REFERENCE, told["robot"]))
    )
    plant, traces = read_traces(sorted((folder / RECORDINGS).glob("*.parquet")), source)
    healthy = sorted((folder / REFERENCE).glob("*.parquet"))
    return plant, traces, read_reference(healthy, then, plant)

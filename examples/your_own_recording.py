"""Diagnose recordings: what physics does the model lack that they show?

    python examples/your_own_recording.py --folder runs/dirt

Here they are made: a pendulum in PyBullet with dirt in its hinge. Your own are
files of the format in docs/recordings.md; `worlds.write_recording` writes NumPy arrays.
"""

from pathlib import Path

import tyro

from diagnosis import Verdict
from experiments.diagnose import Diagnose, run_diagnosis
from experiments.diagnosis_report.console import print_verdict
from experiments.record import Record
from experiments.record import main as record

DIRT = "coulomb_friction@swing:torque=0.15"


def main(folder: Path, duration: float = 8.0) -> Verdict:
    """Record twice, diagnose, and say what was found.

    Args:
      folder: gets the recordings, and the diagnosis beside them.
      duration: of a recording [s].
    """
    paths = tuple(folder / f"{motion}.parquet" for motion in ("multisine", "ramps"))
    for seed, path in enumerate(paths):
        motion = path.stem
        record(Record(path, "pendulum", "real", motion, None, (DIRT,), duration, seed))
    model = str(folder / "ramps.nominal.xml")
    found, verdict = run_diagnosis(Diagnose(paths, model, out=folder / "diagnosis"))
    print_verdict(verdict, [found.path / "report.html"])
    return verdict


if __name__ == "__main__":
    tyro.cli(main)

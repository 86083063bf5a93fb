"""Diagnose recordings: find physics that they show and the robot's model lacks.

    python examples/your_own_recording.py --folder runs/dirt

This example makes its own recordings: a pendulum in PyBullet with dirt in its hinge.
Recordings of your own robot are files in the format of docs/recordings.md, which
`worlds.write_recording` writes from NumPy arrays.
"""

from pathlib import Path

from diagnosis import Verdict
from experiments import (
    Diagnose,
    Record,
    make_recording,
    print_verdict,
    run_diagnosis,
    run_script,
)

DIRT = "coulomb_friction@swing:torque=0.15"


def main(folder: Path, duration: float = 8.0) -> Verdict:
    """Make two recordings, diagnose them, and print the verdict.

    Args:
      folder: folder for the recordings and the diagnosis.
      duration: length of a recording [s].
    """
    paths = tuple(folder / f"{motion}.parquet" for motion in ("multisine", "ramps"))
    for seed, path in enumerate(paths):
        motion = path.stem
        make_recording(
            Record(path, "pendulum", "real", motion, None, (DIRT,), duration, seed)
        )
    model = str(folder / "ramps.nominal.xml")
    found, verdict = run_diagnosis(Diagnose(paths, model, out=folder / "diagnosis"))
    print_verdict(verdict, [found.path / "report.html"])
    return verdict


if __name__ == "__main__":
    run_script(main)

"""Benchmark: `groundwalk check`, compared with one simulation of each effect.

The check runs as a user starts it, imports included, on 60 s of an arm with six joints.
It says of how many effects it gave sizes. A program that simulated the recordings once
with each of these effects, one after the other with MuJoCo's `mj_step`, would need at
least the time to which it is compared, and would propose no motions. The check uses
two threads, the simulations one: the ratio holds for a machine that is idle otherwise.
"""

import contextlib
import copy
import io
import json
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Literal

import mujoco

from benchmarks.ratios import judged, seconds
from diagnosis.plant.load import load_plant
from experiments.record import Record
from experiments.record import main as record

ROBOT = "so101"
Moves = Literal["multisine", "ramps"]
MOTIONS: tuple[Moves, ...] = ("multisine", "ramps")
DURATION_S, ROUNDS = 30.0, 3
STEP_S = 0.004
"""Time step of the check's own simulations of robots with a fixed base."""

SIMULATED_S = 6.0
"""What is simulated with `mj_step`, to be multiplied up."""

MOST = 1.0
"""Largest ratio of times with which the benchmark passes."""


def measure() -> list[float]:
    """Time of the check divided by that of the simulations, in each round."""
    model = copy.copy(load_plant(ROBOT, "fixed").model)
    model.opt.timestep = STEP_S
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        recordings = [_recorded(Path(folder), motion) for motion in MOTIONS]
        for number in range(ROUNDS):
            out = Path(folder, f"run_{number}")
            check_s = seconds(partial(_checked, recordings, out))
            effects = len(json.loads((out / "result.json").read_text())["sizes"])
            once_s = seconds(partial(_simulated, model))
            times = effects * len(MOTIONS) * DURATION_S / SIMULATED_S
            ratios.append(check_s / (times * once_s))
    return ratios


def report(ratios: list[float]) -> tuple[str, bool]:
    """Text that reports the ratios of times, and whether their median passes."""
    name = "time against a simulation of each effect"
    line, passes = judged(name, ratios, "at most", MOST)
    lasted = f"{len(MOTIONS)} recordings of {DURATION_S:g} s"
    return f"check of {lasted} of the arm {ROBOT}\n{line}", passes


def _recorded(folder: Path, motion: Moves) -> Path:
    path = folder / f"{motion}.parquet"
    with contextlib.redirect_stdout(io.StringIO()):
        record(Record(path, robot=ROBOT, motion=motion, duration=DURATION_S))
    return path


def _checked(recordings: list[Path], out: Path) -> None:
    command = ["check", *map(str, recordings), "--out", str(out)]
    start = "from experiments.command_line import main; main()"
    subprocess.run(
        [sys.executable, "-c", start, *command], check=True, capture_output=True
    )


def _simulated(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=round(SIMULATED_S / STEP_S))

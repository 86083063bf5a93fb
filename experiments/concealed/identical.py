"""Makes a test case in which nothing is missing: the model is the arm, exactly."""

from typing import Any

import numpy as np

from experiments.concealed.written import SOURCE, MadeCase
from experiments.motions import Excitation
from groundwalk.arrays import FloatArray
from worlds.hidden.random_arm import Drive, RandomArm
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording

MOTIONS = ("multisine", "ramps", "steps")
"""Motions of a case, a recording each."""

MOST_JOINTS = 7
"""Largest number of joints; cases have one joint, two and so on in turn."""

_MODEL = "arm.xml"
_RATES_HZ = (50.0, 100.0, 200.0, 500.0, 1000.0)
_DURATION_S = 8.0
_CLEAN_RAD, _NOISY_RAD = (1e-5, 3e-4), (3e-4, 3e-3)
"""Ranges of the encoder's noise, for 14 cases each in turn."""
_CENTRE_RAD, _RANGE_RAD, _SPEED_RAD_S = 0.5, 1.2, 6.0
"""Largest angle at which a motion is centred, reach of the motion from there, and speed
limit of its commands."""


def identical_case(seed: int, number: int, count: int) -> MadeCase:
    """Make a test case; it depends on the set's seed and its own number only.

    One to seven joints take turns, and so do MuJoCo's own position actuators and a
    loop at 10 kHz, and little and much noise. `count`, the number of cases, is not
    used.
    """
    rng = np.random.default_rng([seed, number])
    drives: tuple[Drive, Drive] = ("actuators", "loop")
    turn = number // MOST_JOINTS
    arm = RandomArm.drawn(1 + number % MOST_JOINTS, drives[turn % 2], rng)
    clean = turn // 2 % 2 == 0
    low, high = np.log(_CLEAN_RAD if clean else _NOISY_RAD)
    noise_rad = float(np.exp(rng.uniform(low, high)))
    rate_hz = float(rng.choice(_RATES_HZ))
    recordings = {
        f"{k}_{motion}": _recording(arm, motion, rate_hz, noise_rad, rng)
        for k, motion in enumerate(MOTIONS)
    }
    model = (_MODEL, arm.xml)
    truth = _truth(arm, rate_hz)
    return MadeCase(_MODEL, model, "fixed", recordings, {}, truth)


def _recording(
    arm: RandomArm,
    motion: str,
    rate_hz: float,
    noise_rad: float,
    rng: np.random.Generator,
) -> Recording:
    """A motion as noisy encoders see it."""
    count, tick_s = len(arm.joints), 1.0 / rate_hz
    centre = rng.uniform(-_CENTRE_RAD, _CENTRE_RAD, count)
    plan = Excitation(
        centre_rad=centre,
        range_rad=centre[:, None] + np.array([-_RANGE_RAD, _RANGE_RAD]),
        speed_rad_s=np.full(count, _SPEED_RAD_S),
        moves=np.ones(count, bool),
    )
    time_s = np.asarray(np.arange(round(_DURATION_S * rate_hz)) / rate_hz, float)
    command = plan.commands(motion, time_s, rng)
    angles = arm.moved(command, tick_s)
    angles = angles + noise_rad * rng.standard_normal(angles.shape)
    columns: dict[str, FloatArray] = {"time": time_s}
    for k, joint in enumerate(arm.joints):
        columns[f"position.{joint}"] = angles[:, k]
        columns[f"command.{joint}"] = command[:, k]
    metadata = RecordingMetadata(_MODEL, "fixed", SOURCE, servo=arm.gains)
    return Recording(columns, metadata)


def _truth(arm: RandomArm, rate_hz: float) -> dict[str, Any]:
    """The case's entry in the sealed file."""
    return {
        "plant": f"{len(arm.joints)} joints, {arm.drive}",
        "engine": "mujoco",
        "kind": "none",
        "effects": [],
        "size": None,
        "held": [],
        "rate_hz": rate_hz,
        "reference": False,
    }

"""Joint commands that excite the physics of a robot on its feet: squat, sway, walk."""

from collections.abc import Callable

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import UnknownNameError
from robots import Biped, Description, biped
from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.legs import Legs
from worlds.hidden.engine import BodySense
from worlds.world import TICK_S

STANDING_MOTIONS = ("squat", "fast_squat", "sway")
"""Names of all motions in which both feet keep standing on the ground."""

_HIGH, _DEEP = 0.97, 0.80
"""Distance from hip to ankle as a share of the straight leg's length: when standing
upright, and in the deepest squat."""

_SWAY_M, _SLOW_HZ, _FAST_HZ = 0.02, 0.35, 0.9
"""Amplitude of swaying sideways [m]; frequencies of slow and of fast motions [Hz]."""

_ARM_RAD, _ARM_ROLL_RAD, _START_S = 0.3, 0.2, 1.0
"""Amplitude of the arms' swing [rad], their constant angle away from the body [rad],
and the time in which a motion's amplitude grows from zero [s]."""

WALK_SPEEDS = (0.06, 0.16)
"""Range from which the forward speed of a walk is drawn [m/s]."""


def standing_commands(
    description: Description, motion: str, time_s: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """Draw the commands of one of `STANDING_MOTIONS` of a biped at random.

    They are (T, joints) position targets [rad] for times (T,) [s], beginning with 0.

    Raises:
      UnknownNameError: the motion is unknown.
    """
    if motion not in STANDING_MOTIONS:
        raise UnknownNameError("motion on the feet", motion, STANDING_MOTIONS)
    body = biped(description)
    start = 0.5 - 0.5 * np.cos(np.pi * np.minimum(time_s / _START_S, 1.0))
    hertz = (_FAST_HZ if motion == "fast_squat" else _SLOW_HZ) * rng.uniform(0.8, 1.2)
    wave = 2 * np.pi * hertz * time_s
    down, aside = np.zeros_like(time_s), np.zeros_like(time_s)
    if motion == "sway":
        aside = _SWAY_M * rng.uniform(0.6, 1.0) * np.sin(wave)
        down = 0.2 * (1 - np.cos(0.31 * wave))
    else:
        deep = 0.5 if motion == "fast_squat" else 1.0
        down = deep * rng.uniform(0.6, 1.0) * (1 - np.cos(wave)) / 2
    command = _pose(body, start * down, start * aside)
    _swing_arms(body, command, start, time_s, rng)
    low, high = body.joint_range_rad.T
    return np.clip(command, low, high)


def _pose(body: Biped, down: FloatArray, aside_m: FloatArray) -> FloatArray:
    """(T, joints) targets [rad]: squat `down` (T,) of 0 to 1, hips moved aside (T,)."""
    leg = body.leg
    length = (leg.thigh_m + leg.tibia_m) * (_HIGH - (_HIGH - _DEEP) * down)
    hip_x, hip_y, hip_z = leg.hip_m
    low, high = body.joint_range_rad.T
    rest = np.clip(0.0, low, high)
    command = np.repeat(rest[None], len(down), axis=0)
    none = np.zeros_like(down)
    ankle = [
        np.stack([none + hip_x, hip_y + side * aside_m, hip_z - length])
        for side in (-1.0, 1.0)
    ]
    still = np.zeros((2, len(down)))
    left, right = Legs(body).angles(
        np.stack(ankle, axis=1), still, still, np.stack([still, still])
    )
    command[:, list(body.left_leg)] = left.T
    command[:, list(body.right_leg)] = right.T
    return command


def _swing_arms(
    body: Biped,
    command: FloatArray,
    start: FloatArray,
    time_s: FloatArray,
    rng: np.random.Generator,
) -> None:
    for arm, side in ((body.left_arm, 1.0), (body.right_arm, -1.0)):
        if arm is None:
            continue
        turns = 2 * np.pi * rng.uniform(0.2, 0.6) * time_s + rng.uniform(0, 2 * np.pi)
        hanging = body.hanging_rad[0 if side > 0 else 1]
        command[:, arm[0]] = hanging + _ARM_RAD * start * np.sin(turns)
        command[:, list(arm[1:])] = side * _ARM_ROLL_RAD


def walking_feed(
    description: Description, rng: np.random.Generator, rest_rows: int
) -> tuple[FloatArray, Callable[[int, BodySense], FloatArray]]:
    """Make the start pose of a walk, and a function that computes its commands.

    The biped stands for `rest_rows` ticks before it walks, at a random speed. The
    function of the tick's number and of the measurements returns commands (joints,)
    [rad].
    """
    body = biped(description)
    engine = WalkEngine(body, [gaits.get("walk2014")], TICK_S)
    ahead = Velocity(forward_m_s=float(rng.uniform(*WALK_SPEEDS)))

    def feed(row: int, sense: BodySense) -> FloatArray:
        request = Velocity() if row < rest_rows else ahead
        rate, force = sense.gyroscope_rad_s[None], sense.foot_force_n[None]
        return np.asarray(engine.step(request, rate, force)[0])

    return engine.start_pose()[0], feed

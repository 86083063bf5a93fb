"""Decides when a rollout is over: the robot fell, diverged or left its ground."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from terrain import Heightfield
from worlds.observation import Truth, up_z
from worlds.world import End

FALL_TILT_RAD = math.radians(60)
"""A robot has fallen when its torso's up axis is more than 60 degrees from vertical."""
FALL_HEIGHT_RATIO = 0.5
"""A robot has fallen when its torso is lower than this share of its start height."""
DIVERGED_SPEED_M_S = 50.0
"""Torso speed along one axis [m/s] from which the physics counts as diverged. Walks
stay below 1 m/s and falls below 5 m/s."""


def fallen(
    up_z: FloatArray, height_m: FloatArray, start_height_m: float | FloatArray
) -> BoolArray:
    """(n,) whether robots have fallen, by the rule that all worlds share.

    From `up_z` (n,), the cosine of the angle between torso and vertical, and the
    torso's height above the ground below it, now (n,) and at the start of the rollout.
    """
    low = height_m < FALL_HEIGHT_RATIO * start_height_m
    return np.asarray((up_z < math.cos(FALL_TILT_RAD)) | low)


class EndRule:
    """Decides at each tick whose rollouts are over; call it with the robots' truth."""

    def __init__(self, grounds: Sequence[Heightfield], start: Truth) -> None:
        """Remember how high every torso starts on its ground; robots may share one."""
        shared = np.array([id(ground) for ground in grounds])
        rows = [np.flatnonzero(shared == one) for one in dict.fromkeys(shared.tolist())]
        self._shared_by = [(grounds[robots[0]], robots) for robots in rows]
        self._start_height_m, _ = self._above_ground(start)

    def __call__(self, truth: Truth, sound: BoolArray) -> Mapping[End, BoolArray]:
        """Masks (n,) of the rollouts that end now, by reason; each ends for one only.

        `sound` (n,) says which robots' states and measurements are all finite.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            height_m, on_ground = self._above_ground(truth)
            fell = fallen(up_z(truth.base_orientation), height_m, self._start_height_m)
            speed_m_s = np.abs(truth.base_linear_velocity_m_s).max(axis=1)
            diverged = ~sound | ~(speed_m_s < DIVERGED_SPEED_M_S)
        return {
            End.DIVERGED: diverged,
            End.FALL: fell & ~diverged,
            End.LEFT_GROUND: ~(on_ground | fell | diverged),
        }

    def _above_ground(self, truth: Truth) -> tuple[FloatArray, BoolArray]:
        """(n,) height of each torso over its ground [m]; (n,) False beyond its edge."""
        x, y, z = truth.base_position_m.T
        height_m, on_ground = z.copy(), np.ones(len(z), bool)
        for ground, rows in self._shared_by:
            height_m[rows] -= ground.height_at(x[rows], y[rows])
            on_ground[rows] = ground.contains(x[rows], y[rows])
        return height_m, on_ground

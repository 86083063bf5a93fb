"""When a rollout is over: the robot fell, diverged or left its ground."""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from terrain import Heightfield
from worlds.observation import Truth
from worlds.world import End

FALL_TILT_RAD = math.radians(60)
"""A torso whose up axis is farther than this from the vertical has fallen."""
FALL_HEIGHT_RATIO = 0.5
"""A torso that is below this share of its start height over the ground has fallen."""
DIVERGED_SPEED_M_S = 50.0
"""A torso this fast is not walking: the integration has gone wrong. Walks stay below
1 m/s and falls below 5 m/s."""


def fallen(
    up_z: FloatArray, height_m: FloatArray, start_height_m: float | FloatArray
) -> BoolArray:
    """(n,) whether torsos have fallen: the one rule of all worlds.

    Args:
      up_z: (n,) cosine of the angle between the torso's up axis and the vertical.
      height_m: (n,) height of the torso above the ground below it.
      start_height_m: that height at the start, one number or (n,).
    """
    low = height_m < FALL_HEIGHT_RATIO * start_height_m
    return np.asarray((up_z < math.cos(FALL_TILT_RAD)) | low)


class EndRule:
    """Decides for n robots whether their rollouts are over."""

    def __init__(self, grounds: Sequence[Heightfield], start: Truth) -> None:
        """Remember how high every torso starts.

        Args:
          grounds: one per robot; robots may share one object.
          start: where the robots start.
        """
        robots = defaultdict(list)
        for i, ground in enumerate(grounds):
            robots[id(ground)].append(i)
        self._shared_by = [
            (grounds[rows[0]], np.array(rows)) for rows in robots.values()
        ]
        self._start_height_m, _ = self._above_ground(start)

    def __call__(self, truth: Truth, sound: BoolArray) -> Mapping[End, BoolArray]:
        """Which rollouts end now, and why.

        Args:
          truth: where the robots are; rows that are not sound may hold anything.
          sound: (n,) whether a robot's physics gave finite numbers.

        Returns:
          (n,) mask for each reason; no robot is in two of them.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            height_m, on_ground = self._above_ground(truth)
            fell = fallen(truth.up_z, height_m, self._start_height_m)
            speed_m_s = np.abs(truth.base_linear_velocity_m_s).max(axis=1)
            diverged = ~sound | ~(speed_m_s < DIVERGED_SPEED_M_S)
        return {
            End.DIVERGED: diverged,
            End.FALL: fell & ~diverged,
            End.LEFT_GROUND: ~(on_ground | fell | diverged),
        }

    def _above_ground(self, truth: Truth) -> tuple[FloatArray, BoolArray]:
        """(n,) height of each torso over the ground below, and whether there is any."""
        x, y, z = truth.base_position_m.T
        height_m, on_ground = z.copy(), np.ones(len(z), bool)
        for ground, rows in self._shared_by:
            height_m[rows] -= ground.height_at(x[rows], y[rows])
            on_ground[rows] = ground.contains(x[rows], y[rows])
        return height_m, on_ground

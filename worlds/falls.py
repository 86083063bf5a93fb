"""When a rollout is over: the robot fell, flew apart or left its ground."""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from terrain import Heightfield
from worlds.observation import Truth
from worlds.world import End

FALL_TILT_RAD = math.radians(60)
FALL_HEIGHT_RATIO = 0.5
DIVERGED_SPEED_M_S = 50.0
"""A torso this fast is not walking: the integration has gone wrong."""


class EndRule:
    """Decides for n robots whether their rollouts are over."""

    def __init__(self, grounds: Sequence[Heightfield], start: Truth) -> None:
        """Remember how high every torso started."""
        robots = defaultdict(list)
        for i, ground in enumerate(grounds):
            robots[id(ground)].append(i)
        self._shared_by = [
            (grounds[rows[0]], np.array(rows)) for rows in robots.values()
        ]
        self._start_height_m, _ = self._above_ground(start)

    def __call__(self, truth: Truth, sound: BoolArray) -> Mapping[End, BoolArray]:
        """Which rollouts end now, and why.

        A fall is a torso's up axis more than 60 degrees from vertical, or its height
        above the ground below half of its start height.

        Args:
          truth: where the robots are; rows that are not sound may hold anything.
          sound: (n,) whether a robot's physics gave finite numbers.

        Returns:
          (n,) mask for each reason; no robot is in two of them.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            height_m, on_ground = self._above_ground(truth)
            low = height_m < FALL_HEIGHT_RATIO * self._start_height_m
            fell = (truth.up_z < math.cos(FALL_TILT_RAD)) | low
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

"""From the feet to joint angles: height, lean, legs and arms."""

import math

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import Biped
from walk_engine.engine_config import EngineConfig
from walk_engine.feet import Feet
from walk_engine.leg_ik import MIRROR, inverse
from walk_engine.step_plan import GaitColumns


class Posture:
    """The pose of every joint of n robots of one kind."""

    def __init__(self, biped: Biped, gait: GaitColumns, config: EngineConfig) -> None:
        """Prepare for robots with these gaits (16 arrays of n values)."""
        leg = biped.leg
        self._biped = biped
        self._gait = gait
        self._shoulder_roll_rad = config.shoulder_roll_rad
        self._standing_m = leg.ankle_height_m + config.stretch * (
            leg.thigh_m + leg.tibia_m
        )
        low, high = biped.joint_range_rad.T
        self._rest_rad = np.clip(0.0, low, high)
        # A positive turn about an axis that points down turns the toes inward.
        self._outward = math.copysign(1.0, leg.yaw_axis[2])

    def targets(
        self, feet: Feet, down: FloatArray, ankle_rad: FloatArray
    ) -> FloatArray:
        """Joint targets (joints, n), not yet limited.

        Joints of neither leg nor shoulder stay at the angle of their range next to 0.

        Args:
          feet: where the feet shall be.
          down: (n,) see `crouched`; the lean and the offset of the hip grow with it.
          ankle_rad: (2, 2, n) added to the ankles' pitch and roll, for each foot.
        """
        biped = self._biped
        target = np.repeat(self._rest_rad[:, None], len(down), axis=1)
        left, right = self._legs(feet, down)
        for columns, angles, added in (
            (biped.left_leg, left, ankle_rad[:, 0]),
            (biped.right_leg, right, ankle_rad[:, 1]),
        ):
            angles[4:] += added
            target[list(columns)] = angles
        for arm, behind_m, roll_rad in (
            (biped.left_arm, feet.behind_m[0], self._shoulder_roll_rad),
            (biped.right_arm, feet.behind_m[1], -self._shoulder_roll_rad),
        ):
            if arm is not None:
                target[arm[0]] = math.pi / 2 - self._gait["arm_swing"] * behind_m
                target[arm[1]] = roll_rad
        return target

    def _legs(self, feet: Feet, down: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Angles (6, n) of the left and of the right leg, the soles level."""
        leg = self._biped.leg
        hip_m = self._standing_m + (self._gait["hip_height"] - self._standing_m) * down
        below_m = hip_m - leg.ankle_height_m - feet.lift_m
        ahead_m = -(feet.behind_m + feet.com_offset_m * down)
        outward_m = below_m * _pair(np.tan(feet.opening_rad))
        tilt = _pair(self._gait["torso_pitch"] * down)
        cosine, sine = np.cos(tilt), np.sin(tilt)
        ankle_m = np.stack(
            (
                leg.hip_m[0] + cosine * ahead_m + sine * below_m,
                leg.hip_m[1] + outward_m,
                leg.hip_m[2] + sine * ahead_m - cosine * below_m,
            )
        )
        yaw = _pair(self._outward * feet.toe_out_rad)
        angles = inverse(leg, yaw, ankle_m, tilt)
        return angles[:, 0], angles[:, 1] * np.reshape(MIRROR, (6, 1))


def _pair(values: FloatArray) -> FloatArray:
    """The same (n,) values for both feet, (2, n).

    Copied, not broadcast: the arrays that go into sines and the like are contiguous,
    so that every robot's numbers come out the same whatever the number of robots.
    """
    return np.stack((values, values))

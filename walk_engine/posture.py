"""Joint angles from positions of the feet, and their limits of range and speed."""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import Biped
from walk_engine.engine_config import EngineConfig
from walk_engine.feet import Feet
from walk_engine.legs import Legs
from walk_engine.step_plan import GaitColumns


class Posture:
    """Computes the joint angles of n equal robots from positions of their feet."""

    def __init__(self, biped: Biped, gait: GaitColumns, config: EngineConfig) -> None:
        """Prepare the inverse kinematics and the resting angles of the other joints."""
        leg = biped.leg
        self._biped = biped
        self._gait = gait
        self._legs = Legs(biped)
        self._shoulder_roll_rad = config.shoulder_roll_rad
        self._below_hip_m = leg.hip_m[0] + biped.ankles_ahead_m
        straight_m = leg.thigh_m + leg.tibia_m
        self._standing_m = leg.ankle_height_m + config.stretch * straight_m
        low, high = biped.joint_range_rad.T
        self._rest_rad = np.clip(0.0, low, high)

    def targets(
        self, feet: Feet, down: FloatArray, ankle_rad: FloatArray
    ) -> FloatArray:
        """Joint targets (joints, n) [rad], before the limits of range and speed.

        Joints that belong to neither a leg nor a shoulder stay at 0, or at the angle of
        their range that is nearest to 0. The torso's lean and the offset of the hip are
        proportional to `down` (n,), the depth of the crouch: 0 upright, 1 at the
        walking height. `ankle_rad` (2, 2, n) is added to pitch and roll of each ankle
        [rad].
        """
        biped = self._biped
        target = np.repeat(self._rest_rad[:, None], len(down), axis=1)
        left, right = self._leg_angles(feet, down, ankle_rad)
        target[list(biped.left_leg)] = left
        target[list(biped.right_leg)] = right
        for side, arm, roll_rad in (
            (0, biped.left_arm, self._shoulder_roll_rad),
            (1, biped.right_arm, -self._shoulder_roll_rad),
        ):
            if arm is not None:
                swing = self._gait["arm_swing"] * feet.behind_m[side]
                target[arm[0]] = biped.hanging_rad[side] - biped.arm_signs[side] * swing
                target[list(arm[1:])] = roll_rad
        return target

    def _leg_angles(
        self, feet: Feet, down: FloatArray, ankle_rad: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Angles (6, n) [rad] of the left and of the right leg with level soles."""
        leg = self._biped.leg
        hip_m = self._standing_m + (self._gait["hip_height"] - self._standing_m) * down
        below_m = hip_m - leg.ankle_height_m - feet.lift_m
        ahead_m = -(feet.behind_m + feet.com_offset_m * down)
        outward_m = below_m * _pair(np.tan(feet.opening_rad))
        tilt = _pair(self._gait["torso_pitch"] * down)
        cosine, sine = np.cos(tilt), np.sin(tilt)
        ankle_m = np.stack(
            (
                self._below_hip_m + cosine * ahead_m + sine * below_m,
                leg.hip_m[1] + outward_m,
                leg.hip_m[2] + sine * ahead_m - cosine * below_m,
            )
        )
        return self._legs.angles(ankle_m, _pair(feet.toe_out_rad), tilt, ankle_rad)


def _pair(values: FloatArray) -> FloatArray:
    """Repeat values (n,) for both feet as an array (2, n).

    Copied, not broadcast: the bits of NumPy's sines depend on the memory layout.
    """
    return np.stack((values, values))


class Limits:
    """Limits of joint commands: the joints' ranges and their motors' speeds."""

    def __init__(self, biped: Biped, tick_s: float, speed_fraction: float) -> None:
        """Compute limits per tick [s]; speeds are a fraction of the no-load speeds."""
        self._low_rad, self._high_rad = biped.joint_range_rad.T[:, :, None].copy()
        self._change_rad = biped.max_speed_rad_s[:, None] * speed_fraction * tick_s

    def within_range(self, target_rad: FloatArray) -> FloatArray:
        """Clip joint targets (joints, n) [rad] to the joints' ranges."""
        return np.clip(target_rad, self._low_rad, self._high_rad)

    def towards(self, before_rad: FloatArray, target_rad: FloatArray) -> FloatArray:
        """Move from commands towards targets (joints, n) as fast as motors allow."""
        change = self.within_range(target_rad) - before_rad
        return before_rad + np.clip(change, -self._change_rad, self._change_rad)

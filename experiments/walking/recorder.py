"""Writes rollouts down while they happen."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from robots.description import SENSORS_PER_FOOT, Description
from worlds import Observation, Recording, RecordingMetadata, ServoGains, Truth

_AXES = ("x", "y", "z")


class Recorder:
    """Collects what some robots of a world measure, tick by tick."""

    def __init__(self, description: Description, robots: Sequence[int]) -> None:
        """Nothing is recorded yet.

        Args:
          description: the robot.
          robots: which of the world's robots to record.
        """
        self._description = description
        self._robots = list(robots)
        self._rows: dict[int, list[FloatArray]] = {robot: [] for robot in robots}

    def tick(
        self,
        observation: Observation,
        truth: Truth,
        command_rad: FloatArray,
        support: npt.ArrayLike,
        active: BoolArray,
    ) -> None:
        """Note one tick of the robots that are still active.

        Args:
          observation: what was measured before the command took effect.
          truth: where the robots were then.
          command_rad: (n, joints) the command given then; NaN if there was none.
          support: (n,) 1 left leg, -1 right leg, 0 both.
          active: (n,) mask.
        """
        for robot in self._robots:
            if active[robot]:
                parts = [
                    *(values[robot] for values in vars(observation).values()),
                    *(values[robot] for values in vars(truth).values()),
                    command_rad[robot],
                    np.asarray(support)[robot],
                ]
                self._rows[robot].append(
                    np.concatenate(list(map(np.atleast_1d, parts)))
                )

    def recording(self, robot: int, metadata: RecordingMetadata) -> Recording:
        """What was recorded of one robot, in the columns of format 1."""
        table = np.array(self._rows[robot]).T
        columns = dict(zip(self._names(), table, strict=True))
        for side in ("left", "right"):
            sensors = [
                columns[f"foot_force.{side}.{name}"] for name in SENSORS_PER_FOOT
            ]
            columns[f"foot_force.{side}"] = np.sum(sensors, axis=0)
        return Recording(columns, metadata)

    def _names(self) -> list[str]:
        """Columns in the order of `tick`'s rows."""
        joints = self._description.joints
        return [
            "time",
            *(f"position.{joint}" for joint in joints),
            *(f"velocity.{joint}" for joint in joints),
            *(f"gyroscope.{axis}" for axis in _AXES),
            *(f"accelerometer.{axis}" for axis in _AXES),
            *(
                f"foot_force.{side}.{name}"
                for side in ("left", "right")
                for name in SENSORS_PER_FOOT
            ),
            *(f"base.position.{axis}" for axis in _AXES),
            *(f"base.orientation.{axis}" for axis in ("w", *_AXES)),
            *(f"base.linear_velocity.{axis}" for axis in _AXES),
            *(f"base.angular_velocity.{axis}" for axis in _AXES),
            *(f"command.{joint}" for joint in joints),
            "support",
        ]


def servo_gains(description: Description) -> dict[str, ServoGains]:
    """Every joint's servo as recordings state it."""
    return {
        joint.name: ServoGains(
            kp=joint.motor.kp_nm_rad,
            kd=joint.motor.kd_nm_s_rad,
            max_torque=joint.motor.stall_torque_nm,
        )
        for joint in description.links
    }

"""Records the measurements of robots in a world, tick by tick."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from robots.description import SENSORS_PER_FOOT, Description
from worlds import Observation, Recording, RecordingMetadata, ServoGains, Truth

_AXES = ("x", "y", "z")


class Recorder:
    """Collects measurements of some robots of a world, and makes recordings of them.

    Example:
      >>> recorder = Recorder(world.description, robots=[0])
      >>> walk_trials(world, gaits, TrialRules(), recorder=recorder)
      >>> recording = recorder.recording(0, metadata)
      See docs/python.md.
    """

    def __init__(self, description: Description, robots: Sequence[int]) -> None:
        """Make a recorder without any ticks.

        Args:
          description: the robot model.
          robots: indices of the robots to record among the world's n robots.
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
        """Add one tick of the robots that are still active.

        Args:
          observation: measurements of the n robots before the command took effect.
          truth: poses and velocities of the robots' bases at that time.
          command_rad: (n, joints) position targets [rad] of this tick; NaN for none.
          support: (n,) the supporting leg: 1 left, -1 right, 0 both.
          active: (n,) whether a robot's trial still runs; others are not recorded.
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
        """Make the recording of the robot with this index in the world."""
        table = np.array(self._rows[robot]).T
        columns = dict(zip(self._names(), table, strict=True))
        for side in ("left", "right"):
            sensors = [
                columns[f"foot_force.{side}.{name}"] for name in SENSORS_PER_FOOT
            ]
            columns[f"foot_force.{side}"] = np.sum(sensors, axis=0)
        return Recording(columns, metadata)

    def _names(self) -> list[str]:
        """Names of the columns, in the order in which `tick` adds their values."""
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
    """Stiffness, damping and torque limit of every joint's servo, by joint."""
    return {
        joint.name: ServoGains(
            kp=joint.motor.kp_nm_rad,
            kd=joint.motor.kd_nm_s_rad,
            max_torque=joint.motor.stall_torque_nm,
        )
        for joint in description.links
    }

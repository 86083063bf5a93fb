"""Records the measurements of robots in a world, tick by tick."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from robots import Description
from worlds import Observation, Recording, RecordingMetadata, ServoGains, Truth
from worlds.recordings.recording import SUPPORT, TIME, vector_columns


class Recorder:
    """Collects measurements of some robots of a world, and makes recordings of them.

    Example:
      >>> recorder = Recorder(world.description, robots=[0])
      >>> walk_trials(world, gaits, TrialRules(), recorder=recorder)
      >>> recording = recorder.recording(0, metadata)
      See docs/python.md.
    """

    def __init__(self, description: Description, robots: Sequence[int]) -> None:
        """Record the robots with these indices among the world's n robots."""
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
        """Add one tick of those of the n robots that are still active (n,).

        Observation and truth are from before the command (n, joints) [rad] took effect;
        NaN is no command. Support (n,) is 1 for left, -1 for right, 0 for both.
        """
        for robot in self._robots:
            if active[robot]:
                measured = (*vars(observation).values(), *vars(truth).values())
                every = (*measured, command_rad, np.asarray(support))
                self._rows[robot].append(np.hstack([part[robot] for part in every]))

    def recording(self, robot: int, metadata: RecordingMetadata) -> Recording:
        """Make the recording of the robot with this index in the world."""
        table = np.array(self._rows[robot]).T
        columns = dict(zip(self._names(), table, strict=True))
        for side in ("foot_force.left", "foot_force.right"):
            sensors = [columns[name] for name in vector_columns(side)]
            columns[side] = np.sum(sensors, axis=0)
        return Recording(columns, metadata)

    def _names(self) -> list[str]:
        """Names of the columns, in the order in which `tick` adds their values."""
        joints = self._description.joints
        vectors = (
            "gyroscope", "accelerometer", "foot_force.left", "foot_force.right",
            "base.position", "base.orientation", "base.linear_velocity",
            "base.angular_velocity",
        )  # fmt: skip
        return [
            TIME,
            *(f"position.{joint}" for joint in joints),
            *(f"velocity.{joint}" for joint in joints),
            *(name for vector in vectors for name in vector_columns(vector)),
            *(f"command.{joint}" for joint in joints),
            SUPPORT,
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

"""`Recording`: one rollout written down, in memory.

Format 1 has one row a tick, SI units and radians, joint names as in the model.

| column | meaning |
|---|---|
| `time` | [s], increasing, never missing; steps may be uneven |
| `position.<joint>` | measured; every joint that appears at all has it |
| `command.<joint>` | position target |
| `command_torque.<joint>` | commanded torque |
| `torque.<joint>` | measured torque |
| `velocity.<joint>` | measured |
| `base.position.{x,y,z}` | of the base's link frame, in the world frame |
| `base.orientation.{w,x,y,z}` | unit quaternion, base to world |
| `base.linear_velocity.{x,y,z}` | in the world frame |
| `base.angular_velocity.{x,y,z}` | in the body frame |
| `gyroscope.{x,y,z}`, `accelerometer.{x,y,z}` | measured, in the sensor's frame |
| `foot_force.{left,right}` | [N], one sum a foot |
| `foot_force.{left,right}.{front,rear}_{left,right}` | [N], each sensor |
| `support` | leg on which the gait means to stand: -1 right, 0 both, 1 left |

At least one column of `command`, `command_torque` or `torque` is there. Every other
column but `time` and `position` is optional, but a vector comes whole. Values may
be missing (NaN here, null in a file). Row k holds what was measured at `time[k]`
before `command[k]` took effect; the command holds until `time[k + 1]`.

A recording also has metadata (`worlds.recordings.metadata`): robot, base and source,
and where they are known servo, terrain, gait, world and end. Files need not have the
forces of single sensors, `support`, or any metadata beyond robot, base and source.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError, UnknownNameError
from worlds.recordings.columns import (
    JOINT_QUANTITIES,
    POSITION,
    TIME,
    VECTORS,
    check_names,
    joints_with,
    nearest,
    vector_columns,
)
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.values import check_values, frozen_columns


@dataclass(frozen=True, eq=False)
class Recording:
    """One rollout as columns of equal length, with metadata about its origin.

    The constructor checks all columns and metadata against format 1, and raises
    `BadRecordingError` at the first fault. The arrays are read-only.

    Example:
      >>> columns = {"time": time_s, "position.swing": measured_rad,
      ...            "command.swing": command_rad}
      >>> metadata = RecordingMetadata("pendulum.xml", "fixed", "in water")
      >>> recording = Recording(columns, metadata)
    """

    columns: dict[str, FloatArray]
    """Values by column name, each of shape (ticks,); NaN is a missing value."""
    metadata: RecordingMetadata

    def __post_init__(self) -> None:
        """Check the columns' names and values, and the joints in the metadata.

        Raises:
          BadRecordingError: they are not those of format 1; the message names the
            column and the row of the first fault.
        """
        check_names(list(self.columns))
        object.__setattr__(self, "columns", frozen_columns(self.columns))
        check_values(self.columns)
        for joint in self.metadata.servo:
            if joint not in self.joints:
                raise BadRecordingError(
                    f"metadata has a servo for {joint!r}, which is no joint here"
                    f"{nearest(joint, self.joints)}"
                )

    @property
    def time_s(self) -> FloatArray:
        """Time of each tick [s], shape (ticks,)."""
        return self.columns[TIME]

    @property
    def ticks(self) -> int:
        """Number of rows; there is one for each control tick."""
        return self.time_s.size

    @property
    def duration_s(self) -> float:
        """Time from the first tick to the last one [s]."""
        return float(self.time_s[-1] - self.time_s[0])

    @property
    def joints(self) -> tuple[str, ...]:
        """The recorded joints, in the order of their position columns."""
        return self.joints_with(POSITION)

    def joints_with(self, quantity: str) -> tuple[str, ...]:
        """The joints that have a column of a quantity, in the order of the columns.

        Args:
          quantity: "position", "velocity", "command", "command_torque" or "torque".

        Raises:
          UnknownNameError: there is no such quantity.
        """
        if quantity not in JOINT_QUANTITIES:
            raise UnknownNameError("joint quantity", quantity, JOINT_QUANTITIES)
        return joints_with(quantity, self.columns)

    def positions(self, joints: Sequence[str]) -> FloatArray:
        """Measured positions [rad; m if sliding], shape (ticks, joints).

        Args:
          joints: names of joints, in the order of the result's columns.

        Raises:
          UnknownNameError: a joint was not recorded.
        """
        return self._of_joints(POSITION, joints)

    def velocities(self, joints: Sequence[str]) -> FloatArray:
        """Measured velocities [rad/s; m/s if sliding], shape (ticks, joints).

        Args:
          joints: names of joints, in the order of the result's columns.

        Raises:
          UnknownNameError: a joint has no column "velocity.<joint>".
        """
        return self._of_joints("velocity", joints)

    def commands(self, joints: Sequence[str]) -> FloatArray:
        """Position targets [rad; m if sliding], shape (ticks, joints).

        Args:
          joints: names of joints, in the order of the result's columns.

        Raises:
          UnknownNameError: a joint has no column "command.<joint>".
        """
        return self._of_joints("command", joints)

    def torques(self, joints: Sequence[str]) -> FloatArray:
        """Measured torques [N m; N if sliding], shape (ticks, joints).

        Args:
          joints: names of joints, in the order of the result's columns.

        Raises:
          UnknownNameError: a joint has no column "torque.<joint>".
        """
        return self._of_joints("torque", joints)

    def has(self, vector: str) -> bool:
        """Whether a vector was recorded.

        Args:
          vector: for example "base.orientation" or "foot_force".

        Raises:
          UnknownNameError: format 1 has no such vector.
        """
        if vector not in VECTORS:
            raise UnknownNameError("vector", vector, VECTORS)
        return vector_columns(vector)[0] in self.columns

    def vector(self, vector: str) -> FloatArray:
        """The values of a vector in SI units, shape (ticks, components).

        Args:
          vector: for example "base.orientation" (components w, x, y, z), "gyroscope"
            (x, y, z) or "foot_force" (left, right).

        Raises:
          UnknownNameError: there is no such vector, or it was not recorded.
        """
        if not self.has(vector):
            raise UnknownNameError(
                "vector of this recording", vector, filter(self.has, VECTORS)
            )
        return np.stack([self.columns[name] for name in vector_columns(vector)], axis=1)

    def slice(self, start: int, stop: int | None = None) -> "Recording":
        """The part of the recording from row `start` to before row `stop`.

        Negative rows count from the end. The times stay the same.

        Raises:
          BadRecordingError: no row is left.
        """
        rows = slice(start, stop)
        return Recording(
            {name: values[rows] for name, values in self.columns.items()},
            self.metadata,
        )

    def _of_joints(self, quantity: str, joints: Sequence[str]) -> FloatArray:
        names = [f"{quantity}.{joint}" for joint in joints]
        for name, joint in zip(names, joints, strict=True):
            if name not in self.columns:
                raise UnknownNameError(
                    f"joint with a {quantity}", joint, self.joints_with(quantity)
                )
        if not names:
            return np.empty((self.ticks, 0))
        return np.stack([self.columns[name] for name in names], axis=1)

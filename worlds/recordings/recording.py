"""`Recording`: one rollout written down, in memory, with the columns of format 1.

docs/recordings.md lists the columns; units are SI and radians. At least one column of
`command`, `command_torque` or `torque` is there; every other one but `time` and
`position` is optional, but a vector comes whole. Values may be missing (NaN here, null
in a file). Row k holds what was measured at `time[k]` before `command[k]` took effect;
the command holds until `time[k + 1]`. Metadata: `worlds.recordings.metadata`.
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
    check_values,
    frozen_columns,
    joints_with,
    nearest,
    vector_columns,
)
from worlds.recordings.metadata import RecordingMetadata


@dataclass(frozen=True, eq=False)
class Recording:
    """One rollout as read-only columns of equal length, with metadata on its origin.

    The constructor checks all columns and metadata against format 1, and raises
    `BadRecordingError` with column and row of the first fault.

    Example:
      >>> columns = {"time": time_s, "position.swing": measured_rad, ...
      "command.swing": command_rad} >>> recording = Recording(columns,
      RecordingMetadata("arm.xml", "fixed", "in water"))
    """

    columns: dict[str, FloatArray]
    """Values by column name, each of shape (ticks,); NaN is a missing value."""
    metadata: RecordingMetadata

    def __post_init__(self) -> None:
        """Check the columns' names and values, and the joints in the metadata."""
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
        """The joints with a column of a quantity, in the order of the columns.

        Quantities are position, velocity, command, command_torque and torque.
        """
        if quantity not in JOINT_QUANTITIES:
            raise UnknownNameError("joint quantity", quantity, JOINT_QUANTITIES)
        return joints_with(quantity, self.columns)

    def joint_values(self, quantity: str, joints: Sequence[str]) -> FloatArray:
        """(ticks, joints) values of a quantity of some joints, in SI units."""
        known = self.joints_with(quantity)
        for joint in joints:
            if joint not in known:
                raise UnknownNameError(f"joint with a {quantity}", joint, known)
        if not joints:
            return np.empty((self.ticks, 0))
        return np.stack([self.columns[f"{quantity}.{joint}"] for joint in joints], 1)

    def has(self, vector: str) -> bool:
        """Whether a vector, such as "foot_force", was recorded."""
        if vector not in VECTORS:
            raise UnknownNameError("vector", vector, VECTORS)
        return vector_columns(vector)[0] in self.columns

    def vector(self, vector: str) -> FloatArray:
        """(ticks, components) values of a vector, such as "gyroscope", in SI units."""
        if not self.has(vector):
            raise UnknownNameError(
                "vector of this recording", vector, filter(self.has, VECTORS)
            )
        return np.stack([self.columns[name] for name in vector_columns(vector)], axis=1)

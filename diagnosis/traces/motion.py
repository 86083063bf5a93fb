"""The smoothed motion of a recording, from which the torques that it needs follow."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from groundwalk.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class Motion:
    """Smoothed motion of the j joints at the T rows of a recording.

    Attributes:
      position_rad, velocity_rad_s, acceleration_rad_s2: (T, j) smoothed, without delay.
      counts: (T, j) whether a joint moves so fast that the sign of its speed is known,
        and the row is measured and not at the recording's ends. Only then its torque
        tells: at rest dry friction may have any value up to its largest one.
      block_rows: number of successive rows over which torques are averaged: faster
        changes of the motion are smoothed away.
      noise_nm: (j,) standard deviation of such an average of the measured torque less
        the torque that the motion needs, by sensor noise.
      left_nm: (j,) standard deviation of that average of what regression of the
        measured torque on the joint's motion leaves.
      by_servo: whether torques are those that servos ask for by their declared law, not
        measured ones.
    """

    position_rad: FloatArray
    velocity_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    counts: BoolArray
    block_rows: int
    noise_nm: FloatArray
    left_nm: FloatArray
    by_servo: bool = False

    def part(self, start: int, stop: int) -> "Motion":
        """Rows `start` to `stop - 1`."""
        rows = slice(start, stop)
        return replace(
            self,
            position_rad=self.position_rad[rows],
            velocity_rad_s=self.velocity_rad_s[rows],
            acceleration_rad_s2=self.acceleration_rad_s2[rows],
            counts=self.counts[rows],
        )

    def of(self, columns: Sequence[int]) -> "Motion":
        """The motion with only the joints of these indices."""
        chosen = list(columns)
        return replace(
            self,
            position_rad=self.position_rad[:, chosen],
            velocity_rad_s=self.velocity_rad_s[:, chosen],
            acceleration_rad_s2=self.acceleration_rad_s2[:, chosen],
            counts=self.counts[:, chosen],
            noise_nm=self.noise_nm[chosen],
            left_nm=self.left_nm[chosen],
        )

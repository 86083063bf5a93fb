"""Channels: the measured quantities that simulations are compared with."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import Replayed
from diagnosis.traces.noise import noise_of
from diagnosis.traces.trace import Trace, asked
from diagnosis.traces.windows import continuous
from groundwalk.arrays import FloatArray

FINEST = 1e-7
"""Smallest noise assumed, as a share of a channel's range: what rounding numbers for a
file makes. The accuracy of the simulation itself is added later, see `precise`."""

MORE_THAN_NOISE = 2.0
"""If the best model leaves this multiple of the noise, more is missing than noise: no
model of this robot is exact, what is left is taken as noise, and effects are shared by
joints first."""

LEAST_TORQUE = 0.02
"""Smallest noise assumed for measured torques, as a share of their rms: the accuracy to
which the constants of a motor are known."""


@dataclass(frozen=True, eq=False)
class Channels:
    """The c measured quantities that simulations are compared with.

    Attributes:
      names: names of the channels, for example "position.LKneePitch".
      noise: (c,) standard deviation in each channel's unit by which residuals are
        divided: the floor, or what the best model leaves if that is more.
      floor: (c,) standard deviation of sensor noise and of the simulation's own error;
        by default `noise`.
      own_jitter_s, common_jitter_s: rms errors of the time stamps, of each channel by
        itself and of a whole row; the noise does not include what they add.
      share_at_rest: (c,) share of the floor that is left without what they add.
      rounding: (c,) standard deviation of what rounding alone makes, as that of an
        encoder. It lasts as long as a joint rests, so that what changes from row to row
        does not show it.
    """

    names: tuple[str, ...]
    noise: FloatArray
    floor: FloatArray = None  # type: ignore[assignment]
    own_jitter_s: float = 0.0
    common_jitter_s: float = 0.0
    share_at_rest: float | FloatArray = 1.0
    rounding: float | FloatArray = 0.0

    def __post_init__(self) -> None:
        """Take the noise for the floor by default."""
        if self.floor is None:
            object.__setattr__(self, "floor", self.noise)

    @property
    def wider(self) -> FloatArray:
        """(c,) the noise as a multiple of that of the sensors, both without jitter."""
        return np.asarray(self.noise / (self.floor * self.share_at_rest))

    @property
    def jitter_s(self) -> float:
        """Rms error of the time stamps [s], that of a row included."""
        return float(np.hypot(self.own_jitter_s, self.common_jitter_s))

    def read(self, exact: FloatArray, random: np.random.Generator) -> FloatArray:
        """(rows, c) exact values with drawn noise, rounded as sensors round them."""
        quantum = np.sqrt(12) * np.broadcast_to(self.rounding, self.noise.shape)
        white = np.sqrt(np.maximum(self.noise**2 - quantum**2 / 12, 0.0))
        read = exact + white * random.standard_normal(exact.shape)
        steps = np.where(quantum > 0, quantum, 1.0)
        return np.asarray(np.where(quantum > 0, np.round(read / steps) * steps, read))

    def widened(self, left: FloatArray) -> "Channels":
        """The channels with their noise (c,) times as large, and the same floor."""
        return replace(self, noise=self.noise * left)

    def jittering(self, share: FloatArray, own_s: float, common_s: float) -> "Channels":
        """The channels with a jitter of time stamps, and (c,) shares of their noise."""
        return replace(
            self,
            noise=self.noise * share,
            share_at_rest=share,
            own_jitter_s=own_s,
            common_jitter_s=common_s,
        )

    @property
    def untimed(self) -> "Channels":
        """The channels with noise that includes what jitter adds on average."""
        return replace(
            self,
            noise=self.noise / self.share_at_rest,
            share_at_rest=1.0,
            own_jitter_s=0.0,
            common_jitter_s=0.0,
        )

    def of_joint(self, joint: str) -> list[int]:
        """Indices of the channels that belong to a joint."""
        return [i for i, name in enumerate(self.names) if name.endswith(f".{joint}")]


def channel_unit(plant: Plant, name: str) -> str:
    """The unit of a channel: "rad", "rad/s" or "N m"; "m" or "N" at sliding joints."""
    if name.startswith("base.position"):
        return "m"
    kind, _, joint = name.partition(".")
    unit = {"torque": "N m", "gyroscope": "rad/s"}.get(kind, "rad")
    return plant.unit(unit, joint)


def shared_channels(plant: Plant, traces: Sequence[Trace]) -> Channels:
    """The channels that all recordings measured and that can be simulated.

    Their noise is estimated from the recordings. If the traces have a `motion`, the
    torques that it needs are all that is compared; their noise is then what a
    regression on the motion leaves, and only the floor that of sensors.
    """
    motions = [trace.motion for trace in traces]
    if all(motion is not None for motion in motions):
        each = [(one.noise_nm, one.left_nm) for one in motions if one is not None]
        names = [f"torque.{joint}" for joint in plant.joints]
        floor, left = np.median(each, axis=0)
        floor = np.where(floor > 0, floor, 1.0)
        if asked(traces):  # regression is learned of the healthy robot
            return Channels(tuple(names), floor)
        return Channels(tuple(names), np.maximum(floor, left), floor)
    names = [f"position.{joint}" for joint in plant.joints]
    if all(trace.torque_nm is not None and not trace.unheld for trace in traces):
        names += [f"torque.{joint}" for joint in plant.joints]
    if all(trace.gyroscope_rad_s is not None for trace in traces):
        names += [f"gyroscope.{axis}" for axis in "xyz"]
    if plant.base == "floating":
        names += [f"base.position.{axis}" for axis in "xyz"]
        names += [f"base.{angle}" for angle in ("roll", "pitch", "yaw")]
    bare = Channels(tuple(names), np.ones(len(names)))
    measured = [measured_of(trace, bare) for trace in traces]
    found = [
        [noise_of(trace.time_s, one) for one in values.T]
        for trace, values in zip(traces, measured, strict=True)
    ]
    total = np.median([[one.total for one in own] for own in found], axis=0)
    rounding = np.median([[one.rounding for one in own] for own in found], axis=0)
    noise = np.maximum(total, _least(names, np.vstack(measured)))
    noise = np.where(noise > 0, noise, 1.0)
    return Channels(tuple(names), noise, rounding=rounding)


def _least(names: Sequence[str], values: FloatArray) -> FloatArray:
    """(c,) smallest noise of the channels whose (rows, c) values were measured."""
    there = np.isfinite(values)
    low, high = (np.where(there, values, side).T for side in (np.inf, -np.inf))
    reach = FINEST * np.maximum(high.max(axis=1) - low.min(axis=1), 0.0)
    is_torque = np.array([name.startswith("torque.") for name in names])
    size = np.sqrt(np.mean(np.where(there, values, 0.0) ** 2, axis=0))
    return np.asarray(np.where(is_torque, LEAST_TORQUE * size, reach))


def measured_of(trace: Trace, channels: Channels) -> FloatArray:
    """(T, c) values of the c channels that a recording measured, in their units."""
    parts = []
    if any(name.startswith("position.") for name in channels.names):
        parts.append(trace.position_rad)
    if any(name.startswith("torque.") for name in channels.names):
        assert trace.torque_nm is not None
        parts.append(trace.torque_nm)
    if "gyroscope.x" in channels.names:
        assert trace.gyroscope_rad_s is not None
        parts.append(trace.gyroscope_rad_s)
    if "base.roll" in channels.names:
        assert trace.base_position_m is not None
        assert trace.base_orientation is not None
        parts += [trace.base_position_m, angles_rad(continuous(trace.base_orientation))]
    return np.hstack(parts)


def stacked(result: Replayed, channels: Channels) -> FloatArray:
    """(n, rows, c) values of the c channels in the replays of n models."""
    parts = [result.position_rad]
    if any(name.startswith("torque.") for name in channels.names):
        parts.append(result.servo_nm)
    if "gyroscope.x" in channels.names:
        parts.append(result.gyroscope_rad_s)
    if "base.roll" in channels.names:
        assert result.base is not None
        parts += [result.base[:, :, :3], angles_rad(result.base[:, :, 3:7])]
    return np.concatenate(parts, axis=2)


def angles_rad(quaternion: FloatArray) -> FloatArray:
    """(..., 3) roll, pitch and yaw [rad] of (..., 4) quaternions (w, x, y, z).

    The rotation is yaw about z, then pitch about the new y, then roll about the new x.
    Not SciPy's `Rotation.as_euler`, whose last digits differ.
    """
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)

"""Channels: the measured quantities that simulations are compared with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import Replayed
from diagnosis.traces.noise import noise_of
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import continuous
from groundwalk.arrays import FloatArray

LEAST_NOISE_RAD = 3e-4
"""Smallest noise [rad] assumed for measured positions and angles: encoders and clocks
are not better, and smaller differences are errors of the simulator."""

LEAST_RATE_RAD_S = 1e-3
"""Smallest noise [rad/s] assumed for gyroscopes."""

LEAST_NOISE_M = 2e-4
"""Smallest noise [m] assumed for the measured position of a floating base."""

LEAST_TORQUE = 0.02
"""Smallest noise assumed for measured torques, as a share of their rms: the accuracy to
which the constants of a motor are known."""


@dataclass(frozen=True, eq=False)
class Channels:
    """The c measured quantities that simulations are compared with.

    Attributes:
      names: names of the channels, for example "position.LKneePitch".
      noise: (c,) standard deviation of the noise in each channel's unit.
    """

    names: tuple[str, ...]
    noise: FloatArray

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

    Their noise is estimated from the recordings, with a least value for each sensor.
    """
    names = [f"position.{joint}" for joint in plant.joints]
    least = [LEAST_NOISE_RAD] * len(names)
    if all(trace.torque_nm is not None and not trace.unheld for trace in traces):
        names += [f"torque.{joint}" for joint in plant.joints]
        every = np.concatenate([t.torque_nm for t in traces if t.torque_nm is not None])
        least += (LEAST_TORQUE * np.sqrt(np.nanmean(every**2, axis=0))).tolist()
    if all(trace.gyroscope_rad_s is not None for trace in traces):
        names += [f"gyroscope.{axis}" for axis in "xyz"]
        least += [LEAST_RATE_RAD_S] * 3
    if plant.base == "floating":
        names += [f"base.position.{axis}" for axis in "xyz"]
        names += [f"base.{angle}" for angle in ("roll", "pitch", "yaw")]
        least += [LEAST_NOISE_M] * 3 + [LEAST_NOISE_RAD] * 3
    bare = Channels(tuple(names), np.ones(len(names)))
    found = [
        [noise_of(trace.time_s, one).total for one in measured_of(trace, bare).T]
        for trace in traces
    ]
    noise = np.maximum(np.median(found, axis=0), least)
    return Channels(tuple(names), np.where(noise > 0, noise, 1.0))


def measured_of(trace: Trace, channels: Channels) -> FloatArray:
    """(T, c) values of the c channels that a recording measured, in their units."""
    parts = [trace.position_rad]
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

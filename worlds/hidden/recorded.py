"""Makes a recording with sensor noise from the true motion of a simulated robot."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.run import Run
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording, vector_columns


@dataclass(frozen=True)
class HiddenSensors:
    """Standard deviations of the sensors' noise, and their resolution.

    The encoders have noise before they round to a multiple of `quantum_rad`, which is
    12 bits per turn by default; 0 for no rounding. `foot_force_n` is the noise of each
    foot's total force, `place_m`, `turn_rad`, `linear_m_s` and `angular_rad_s` that of
    the base, as from motion capture; `torque_share` is that of measured torques as a
    share of each joint's largest. All others are those of each component or axis.
    """

    quantum_rad: float = 2 * math.pi / 4096
    encoder_rad: float = 0.0004
    gyroscope_rad_s: float = 0.004
    accelerometer_m_s2: float = 0.06
    foot_force_n: float = 0.4
    place_m: float = 0.0002
    turn_rad: float = 0.0005
    linear_m_s: float = 0.005
    angular_rad_s: float = 0.005
    torque_share: float = 0.005

    def __post_init__(self) -> None:
        """Refuse standard deviations and resolutions that are negative."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise BadValueError(f"{name} is {value}; it must not be negative")


@dataclass(frozen=True, eq=False)
class Log:
    """What is written down of a run, beside positions.

    Attributes:
      rate_hz: ticks per second, if time stamps are even, whatever the true times were;
        None for the true times.
      torques: whether the motors' torques are measured, and neither commands nor
        velocities are known, as of a controller that tells nothing about itself.
      torque_gain: (j,) measured torques as multiples of the true ones; None for 1.
    """

    rate_hz: float | None = None
    torques: bool = False
    torque_gain: FloatArray | None = None


def hidden_recording(
    plant: HiddenPlant,
    run: Run,
    effects: Sequence[Hidden],
    sensors: HiddenSensors,
    rng: np.random.Generator,
    metadata: RecordingMetadata,
    log: Log | None = None,
) -> Recording:
    """The recording that noisy sensors make of a run; rows before its start are cut.

    Velocities are differences of the encoders' readings, as cheap servos give them. Of
    the effects only a gyroscope bias and faults of single readings are used. `metadata`
    are stated in the recording. Without a `log` commands and true times are written.
    """
    first, log = run.clock.first, log or Log()
    measured = run.encoder_rad + sensors.encoder_rad * rng.standard_normal(
        run.encoder_rad.shape
    )
    if sensors.quantum_rad > 0:
        measured = np.round(measured / sensors.quantum_rad) * sensors.quantum_rad
    time_s = run.clock.time_s
    if log.rate_hz is not None:
        time_s = (np.arange(len(time_s)) - first) / log.rate_hz
    for effect in effects:
        if effect.kind.place == "joint":
            joint = plant.joint(effect.place)
            read = effect.kind.misread(effect.values, time_s, measured[:, joint], rng)
            measured[:, joint] = read
    columns = {"time": time_s}
    if log.torques:
        tables = {
            "position": measured,
            "torque": _torques(plant, run, sensors, log, rng),
        }
    else:
        speeds = np.zeros_like(measured)
        speeds[1:] = np.diff(measured, axis=0) / np.diff(time_s)[:, None]
        tables = {"position": measured, "velocity": speeds, "command": run.command_rad}
    for quantity, table in tables.items():
        for name, values in zip(plant.joints, table.T, strict=True):
            columns[f"{quantity}.{name}"] = values
    if plant.description is not None:
        bias = surroundings(effects).gyroscope_bias_rad_s
        columns |= _inertial(run, bias, sensors, rng)
    if plant.floating:
        columns |= _base(run, sensors, rng)
    return Recording({name: v[first:] for name, v in columns.items()}, metadata)


def _torques(
    plant: HiddenPlant,
    run: Run,
    sensors: HiddenSensors,
    log: Log,
    rng: np.random.Generator,
) -> FloatArray:
    """(rows, j) measured torques [N m] of the motors."""
    noise = rng.standard_normal(run.torque_nm.shape)
    gain = 1.0 if log.torque_gain is None else log.torque_gain
    spread_nm = sensors.torque_share * plant.max_torque_nm
    return np.asarray(gain * run.torque_nm + spread_nm * noise)


def _vector(name: str, table: FloatArray) -> dict[str, FloatArray]:
    return dict(zip(vector_columns(name), table.T, strict=True))


def _inertial(
    run: Run, bias: FloatArray, sensors: HiddenSensors, rng: np.random.Generator
) -> dict[str, FloatArray]:
    """Noisy gyroscope [rad/s] and accelerometer [m/s^2] columns of a recording."""
    rate, felt = run.sense["gyroscope_rad_s"], run.sense["accelerometer_m_s2"]
    noise = rng.standard_normal((2, *rate.shape))
    rate = rate + bias + sensors.gyroscope_rad_s * noise[0]
    felt = felt + sensors.accelerometer_m_s2 * noise[1]
    return _vector("gyroscope", rate) | _vector("accelerometer", felt)


def _base(
    run: Run, sensors: HiddenSensors, rng: np.random.Generator
) -> dict[str, FloatArray]:
    """Noisy foot forces, base pose and base velocities as columns of a recording."""
    sense, rows = run.sense, len(run.command_rad)

    def noisy(name: str, spread: float) -> FloatArray:
        return np.asarray(sense[name] + spread * rng.standard_normal((rows, 3)))

    feet = sense["foot_force_n"].reshape(rows, 2, 4).sum(axis=2)
    feet = np.maximum(feet + sensors.foot_force_n * rng.standard_normal((rows, 2)), 0)
    columns = _vector("foot_force", feet)
    columns |= _vector("base.position", noisy("position_m", sensors.place_m))
    turned = _turned(sense["orientation"], sensors.turn_rad, rng)
    columns |= _vector("base.orientation", turned)
    columns |= _vector("base.linear_velocity", noisy("linear_m_s", sensors.linear_m_s))
    angular = noisy("angular_rad_s", sensors.angular_rad_s)
    return columns | _vector("base.angular_velocity", angular)


def _turned(
    orientation: FloatArray, spread_rad: float, rng: np.random.Generator
) -> FloatArray:
    """Quaternions (rows, 4), turned about each axis with this standard deviation."""
    x, y, z = (spread_rad / 2 * rng.standard_normal((len(orientation), 3))).T
    a, b, c, d = orientation.T
    # orientation times the quaternion (1, x, y, z), which is a small rotation
    turned = np.stack(
        [
            a - b * x - c * y - d * z,
            b + a * x + c * z - d * y,
            c + a * y + d * x - b * z,
            d + a * z + b * y - c * x,
        ],
        axis=1,
    )
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))

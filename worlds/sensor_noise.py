"""Noise and resolution of a robot's sensors, and how they act on observations."""

import math
from dataclasses import dataclass, replace

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.observation import Observation


@dataclass(frozen=True)
class SensorNoise:
    """Standard deviations of the noise of a robot's sensors; by default those of a NAO.

    White noise is added about or along x, y, z and to each foot sensor; the gyroscope's
    bias is constant in a rollout. Encoders round to `joint_quantum_rad`; 0 for no
    rounding.

    Sources: gyroscope and accelerometer: the NAO simulator of the RoboCup team HULKs
    (2025); gyroscope bias: the team rUNSWift's configurations of single robots, up to
    0.023 rad/s; joints, 12 bit per turn, and feet, sensitivity 40 g: datasheet.

    Example:
      >>> WorldOptions(noise=SensorNoise(foot_force_n=1.0))
    """

    gyroscope_rad_s: tuple[float, float, float] = (0.0039, 0.0055, 0.0024)
    gyroscope_bias_rad_s: float = 0.01
    accelerometer_m_s2: tuple[float, float, float] = (0.063, 0.030, 0.088)
    joint_quantum_rad: float = 2 * math.pi / 4096
    foot_force_n: float = 0.4

    def __post_init__(self) -> None:
        """Refuse negative and infinite values."""
        for name, value in vars(self).items():
            if not np.all(np.isfinite(value)) or np.any(np.asarray(value) < 0):
                raise BadValueError(f"{name} is {value}; it must not be negative")


class NoisySensors:
    """Adds noise to observations of n robots; each one's depends on its seed only."""

    def __init__(self, noise: SensorNoise, seeds: list[np.random.SeedSequence]) -> None:
        """Draw each robot's gyroscope bias, constant in a rollout, from its seed."""
        self._noise = noise
        self._generators = [np.random.default_rng(seed) for seed in seeds]
        self._bias = self._draw(3) * noise.gyroscope_bias_rad_s
        self._last_position: FloatArray | None = None

    def _draw(self, columns: int) -> FloatArray:
        return np.stack([g.standard_normal(columns) for g in self._generators])

    def __call__(self, clean: Observation, tick_s: float) -> Observation:
        """Return `clean` as noisy sensors report it, `tick_s` after the call before.

        Joint velocities are differences of quantised positions over one tick, as a
        robot's electronics compute them.
        """
        noise, position = self._noise, clean.position_rad
        draws = np.split(self._draw(14), [3, 6], axis=1)
        quantum = noise.joint_quantum_rad
        if quantum > 0:
            position = np.round(position / quantum) * quantum
        last = position if self._last_position is None else self._last_position
        self._last_position = position
        spin = draws[0] * np.array(noise.gyroscope_rad_s)
        shake = draws[1] * np.array(noise.accelerometer_m_s2)
        force = clean.foot_force_n + draws[2] * noise.foot_force_n
        return replace(
            clean,
            position_rad=position,
            velocity_rad_s=(position - last) / tick_s,
            gyroscope_rad_s=clean.gyroscope_rad_s + self._bias + spin,
            accelerometer_m_s2=clean.accelerometer_m_s2 + shake,
            foot_force_n=np.maximum(force, 0.0),
        )

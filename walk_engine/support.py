"""When the weight has moved to the other foot, as the force sensors tell.

Walk2014's step ends not by the clock but when the centre of pressure crosses the
robot's middle, which is how it adapts to pushes and to uneven ground.
"""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from robots.leg_geometry import Biped
from walk_engine.engine_config import EngineConfig

_UNLOADED = 1e-6
"""Sum of the scaled readings of all sensors below which no foot carries weight."""

_LEFT, _RIGHT = (0, 1, 2, 3), (5, 4, 7, 6)
"""Sensors of the left foot, and those of the right one that mirror them."""


class Sensing(NamedTuple):
    """What the force sensors told so far.

    Attributes:
      largest_n: (8, n) each sensor's largest reading, its scale.
      side: (n,) where the weight was last: 1 left, -1 right, 0 not known yet.
    """

    largest_n: FloatArray
    side: FloatArray


def nothing_sensed(robots: int, config: EngineConfig) -> Sensing:
    """What is known before the first reading."""
    return Sensing(np.full((8, robots), config.sensor_start_n), np.zeros(robots))


def sense(
    before: Sensing, force_n: FloatArray, lateral_m: FloatArray, config: EngineConfig
) -> Sensing:
    """Take in one reading.

    While no foot carries weight the last side is kept. (Walk2014 takes it for the
    middle, and misses a crossing that falls into such a tick.)

    Args:
      before: what was known.
      force_n: (8, n) the sensors' readings.
      lateral_m: (8,) see `sensor_lateral_m`.
      config: the engine's constants.
    """
    largest_n = np.clip(force_n, before.largest_n, config.sensor_full_n)
    pressure = np.maximum(force_n, 0.0) / largest_n
    cop_m = _lateral_cop_m(pressure, lateral_m)
    return Sensing(largest_n, np.where(cop_m == 0, before.side, np.sign(cop_m)))


def crossed(before: Sensing, now: Sensing) -> BoolArray:
    """Where the weight went from one side to the other between two readings."""
    return before.side * now.side < 0


def step_is_over(
    time_s: FloatArray,
    period_s: FloatArray,
    has_crossed: BoolArray,
    min_phase: FloatArray,
    config: EngineConfig,
) -> BoolArray:
    """Where the support foot changes: at a crossing that is not too early, or late."""
    late_enough = time_s > min_phase * period_s
    too_late = time_s > config.timeout_periods * period_s
    return (late_enough & has_crossed) | too_late


def next_swing(now: Sensing, left_swings: BoolArray) -> BoolArray:
    """Whether the left foot swings next: the one without the weight, if it is known."""
    return np.where(now.side == 0, ~left_swings, now.side < 0)


def sensor_lateral_m(biped: Biped) -> FloatArray:
    """Where the (8,) sensors are to the left of the torso, the feet below the hips."""
    hip_m = biped.leg.hip_m[1]
    hips_m: FloatArray = np.repeat([hip_m, -hip_m], 4)
    return biped.foot_sensor_xy_m[:, 1] + hips_m


def _lateral_cop_m(pressure: FloatArray, lateral_m: FloatArray) -> FloatArray:
    """Pressure-weighted mean position (n,), 0 without load.

    Added up one by one in mirrored order, so that neither the number of robots nor a
    mirrored world changes a bit.
    """
    moment = total = np.zeros(pressure.shape[1])
    for left, right in zip(_LEFT, _RIGHT, strict=True):
        moment = moment + (
            lateral_m[left] * pressure[left] + lateral_m[right] * pressure[right]
        )
        total = total + (pressure[left] + pressure[right])
    loaded = total > _UNLOADED
    return np.where(loaded, moment / np.where(loaded, total, 1.0), 0.0)

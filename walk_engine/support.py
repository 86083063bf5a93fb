"""Detects with the foot force sensors when the weight has moved to the other foot.

A step of rUNSWift's Walk2014 does not end at a fixed time but when the centre of
pressure crosses the robot's middle. In this way it adapts to pushes and uneven ground.
"""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from robots.leg_geometry import Biped
from walk_engine.engine_config import EngineConfig

_UNLOADED = 1e-6
"""Sum of the readings of all force sensors, each as a share of its largest reading,
below which no foot carries weight; it only has to exceed rounding errors."""

_LEFT, _RIGHT = (0, 1, 2, 3), (5, 4, 7, 6)
"""Indices of the left foot's force sensors, and of their mirror images on the right."""


class Sensing(NamedTuple):
    """The state of the force sensing of n robots.

    Attributes:
      largest_n: (8, n) each sensor's largest reading so far, used as its scale.
      side: (n,) the side that carried the weight last: 1 left, -1 right, 0 unknown.
    """

    largest_n: FloatArray
    side: FloatArray


def nothing_sensed(robots: int, config: EngineConfig) -> Sensing:
    """State of the force sensing of some robots before the first reading."""
    return Sensing(np.full((8, robots), config.sensor_start_n), np.zeros(robots))


def sense(
    before: Sensing, force_n: FloatArray, lateral_m: FloatArray, config: EngineConfig
) -> Sensing:
    """Update the state of the force sensing with readings (8, n) of the sensors [N].

    While no foot carries weight, the last side is kept. (rUNSWift's Walk2014 assumes
    the middle then, and misses a crossing in such a tick.) `lateral_m` (8,) are the
    sensors' positions left of the torso's middle [m].
    """
    largest_n = np.clip(force_n, before.largest_n, config.sensor_full_n)
    pressure = np.maximum(force_n, 0.0) / largest_n
    cop_m = _lateral_cop_m(pressure, lateral_m)
    return Sensing(largest_n, np.where(cop_m == 0, before.side, np.sign(cop_m)))


def step_is_over(
    time_s: FloatArray,
    period_s: FloatArray,
    has_crossed: BoolArray,
    min_phase: FloatArray,
    config: EngineConfig,
) -> BoolArray:
    """(n,) whether the step is over, so that the support foot changes.

    A step is over when the weight moves to the robot's other side, but not before
    `min_phase` (n,) periods, and at the latest after `config.timeout_periods` periods.
    """
    late_enough = time_s > min_phase * period_s
    too_late = time_s > config.timeout_periods * period_s
    return (late_enough & has_crossed) | too_late


def sensor_lateral_m(biped: Biped) -> FloatArray:
    """(8,) lateral positions of the force sensors [m], positive left of the middle.

    The feet are assumed to be straight below the hips.
    """
    hip_m = biped.leg.hip_m[1]
    hips_m: FloatArray = np.repeat([hip_m, -hip_m], 4)
    return biped.foot_sensor_xy_m[:, 1] + hips_m


def _lateral_cop_m(pressure: FloatArray, lateral_m: FloatArray) -> FloatArray:
    """Lateral centre of pressure (n,) [m], left positive; 0 without load."""
    moment = total = np.zeros(pressure.shape[1])
    for left, right in zip(_LEFT, _RIGHT, strict=True):
        moment = moment + (
            lateral_m[left] * pressure[left] + lateral_m[right] * pressure[right]
        )
        total = total + (pressure[left] + pressure[right])
    loaded = total > _UNLOADED
    return np.where(loaded, moment / np.where(loaded, total, 1.0), 0.0)

"""A NAO as the walk engine sees it, and a made-up world that rocks it by the clock."""

import math

import numpy as np
import pytest
from walk_drill import Drill

from robots.leg_geometry import Biped, LegGeometry

SLANT = math.sqrt(0.5)
LEG_RANGES = [
    (-1.14529, 0.740718),
    (-0.379435, 0.79046),
    (-1.53589, 0.48398),
    (-0.0923279, 2.11255),
    (-1.18944, 0.922581),
    (-0.397761, 0.768992),
]
ARM_RANGES = [
    (-2.08567, 2.08567),
    (-0.314159, 1.32645),
    (-2.08567, 2.08567),
    (-1.54462, -0.0349066),
]
LEFT_SENSORS = [
    (0.07025, 0.0299),
    (0.07025, -0.0231),
    (-0.03025, 0.0299),
    (-0.02965, -0.0191),
]


def mirrored_ranges(ranges, flipped):
    return [
        (-high, -low) if k in flipped else (low, high)
        for k, (low, high) in enumerate(ranges)
    ]


@pytest.fixture(scope="session")
def leg():
    """The left leg of NAO, with the ankle height of the published test vectors."""
    return LegGeometry((0.0, 0.05, -0.085), (0.0, SLANT, -SLANT), 0.1, 0.1029, 0.04519)


@pytest.fixture(scope="session")
def biped(leg):
    """A NAO that is its own mirror image: 20 joints, the left ones first."""
    right_sensors = [(x, -y) for x, y in (LEFT_SENSORS[k] for k in (1, 0, 3, 2))]
    ranges = (
        LEG_RANGES
        + mirrored_ranges(LEG_RANGES, flipped=(1, 5))
        + ARM_RANGES
        + mirrored_ranges(ARM_RANGES, flipped=(1, 2, 3))
    )
    leg_speeds, arm_speeds = [4.53, 4.53, 6.96, 6.96, 6.96, 4.53], [7.94, 6.47] * 2
    return Biped(
        leg=leg,
        left_leg=tuple(range(6)),
        right_leg=tuple(range(6, 12)),
        left_arm=(12, 13),
        right_arm=(16, 17),
        joint_range_rad=np.array(ranges),
        max_speed_rad_s=np.array(leg_speeds * 2 + arm_speeds * 2),
        foot_sensor_xy_m=np.array(LEFT_SENSORS + right_sensors),
    )


@pytest.fixture(scope="session")
def unlimited(biped):
    """The same robot with joints that follow everything."""
    return Biped(
        leg=biped.leg,
        left_leg=biped.left_leg,
        right_leg=biped.right_leg,
        left_arm=biped.left_arm,
        right_arm=biped.right_arm,
        joint_range_rad=np.tile([-7.0, 7.0], (20, 1)),
        max_speed_rad_s=np.full(20, 1e6),
        foot_sensor_xy_m=biped.foot_sensor_xy_m,
    )


@pytest.fixture
def drill():
    """Builds a `Drill` from an engine."""
    return Drill

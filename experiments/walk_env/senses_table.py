"""A walking robot's measurements as one vector, and its bounds."""

import math

import numpy as np
from gymnasium.spaces import Box

from experiments.walk_env.episode import WalkEpisode
from groundwalk.arrays import FloatArray
from robots.leg_geometry import FOOT_SENSORS

TURN_RAD, FASTEST_RAD_S, HARDEST_M_S2 = 2 * math.pi, 50.0, 1000.0
HEAVIEST_N, LONGEST_STEP_S = 10_000.0, 10.0


def senses_box(joints: int) -> Box:
    """Bounds of the observations of `WalkEnv`, for a robot with this many joints."""
    parts = (
        (joints, -TURN_RAD, TURN_RAD),
        (joints, -FASTEST_RAD_S, FASTEST_RAD_S),
        (3, -FASTEST_RAD_S, FASTEST_RAD_S),
        (3, -HARDEST_M_S2, HARDEST_M_S2),
        (FOOT_SENSORS, 0.0, HEAVIEST_N),
        (joints, -TURN_RAD, TURN_RAD),
        (1, -1.0, 1.0),
        (1, 0.0, LONGEST_STEP_S),
    )
    low = np.concatenate([np.full(count, least) for count, least, _ in parts])
    high = np.concatenate([np.full(count, most) for count, _, most in parts])
    return Box(low, high, dtype=np.float64)


def senses_of(episode: WalkEpisode, box: Box) -> FloatArray:
    """(columns,) measurements of the last tick and the walk engine's next command.

    `WalkEnv` lists columns and units; values outside the box are clipped.
    """
    seen = episode.observation
    vector = np.concatenate(
        [
            seen.position_rad[0],
            seen.velocity_rad_s[0],
            seen.gyroscope_rad_s[0],
            seen.accelerometer_m_s2[0],
            seen.foot_force_n[0],
            episode.command_rad,
            [episode.support, episode.step_time_s],
        ]
    )
    return np.asarray(np.clip(vector, box.low, box.high))

"""Made-up run folders: a robot that glides on straight legs, and a simple search."""

import numpy as np

import robots
from worlds import Recording, RecordingMetadata

NAO = robots.get("nao")
STANDING_M = 0.085 + 0.1 + 0.1029 + 0.04511
"""Torso height with straight legs, from the maker's dimensions."""


def glide(x_m, y_m=0.0, **about):
    """A recording at 100 Hz with the given (ticks,) base positions."""
    x_m = np.asarray(x_m, dtype=float)
    columns = {"time": 0.01 * np.arange(len(x_m))}
    for joint in NAO.joints:
        columns[f"position.{joint}"] = columns[f"command.{joint}"] = 0 * x_m
    columns |= {
        "base.position.x": x_m,
        "base.position.y": y_m + 0 * x_m,
        "base.position.z": STANDING_M + 0 * x_m,
        "base.orientation.w": 1 + 0 * x_m,
    }
    columns |= {f"base.orientation.{axis}": 0 * x_m for axis in "xyz"}
    about = {"robot": "nao", "base": "floating", "source": "a test"} | about
    return Recording(columns, RecordingMetadata(**about))


def steady(speed_m_s=0.2, duration_s=2.0, **about):
    """A recording of a robot that moves from x = 0 at a constant speed."""
    return glide(speed_m_s * np.arange(0, duration_s + 0.005, 0.01), **about)


def history(generations, fell=()):
    """A search with four gaits a generation, each generation 1 cm/s faster."""
    return [
        {
            "generation": k,
            "rewards": [k + 1.0, k - 14.0, k + 3.0, k + 2.0],
            "falls": 1,
            "mean_reward": k + 0.5,
            "mean_fell": k in fell,
            "mean_gait": {},
            "spread": [],
            "sigma": 0.1,
        }
        for k in range(generations)
    ]

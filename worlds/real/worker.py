"""A process that computes some robots of the real world."""

import importlib
import os
from multiprocessing.connection import Connection

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.real.bullet_robot import BulletRobot, BulletState
from worlds.real.hidden_robot import HiddenRobot

STATE_FIELDS = (
    ("base_pose", 7),
    ("base_velocity", 6),
    ("gyroscope_rad_s", 3),
    ("accelerometer_m_s2", 3),
    ("foot_force_n", 8),
    ("position_rad", None),
    ("velocity_rad_s", None),
)
"""What a row of a worker's answer holds, and how many numbers; None: one a joint."""


def state_columns(joints: int) -> dict[str, slice]:
    """Where each field of `BulletState` stands in a row."""
    columns, start = {}, 0
    for name, width in STATE_FIELDS:
        end = start + (joints if width is None else width)
        columns[name] = slice(start, end)
        start = end
    return columns


def serve(connection: Connection) -> None:
    """Compute robots until told to stop.

    Messages in: first (description, grounds, options), which has no answer, then
    ("start", poses, heights), ("step", active, schedule), ("stop",). The answer to
    start and step: one row a robot, in the order of `STATE_FIELDS`; NaN for one that
    has blown up, the old row for one that is not active.
    """
    _import_bullet_in_silence()
    description, grounds, options = connection.recv()
    kind = HiddenRobot if options.hidden else BulletRobot
    robots = [kind(description, ground, options) for ground in grounds]
    rows: list[FloatArray] = []
    while True:
        message = connection.recv()
        if message[0] == "stop":
            break
        if message[0] == "start":
            _, poses, heights = message
            states = zip(robots, poses, heights, strict=True)
            rows = [_row(robot.reset(pose, float(z))) for robot, pose, z in states]
        else:
            _, active, schedule = message
            for i in np.flatnonzero(active):
                own = [(targets[i], steps) for targets, steps in schedule]
                state = robots[i].step(own)
                rows[i] = (
                    np.full_like(rows[i], np.nan) if state is None else _row(state)
                )
        connection.send(np.stack(rows))
    for robot in robots:
        robot.close()


def _row(state: BulletState) -> FloatArray:
    return np.concatenate([getattr(state, name) for name, _ in STATE_FIELDS])


def _import_bullet_in_silence() -> None:
    """PyBullet greets from C; standard output is for results, for good."""
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        stderr = os.dup(2)
        os.dup2(nowhere.fileno(), 2)
        try:
            importlib.import_module("pybullet")
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)

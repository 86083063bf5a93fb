"""Worker process that computes some robots of the world "real" in PyBullet."""

import contextlib
import os
import signal
from multiprocessing.connection import Connection

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.real.body import import_bullet
from worlds.real.hidden_robot import HiddenRobot
from worlds.real.robot import BulletRobot, BulletState

STATE_FIELDS = (
    ("base_pose", 7),
    ("base_velocity", 6),
    ("gyroscope_rad_s", 3),
    ("accelerometer_m_s2", 3),
    ("foot_force_n", 8),
    ("position_rad", None),
    ("velocity_rad_s", None),
)
"""Fields of `BulletState` in the array that a worker sends back, in order, with their
numbers of columns; None stands for one column per joint."""


def state_columns(joints: int) -> dict[str, slice]:
    """Columns of each field of `BulletState` in the array that a worker sends back."""
    columns, start = {}, 0
    for name, width in STATE_FIELDS:
        end = start + (joints if width is None else width)
        columns[name] = slice(start, end)
        start = end
    return columns


def serve(connection: Connection) -> None:
    """Run a worker process: compute robots until a stop message or a lost connection.

    The first message is (description, grounds, options) and has no answer. Then come
    ("start", poses, heights), ("step", active, schedule) or ("stop",). The answer to
    "start" and "step" is an array (robots, columns) with the fields of `STATE_FIELDS`:
    NaN for a robot whose physics diverged, the old row for one that is not active.

    Args:
      connection: pipe to the process that owns the world.
    """
    # Ctrl-C reaches all processes; the process of the world ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Standard output is for results; Bullet prints to it from C at any time.
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    import_bullet()
    with contextlib.suppress(EOFError, ConnectionError):
        _answer(connection)


def _answer(connection: Connection) -> None:
    """Make the robots, and answer messages until "stop"; see `serve`."""
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

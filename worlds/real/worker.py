"""Worker process that computes some robots of the world "real" in PyBullet."""

import contextlib
import os
import signal
from multiprocessing.connection import Connection

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.real.hidden_robot import HiddenRobot
from worlds.real.robot import BulletRobot, BulletState


def state_columns(joints: int) -> dict[str, slice]:
    """Columns of each field of `BulletState` in the array that a worker sends back."""
    widths = (7, 6, 3, 3, 8, joints, joints)
    ends = zip(BulletState._fields, widths, np.cumsum(widths), strict=True)
    return {name: slice(end - width, end) for name, width, end in ends}


def serve(connection: Connection) -> None:
    """Run a worker process: compute robots until a stop message or a lost connection.

    The first message is (description, grounds, options) and has no answer. Then come
    ("start", poses, heights), ("step", active, schedule) or ("stop",). The answer to
    "start" and "step" is an array (robots, columns), see `state_columns`: NaN for a
    robot whose physics diverged, the old row for one that is not active.
    """
    # Ctrl-C reaches all processes; the process of the world ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Standard output is for results; Bullet prints to it from C at any time.
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
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
            rows = [
                np.concatenate(robot.reset(pose, float(z))) for robot, pose, z in states
            ]
        else:
            _, active, schedule = message
            for i in np.flatnonzero(active):
                own = [(targets[i], steps) for targets, steps in schedule]
                state = robots[i].step(own)
                diverged = [np.full_like(rows[i], np.nan)]
                rows[i] = np.concatenate(state or diverged)
        connection.send(np.stack(rows))
    for robot in robots:
        robot.close()

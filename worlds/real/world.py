"""The world "real": PyBullet computes the robots, in several processes."""

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Iterator
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import GroundwalkError
from worlds.hidden.engine import BodySense
from worlds.observation import Observation, Truth
from worlds.real.hidden_robot import HiddenRobot, check_hidden
from worlds.real.robot import BulletRobot
from worlds.rollouts import RolloutWorld, Schedule
from worlds.sim.world import StartHeight
from worlds.world import TICK_S


def state_columns(joints: int) -> dict[str, slice]:
    """Columns of each field of `BulletState` in the array that a worker sends back."""
    names = (*BodySense._fields, "position_rad", "velocity_rad_s")
    widths = (3, 3, 8, 3, 4, 3, 3, joints, joints)
    ends = zip(names, widths, np.cumsum(widths), strict=True)
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
    """Make robots in a worker process, and answer messages until "stop"."""
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


@contextlib.contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Let processes that start within the block ignore Ctrl-C from their first moment.

    One that is importing would print where it was interrupted. The own process gets a
    Ctrl-C after the block.
    """
    resource_tracker.ensure_running()  # as it starts it would end the blocking
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


_PATIENCE_S = 5.0
"""Time [s] for a worker process to end before it is killed; it needs milliseconds."""


class RealWorld(RolloutWorld):
    """The world "real": n robots, each in a PyBullet client, spread over processes.

    The motors are the sim's (`ServoTwin`), unless the options have hidden effects.
    Robot i's rollout has the same bits whatever n is and however many `processes` run;
    that list is empty once the world is closed.

    Example:
      >>> world = RealWorld(robot, [ground], [SeedSequence(1)], WorldOptions())
    """

    def _open(self) -> None:
        """Start the worker processes and send them their robots and grounds."""
        description, options = self.description, self.options
        check_hidden(description, options)
        workers = min(options.threads or os.cpu_count() or 1, self.n)
        self._shares = np.array_split(np.arange(self.n), workers)
        context = multiprocessing.get_context("spawn")
        self._connections = []
        self.processes = []
        for _ in self._shares:
            here, there = context.Pipe()
            process = context.Process(target=serve, args=(there,), daemon=True)
            with _interrupts_blocked():
                process.start()
            there.close()
            self._connections.append(here)
            self.processes.append(process)
        # Sent, because `start` would hang with large arguments if a process ended
        # before it had read them.
        own = [[self._grounds[i] for i in share] for share in self._shares]
        self._send([(description, part, options) for part in own])
        self._columns = state_columns(len(description.joints))
        self._start_height = StartHeight(description)

    def close(self) -> None:
        """End the worker processes; the world cannot be used afterwards."""
        for connection in self._connections:
            with contextlib.suppress(OSError):
                connection.send(("stop",))
            connection.close()
        for process in self.processes:
            process.join(_PATIENCE_S)
            if process.is_alive():
                process.kill()
        self._connections, self.processes = [], []

    def _start(self, pose_rad: FloatArray) -> None:
        heights_m = self._start_height.heights_m(pose_rad, self._grounds)
        self._exchange(
            [("start", pose_rad[share], heights_m[share]) for share in self._shares]
        )

    def _advance(self, schedule: Schedule) -> None:
        messages: list[tuple[object, ...]] = []
        for share in self._shares:
            own = [(targets[share], steps) for targets, steps in schedule]
            messages.append(("step", self.active[share], own))
        self._exchange(messages)

    def _exchange(self, messages: list[tuple[object, ...]]) -> None:
        """Send each worker its message, and store the rows of states they answer."""
        self._send(messages)
        with self._closed_if_one_ended():
            self._rows = np.concatenate([c.recv() for c in self._connections])

    def _send(self, messages: list[tuple[object, ...]]) -> None:
        with self._closed_if_one_ended():
            for connection, message in zip(self._connections, messages, strict=True):
                connection.send(message)

    @contextlib.contextmanager
    def _closed_if_one_ended(self) -> Iterator[None]:
        try:
            yield
        except (EOFError, OSError) as error:
            self.close()
            raise GroundwalkError(
                "a process of the real world ended while it was computing; "
                "run it again with one process to see why"
            ) from error

    def _read(self) -> tuple[Truth, Observation]:
        part = {name: self._rows[:, at].copy() for name, at in self._columns.items()}
        truth = Truth(
            base_position_m=part["position_m"],
            base_orientation=part["orientation"],
            base_linear_velocity_m_s=part["linear_m_s"],
            base_angular_velocity_rad_s=part["angular_rad_s"],
        )
        observation = Observation(
            time_s=self._ticks * TICK_S,
            position_rad=part["position_rad"],
            velocity_rad_s=part["velocity_rad_s"],
            gyroscope_rad_s=part["gyroscope_rad_s"],
            accelerometer_m_s2=part["accelerometer_m_s2"],
            foot_force_n=part["foot_force_n"],
        )
        return truth, observation

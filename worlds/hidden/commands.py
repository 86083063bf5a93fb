"""Brings commands to the servos of robots with hidden physics, late or on paths."""

from collections import deque
from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray

Held = tuple[float, FloatArray]
"""The share of a physics step for which servos have the same targets, and these: (j,)
angles [rad]."""


def mean_of(held: Sequence[Held]) -> FloatArray:
    """(j,) mean [rad] of the targets that servos have over a physics step."""
    shares, targets = zip(*held, strict=True)
    return np.asarray(np.array(shares) @ np.array(targets))


class CommandLine:
    """Delays commands to servos by a time that need not be whole physics steps."""

    def __init__(self, start_rad: FloatArray, delay_steps: float) -> None:
        """Begin with (j,) targets in force; later ones come `delay_steps` late."""
        self._now, self._delay = start_rad, delay_steps
        self._coming: deque[tuple[float, FloatArray]] = deque()

    def send(self, step: int, command_rad: FloatArray) -> None:
        """Send (j,) position targets at the beginning of physics step number `step`."""
        self._coming.append((step + self._delay, command_rad))

    def over(self, step: int) -> list[Held]:
        """The targets that the servos have in this physics step, one after the other.

        Must be called once for each step, in order: it drops the commands used.
        """
        held, done = list[Held](), 0.0
        while self._coming and self._coming[0][0] < step + 1:
            at, command = self._coming.popleft()
            until = max(at - step, 0.0)
            if until > done:
                held.append((until - done, self._now))
            self._now, done = command, until
        return [*held, (1.0 - done, self._now)]


class PathLine(CommandLine):
    """Leads to each command on a straight path, as controllers that plan paths do.

    The path begins when the command is sent and takes as long as the tick before.
    """

    def __init__(self, start_rad: FloatArray) -> None:
        """Begin with (j,) targets in force."""
        super().__init__(start_rad, 0.0)
        self._from = self._to = start_rad
        self._sent, self._steps = 0, 1

    def send(self, step: int, command_rad: FloatArray) -> None:
        """Lead to (j,) position targets from those of physics step number `step`."""
        self._from, self._to = self._at(step), command_rad
        self._steps, self._sent = max(step - self._sent, 1), step

    def over(self, step: int) -> list[Held]:
        """The targets in the middle of this physics step, for all of it."""
        return [(1.0, self._at(step + 0.5))]

    def _at(self, step: float) -> FloatArray:
        """(j,) position targets [rad] after this number of physics steps."""
        done = min((step - self._sent) / self._steps, 1.0)
        return np.asarray(self._from + done * (self._to - self._from))

"""Times of control ticks with jitter, and the delay of commands to the servos."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Clock:
    """The control ticks of a recorded run, as numbers of physics steps of `step_s`.

    The physics step at which each tick happens is in `ticks` (rows,), 0 first. The
    recording begins at tick number `first`, whose time is 0.
    """

    step_s: float
    ticks: IntArray
    first: int

    @property
    def time_s(self) -> FloatArray:
        """(rows,) time of each tick [s], negative before the recording begins."""
        return np.asarray((self.ticks - self.ticks[self.first]) * self.step_s)

    @classmethod
    def drawn(
        cls,
        step_s: float,
        rate_hz: float,
        spans_s: tuple[float, float],
        jitter_s: float,
        rng: np.random.Generator,
    ) -> "Clock":
        """Evenly spaced ticks, each early or late by a random number of physics steps.

        `spans_s` are the time before the recording begins and the recording's length;
        `jitter_s` is the largest deviation of a tick from its even time. BadValueError
        if it is so large that ticks change their order.
        """
        first = round(spans_s[0] * rate_hz)
        rows = first + round(spans_s[1] * rate_hz) + 1
        even = np.arange(rows) / rate_hz
        off = rng.uniform(-jitter_s, jitter_s, rows)
        ticks = np.round((even + off) / step_s).astype(np.intp)
        ticks -= ticks[0]
        if (np.diff(ticks) < 1).any():
            raise BadValueError(f"a jitter of {jitter_s} s swaps ticks")
        return cls(step_s, ticks, first)


_LEAD_STEPS = 0.5
"""Delay of every command in physics steps: in leapfrog integration the force at the
start of a step stands for the time from half a step before to half a step after it."""


class CommandLine:
    """Delays commands to servos by a time that need not be whole physics steps."""

    def __init__(self, start_rad: FloatArray, delay_steps: float) -> None:
        """Begin with (j,) targets in force; later ones come `delay_steps` late."""
        self._now, self._delay = start_rad, delay_steps + _LEAD_STEPS
        self._coming: deque[tuple[float, FloatArray]] = deque()

    def send(self, step: int, command_rad: FloatArray) -> None:
        """Send (j,) position targets at the beginning of physics step number `step`."""
        self._coming.append((step + self._delay, command_rad))

    def over(self, step: int) -> FloatArray:
        """(j,) mean position targets [rad] that the servos have in this physics step.

        Must be called once for each step, in order: it drops the commands used.
        """
        if not self._coming or self._coming[0][0] >= step + 1:
            return self._now
        mean, done = np.zeros_like(self._now), 0.0
        while self._coming and self._coming[0][0] < step + 1:
            at, command = self._coming.popleft()
            part = max(at - step, 0.0)
            mean += (part - done) * self._now
            self._now, done = command, part
        return np.asarray(mean + (1.0 - done) * self._now)

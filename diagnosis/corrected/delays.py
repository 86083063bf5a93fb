"""Delays of commands and encoders in a running simulation, step by step."""

from collections import deque

from diagnosis.replay.tape import hermite
from groundwalk.arrays import FloatArray


class LateCommands:
    """Delays commands; a physics step in which two act gets their weighted mean."""

    def __init__(self, delay_s: float, step_s: float) -> None:
        """Make room for commands on their way; `step_s` is the physics step."""
        steps, self._share = divmod(delay_s / step_s, 1)
        self._commands: deque[FloatArray] = deque(maxlen=int(steps) + 2)

    def begin(self, command_rad: FloatArray) -> None:
        """Start as if these (n, j) position targets had always been commanded."""
        for _ in range(self._commands.maxlen or 0):
            self._commands.append(command_rad)

    def step(self, command_rad: FloatArray) -> FloatArray:
        """Take a step's (n, j) command; return the delayed one that acts in it."""
        self._commands.append(command_rad)
        older, newer = self._commands[0], self._commands[1]
        return (1 - self._share) * newer + self._share * older


class LateEncoders:
    """Delays measured joint positions and velocities, interpolating between steps."""

    def __init__(self, delay_s: float, step_s: float) -> None:
        """Make room for past measurements; `step_s` is the physics step."""
        steps, self._share = divmod(delay_s / step_s, 1)
        self._step_s = step_s
        self._states: deque[tuple[FloatArray, FloatArray]] = deque(
            maxlen=int(steps) + 2
        )

    def begin(self, position_rad: FloatArray, velocity_rad_s: FloatArray) -> None:
        """Start as if joint positions and velocities (n, j) had always been these."""
        for _ in range(self._states.maxlen or 0):
            self.note(position_rad, velocity_rad_s)

    def note(self, position_rad: FloatArray, velocity_rad_s: FloatArray) -> None:
        """Store the true joint positions and velocities (n, j) after a physics step."""
        self._states.append((position_rad.copy(), velocity_rad_s.copy()))

    def seen(self) -> tuple[FloatArray, FloatArray]:
        """Late joint positions and velocities (n, j) that the encoders report now."""
        older, newer = self._states[0], self._states[1]
        return hermite(older, newer, self._step_s, 1 - self._share)

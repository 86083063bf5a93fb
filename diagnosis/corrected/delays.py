"""Signals that take their time, step by step as a sim runs."""

from collections import deque

from diagnosis.replay.tape import hermite
from groundwalk.arrays import FloatArray


class LateCommands:
    """Holds commands back; within a step they mix as long as each one holds."""

    def __init__(self, delay_s: float, step_s: float) -> None:
        """Prepare; `begin` fills it.

        Args:
          delay_s: between giving a command and its effect.
          step_s: of the physics.
        """
        steps, self._share = divmod(delay_s / step_s, 1)
        self._commands: deque[FloatArray] = deque(maxlen=int(steps) + 2)

    def begin(self, command_rad: FloatArray) -> None:
        """As if this command had been given for ever."""
        for _ in range(self._commands.maxlen or 0):
            self._commands.append(command_rad)

    def step(self, command_rad: FloatArray) -> FloatArray:
        """Give one step's command; returns what acts over this step on the mean."""
        self._commands.append(command_rad)
        older, newer = self._commands[0], self._commands[1]
        return (1 - self._share) * newer + self._share * older


class LateEncoders:
    """Shows positions and velocities of some time ago."""

    def __init__(self, delay_s: float, step_s: float) -> None:
        """Prepare; `begin` fills it.

        Args:
          delay_s: age of what is seen.
          step_s: of the physics.
        """
        steps, self._share = divmod(delay_s / step_s, 1)
        self._step_s = step_s
        self._states: deque[tuple[FloatArray, FloatArray]] = deque(
            maxlen=int(steps) + 2
        )

    def begin(self, position_rad: FloatArray, velocity_rad_s: FloatArray) -> None:
        """As if it had been like this for ever."""
        for _ in range(self._states.maxlen or 0):
            self.note(position_rad, velocity_rad_s)

    def note(self, position_rad: FloatArray, velocity_rad_s: FloatArray) -> None:
        """What is true after a step, until the next."""
        self._states.append((position_rad.copy(), velocity_rad_s.copy()))

    def seen(self) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities that the encoders show."""
        older, newer = self._states[0], self._states[1]
        return hermite(older, newer, self._step_s, 1 - self._share)

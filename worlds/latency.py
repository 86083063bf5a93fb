"""A queue that delays commands, to model the latency of a robot's motors."""

from collections import deque
from collections.abc import Iterator

from groundwalk.arrays import FloatArray


class DelayLine:
    """Delays commands by a number of physics steps, not necessarily whole ticks."""

    def __init__(self, latency_steps: int, steps_per_tick: int) -> None:
        """Delay by a number of physics steps; call `reset` before the first tick."""
        self._steps_per_tick = steps_per_tick
        self._ticks, self._late_steps = divmod(latency_steps, steps_per_tick)
        self._commands: deque[FloatArray] = deque(maxlen=self._ticks + 2)

    def reset(self, command: FloatArray) -> None:
        """Start as if `command` (n, joints) [rad] had been given at all past ticks."""
        self._commands.extend([command] * (self._ticks + 2))

    def tick(self, command: FloatArray) -> Iterator[tuple[FloatArray, int]]:
        """Take the command of one tick, and give the delayed ones that act in it.

        Each of the one or two comes with the number of physics steps for which it acts.
        """
        self._commands.append(command)
        older, newer = self._commands[0], self._commands[1]
        if self._late_steps:
            yield older, self._late_steps
        yield newer, self._steps_per_tick - self._late_steps

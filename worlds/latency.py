"""A delay between giving a command and its effect."""

from collections import deque
from collections.abc import Iterator

from groundwalk.arrays import FloatArray


class DelayLine:
    """Delays commands by a number of physics steps, which need not be whole ticks."""

    def __init__(self, latency_steps: int, steps_per_tick: int) -> None:
        """An empty line; `reset` fills it.

        Args:
          latency_steps: physics steps between giving a command and its effect.
          steps_per_tick: physics steps for which a command holds.
        """
        self._steps_per_tick = steps_per_tick
        self._ticks, self._late_steps = divmod(latency_steps, steps_per_tick)
        self._commands: deque[FloatArray] = deque(maxlen=self._ticks + 2)

    def reset(self, command: FloatArray) -> None:
        """Begin as if this command had always been given.

        Args:
          command: any array, for example (n, joints) targets.
        """
        self._commands.extend([command] * (self._ticks + 2))

    def tick(self, command: FloatArray) -> Iterator[tuple[FloatArray, int]]:
        """Give one tick's command.

        Yields:
          Each command that acts during this tick, and for how many physics steps.
        """
        self._commands.append(command)
        older, newer = self._commands[0], self._commands[1]
        if self._late_steps:
            yield older, self._late_steps
        yield newer, self._steps_per_tick - self._late_steps

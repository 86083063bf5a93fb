"""Replays: variants of a robot model driven by the commands of recordings."""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.variants import Variants
from diagnosis.replay.batch import ReplayBatch
from diagnosis.replay.drive import Drive
from diagnosis.replay.tape import Replayed, Tape
from diagnosis.traces.windows import Run

STEP_S = 0.002
"""Default time step of the physics in replays.

Example:
  >>> predicted = replay(runs, variants, step_s=STEP_S / 2)
"""

BLOCK = 256
"""Number of physics steps whose commands are computed at once, for speed; any value of
this order does."""


def replay(
    runs: Sequence[Run], variants: Variants, step_s: float = STEP_S, threads: int = 1
) -> list[Replayed]:
    """Simulate every variant of a robot model under the commands of every recording.

    Args:
      runs: R recordings or parts of them, each with its own start state.
      variants: n variants of the robot model.
      step_s: time step of the physics.
      threads: number of threads of the batch of simulations.

    Returns:
      For each run the predicted measurements of all variants.

    Example:
      >>> predicted = replay(runs, variants, threads=4)
      >>> position_rad = predicted[0].position_rad  # (n, rows, joints) of the first run
    """
    batch = ReplayBatch(runs, variants, step_s, threads)
    start_s = np.array([run.trace.time_s[0] for run in runs])
    longest_s = max(run.trace.duration_s for run in runs)
    steps = int(np.ceil((longest_s + 1e-9) / step_s))
    drive = Drive(runs, variants.signals.command_delay_s, step_s)
    tape = Tape(batch, steps)
    for first in range(0, steps, BLOCK):
        numbers = np.arange(first, min(first + BLOCK, steps))
        now_s = start_s + numbers[:, None] * step_s
        asked, pushed = drive.at(now_s)
        jumps = batch.laws.jumps(drive.ends(now_s))
        added = drive.added(now_s)
        for i in range(len(numbers)):
            if asked is not None:
                batch.laws.servo(asked[i], now_s[i], jumps[i])
            if pushed is not None:
                batch.laws.push_joints(pushed[i], now_s[i])
            if added is not None:
                batch.laws.add_to_joints(added[i])
            batch.laws.push_bodies(now_s[i])
            batch.step()
            tape.note(first + i + 1)
    return tape.read(runs, variants)

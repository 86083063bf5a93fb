"""Replays: predicted measurements of variants of a robot model, for recorded commands.

`replay` runs all variants through all recordings in one batch of MuJoCo simulations.
What effects do beyond MuJoCo's own physics is computed at every step: `servos`, `gaps`,
`elastic`, `friction`, `outside_forces`, joined in `laws`.
"""

from diagnosis.replay.replay import STEP_S, replay
from diagnosis.replay.tape import Replayed

__all__ = ["STEP_S", "Replayed", "replay"]

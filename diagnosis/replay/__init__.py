"""Replays: recorded commands simulated with variants of a robot model.

`replay` runs all variants through all recordings in one batch of MuJoCo simulations and
returns predicted measurements. At every step `laws` applies effects that MuJoCo lacks.
"""

from diagnosis.replay.replay import STEP_S, replay
from diagnosis.replay.tape import Replayed

__all__ = ["STEP_S", "Replayed", "replay"]

"""The deterministic world "sim": MuJoCo computes many robots in one batch.

Example:
  `worlds.make("sim", ...)` makes a `SimWorld`; see the beginning of `worlds`.
"""

from worlds.sim.world import SimWorld

__all__ = ["SimWorld"]

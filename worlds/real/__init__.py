"""The world "real": PyBullet computes the robots, spread over several processes.

Example:
  `worlds.make("real", ...)` makes a `RealWorld`; see the beginning of `worlds`.
"""

from worlds.real.world import RealWorld

__all__ = ["RealWorld"]

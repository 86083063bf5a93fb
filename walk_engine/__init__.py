"""The walk engine: turns gait parameters into joint commands, for n robots at once.

It never steps a world: it gets measurements and returns commands. Built-in gaits are in
`walk_engine.gaits`.

Example:
  >>> engine = WalkEngine(robots.biped(robots.get("nao")), [gaits.get("walk2014")])
  >>> command = engine.step(Velocity.forward(), gyroscope_rad_s, foot_force_n)
"""

from walk_engine.engine import WalkEngine
from walk_engine.gait import PARAMETERS, Gait, Parameter
from walk_engine.step_plan import Velocity
from walk_engine.walk_state import WalkState

__all__ = [
    "PARAMETERS",
    "Gait",
    "Parameter",
    "Velocity",
    "WalkEngine",
    "WalkState",
]

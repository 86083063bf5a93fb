"""Gait parameters to joint commands, for n robots at once; never steps a world.

engine = WalkEngine(biped, [gaits.get("walk2014")])
command = engine.step(Velocity.forward(), gyroscope_rad_s, foot_force_n)
"""

from walk_engine.engine import WalkEngine
from walk_engine.engine_config import EngineConfig
from walk_engine.gait import PARAMETERS, Gait, Parameter
from walk_engine.velocity import Velocity
from walk_engine.walk_state import WalkState

__all__ = [
    "PARAMETERS",
    "EngineConfig",
    "Gait",
    "Parameter",
    "Velocity",
    "WalkEngine",
    "WalkState",
]

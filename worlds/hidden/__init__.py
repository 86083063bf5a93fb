"""Hidden physics: what a simulated robot has and its published, nominal model lacks.

Recordings of such robots test a diagnosis, since the missing physics is known exactly.

Example:
  >>> from worlds.hidden import Hidden, hidden_plant
  >>> Hidden.parse("coulomb_friction@swing:torque=0.1")["torque"]
  0.1
  >>> hidden_plant("pendulum").joints
  ('swing',)
"""

from worlds.hidden.effects import KINDS, Hidden, surroundings
from worlds.hidden.plant import HiddenPlant, hidden_plant
from worlds.hidden.setting import Scales, Setting, Spot

__all__ = [
    "KINDS",
    "Hidden",
    "HiddenPlant",
    "Scales",
    "Setting",
    "Spot",
    "hidden_plant",
    "surroundings",
]

"""Ground as data: families of terrain, and the heightfields that they make.

This package knows no robots and no physics engines. A terrain has a name, parameters
and a seed; `make` turns the same three always into the same `Heightfield`.

Example:
  >>> import terrain
  >>> ground = terrain.make("lumps", 7, amplitude_m=0.012)
  >>> ground.heights_m.shape
  (161, 241)
"""

from terrain.bumps import Bumps
from terrain.catalog import configuration, make, names
from terrain.flat import Flat
from terrain.ground import Ground
from terrain.heightfield import Heightfield
from terrain.lumps import Lumps
from terrain.slope import Slope
from terrain.spec import TerrainSpec
from terrain.stairs import Stairs
from terrain.text_form import parse
from terrain.waves import Waves

__all__ = [
    "Bumps",
    "Flat",
    "Ground",
    "Heightfield",
    "Lumps",
    "Slope",
    "Stairs",
    "TerrainSpec",
    "Waves",
    "configuration",
    "make",
    "names",
    "parse",
]

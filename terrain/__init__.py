"""Ground as data: families of terrain, and the heightfields that they make.

This package knows no robots and no physics engines. A terrain has a name, parameters
and a seed; `make` turns the same three always into the same `Heightfield`.

Example:
  >>> import terrain
  >>> ground = terrain.make("lumps", 7, amplitude_m=0.012)
  >>> ground.heights_m.shape
  (161, 241)
"""

from terrain.catalog import TerrainSpec, configuration, make, names, parse
from terrain.families import Flat, Lumps
from terrain.heightfield import Heightfield

__all__ = [
    "Flat",
    "Heightfield",
    "Lumps",
    "TerrainSpec",
    "configuration",
    "make",
    "names",
    "parse",
]

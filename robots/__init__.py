"""Robots as data: descriptions, and MuJoCo and PyBullet models of them.

Example:
  >>> import robots
  >>> nao = robots.get("nao")
  >>> len(nao.joints), robots.biped(nao).leg.thigh_m
  (20, 0.1)
"""

from robots.biped import biped
from robots.catalog import get, names
from robots.description import Description
from robots.leg_geometry import Biped, LegGeometry

__all__ = ["Biped", "Description", "LegGeometry", "biped", "get", "names"]

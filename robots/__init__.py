"""What a robot is: its description, and the two engines' models made from it."""

from robots.biped import biped
from robots.catalog import get, names
from robots.description import Description
from robots.leg_geometry import Biped, LegGeometry

__all__ = ["Biped", "Description", "LegGeometry", "biped", "get", "names"]

"""The plant: the nominal robot model with servos that a diagnosis simulates.

`load_plant` makes a plant from a robot's name, an MJCF or a URDF.
"""

from diagnosis.plant.load import described_plant, load_plant
from diagnosis.plant.plant import Base, Plant
from diagnosis.plant.servo import Servo

__all__ = ["Base", "Plant", "Servo", "described_plant", "load_plant"]

"""Robots on terrain under physics: sim (MuJoCo), real (PyBullet), and recordings.

Both worlds, "sim" and "real", have the interface `World`: n robots are stepped together
by joint commands. Whole programs are in docs/python.md.

Example:
  >>> import numpy as np, robots, terrain, worlds
  >>> seeds = np.random.SeedSequence(1).spawn(1)
  >>> world = worlds.make("sim", robots.get("nao"), [terrain.make("flat", 0)], seeds)
  >>> observation = world.reset(np.zeros((1, 20)))
  >>> observation.position_rad.shape
  (1, 20)
"""

from worlds.catalog import WORLDS, kind, make
from worlds.observation import Observation, Truth
from worlds.recordings.files import read_recording, write_recording
from worlds.recordings.load import Load
from worlds.recordings.metadata import RecordingMetadata, ServoGains
from worlds.recordings.recording import Recording
from worlds.sensor_noise import SensorNoise
from worlds.world import FALLS, TICK_S, End, World, WorldOptions

__all__ = [
    "FALLS",
    "TICK_S",
    "WORLDS",
    "End",
    "Load",
    "Observation",
    "Recording",
    "RecordingMetadata",
    "SensorNoise",
    "ServoGains",
    "Truth",
    "World",
    "WorldOptions",
    "kind",
    "make",
    "read_recording",
    "write_recording",
]

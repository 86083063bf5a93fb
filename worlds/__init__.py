"""Robots on terrain under physics: sim (MuJoCo) and real (PyBullet), and recordings."""

from worlds.catalog import WORLDS, kind, make
from worlds.observation import Observation, Truth
from worlds.recordings.files import read_recording, write_recording
from worlds.recordings.metadata import RecordingMetadata, ServoGains
from worlds.recordings.recording import Recording
from worlds.sensor_noise import SensorNoise
from worlds.world import FALLS, TICK_S, End, World, WorldOptions

__all__ = [
    "FALLS",
    "TICK_S",
    "WORLDS",
    "End",
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

"""Robots on terrain under physics: sim (MuJoCo) and real (PyBullet), and recordings."""

from worlds.catalog import WORLDS, kind, make
from worlds.observation import Observation, Truth
from worlds.recording import Recording
from worlds.recording_files import read_recording, write_recording
from worlds.recording_metadata import RecordingMetadata, ServoGains
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

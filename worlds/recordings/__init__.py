"""Recordings of rollouts, in memory and in Parquet or CSV files.

Example:
  >>> from pathlib import Path
  >>> from worlds.recordings import read_recording
  >>> recording = read_recording(Path("runs/walk/recordings/sim_tuned.parquet"))
  >>> recording.joint_values("position", ["LKneePitch"]).shape == (recording.ticks, 1)
  True
"""

from worlds.recordings.files import read_recording, write_recording
from worlds.recordings.metadata import RecordingMetadata, ServoGains
from worlds.recordings.recording import Recording

__all__ = [
    "Recording",
    "RecordingMetadata",
    "ServoGains",
    "read_recording",
    "write_recording",
]

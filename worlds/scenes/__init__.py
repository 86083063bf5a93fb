"""Scenes, which are recordings with robot and ground, and pictures drawn by NumPy.

Example:
  >>> import robots, terrain
  >>> from pathlib import Path
  >>> from worlds.recordings import read_recording
  >>> from worlds.scenes import Scene, SceneCamera
  >>> recording = read_recording(Path("runs/walk/recordings/sim_tuned.parquet"))
  >>> scene = Scene("sim", recording, robots.get("nao"), terrain.make("flat", 0))
  >>> SceneCamera(scene, (38, 110, 214), (320, 240)).picture(tick=100).shape
  (240, 320, 3)
"""

from worlds.scenes.picture import SceneCamera
from worlds.scenes.scene import Scene

__all__ = ["Scene", "SceneCamera"]

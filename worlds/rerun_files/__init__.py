"""Writes scenes (recordings with robot and ground) as files for Rerun's viewer.

Example:
  >>> from pathlib import Path
  >>> from worlds.rerun_files import open_viewer, write_rrd
  >>> write_rrd(Path("walk.rrd"), [scene])  # scenes: see `worlds.scenes`
  >>> viewer = open_viewer([Path("walk.rrd")])
"""

from worlds.rerun_files.log import write_rrd
from worlds.rerun_files.viewer import open_viewer

__all__ = ["open_viewer", "write_rrd"]

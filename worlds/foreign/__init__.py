"""Files that robots and other programs write, read as recordings of format 1.

One module a format: tables of any program (`mapping`), ROS 2 bags (`bag_recording`),
LeRobot's data sets (`lerobot`), logs of BAM (`bam`) and data of PACE (`pace`).

Example:
  >>> from pathlib import Path
  >>> from worlds.foreign import read_bag
  >>> read_bag(Path("arm.db3")).joints
"""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from worlds.foreign.bag_recording import BagOptions, read_bag
    from worlds.foreign.bam import read_bam
    from worlds.foreign.kinds import Kind, kind_of, sources_in
    from worlds.foreign.lerobot import LeRobotOptions, read_lerobot
    from worlds.foreign.mapping import Entry, plan
    from worlds.foreign.pace import read_pace
    from worlds.foreign.recording import ForeignRecording
    from worlds.foreign.tables import ForeignTable, read_table

__all__ = [
    "BagOptions",
    "Entry",
    "ForeignRecording",
    "ForeignTable",
    "Kind",
    "LeRobotOptions",
    "kind_of",
    "plan",
    "read_bag",
    "read_bam",
    "read_lerobot",
    "read_pace",
    "read_table",
    "sources_in",
]

__getattr__ = lazy_face(
    __name__,
    {
        "bag_recording": ["BagOptions", "read_bag"],
        "bam": ["read_bam"],
        "kinds": ["Kind", "kind_of", "sources_in"],
        "lerobot": ["LeRobotOptions", "read_lerobot"],
        "mapping": ["Entry", "plan"],
        "pace": ["read_pace"],
        "recording": ["ForeignRecording"],
        "tables": ["ForeignTable", "read_table"],
    },
)

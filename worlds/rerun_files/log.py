"""Writes recordings as Rerun files: robots, ground and curves.

All paths of a scene begin with its name, so that one file can have several scenes;
docs/seeing.md lists the entities. A file may also hold further curves, each at a path
of its own.

Timelines are `sim_time`, the recording's time, and `tick`, its row. An entity has no
value at a row in which one is missing. The recording's metadata are properties of the
file, under the scene's name.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from groundwalk.files import write_bytes
from worlds.scenes import colours
from worlds.scenes.curves import Curve
from worlds.scenes.lanes import Lane
from worlds.scenes.scene import Scene, check_beside, content_id


def write_rrd(
    path: Path,
    scenes: Sequence[Scene],
    recording_id: str | None = None,
    pages: Mapping[str, Sequence[Curve]] | None = None,
    lanes: Mapping[str, Sequence[Lane]] | None = None,
) -> None:
    """Write recordings side by side into one Rerun file, atomically.

    Args:
      path: the `.rrd` file.
      scenes: recordings with robot and ground, from left to right; may be empty.
      recording_id: the viewer shows files with equal ids as one recording; None for a
        hash of the scenes.
      pages: further curves by the name of their tab. They are below the robots, two in
        a row, instead of the scenes' own curves.
      lanes: states over time that are shown above the curves of a page, by its name.

    Example:
      >>> write_rrd(Path("walk.rrd"), [Scene("sim", recording, robots.get("nao"))])
    """
    # Here, because Rerun takes a second to load.
    import rerun as rr

    from worlds.rerun_files.layout import blueprint
    from worlds.rerun_files.scene_log import (
        ColumnLog,
        tick_times,
        write_lane,
        write_scene,
    )

    pages, lanes = pages or {}, lanes or {}
    if scenes or not pages:
        check_beside(scenes)
    identity = recording_id or content_id(scenes)
    stream = rr.RecordingStream("groundwalk", recording_id=identity)
    file = stream.memory_recording()
    stream.send_blueprint(blueprint(scenes, pages, lanes))
    stream.send_recording_name(path.stem)
    stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for index, scene in enumerate(scenes):
        write_scene(stream, scene, colours.accent(index))
    for curve in (curve for page in pages.values() for curve in page):
        ColumnLog(stream, "", tick_times(curve.time_s)).trace(curve.trace)
    for lane in {own.path: own for page in lanes.values() for own in page}.values():
        write_lane(stream, lane)
    write_bytes(path, file.drain_as_bytes())

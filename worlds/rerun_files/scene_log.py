"""Writes one scene, with robot, ground and curves, into a Rerun stream."""

import numpy as np
import rerun as rr

from robots.description import Link
from worlds.recordings.columns import SUPPORT
from worlds.rerun_files.balance import support_look, write_balance
from worlds.rerun_files.columns import ColumnLog, tick_times
from worlds.rerun_files.meshes import link_mesh
from worlds.scenes import colours
from worlds.scenes.curves import support_changes, traces
from worlds.scenes.scene import SIDES, Scene
from worlds.scenes.shapes import capsules, ground_mesh, sole_mesh, sole_rim
from worlds.world import End

_ARROW_RADIUS_M, _RIM_RADIUS_M = 0.006, 0.0015


def write_scene(
    stream: rr.RecordingStream, scene: Scene, accent: colours.Colour
) -> None:
    """Write a scene; `accent` is the colour that marks its robot."""
    stream.send_property(scene.name, rr.AnyValues(**scene.properties))
    log = ColumnLog(stream, f"{scene.name}/", tick_times(scene.recording.time_s))
    if scene.ground is not None:
        log.log("ground", rr.Mesh3D(**ground_mesh(scene.ground)._asdict()))
    _write_robot(log, scene, accent)
    _write_feet(log, scene, accent)
    _write_states(log, scene)
    for trace in traces(scene):
        log.trace(trace)
    if scene.description.feet:
        write_balance(log, scene)


def _write_robot(log: ColumnLog, scene: Scene, accent: colours.Colour) -> None:
    robot = scene.description
    for link in (robot.root, *(joint.link for joint in robot.links)):
        _write_look(log, link, accent)
    for name, pose in scene.link_poses().items():
        log.send(
            f"robot/{name}",
            rr.Transform3D,
            translation=pose.position_m,
            quaternion=np.roll(pose.orientation, -1, axis=1),
        )


def _write_look(log: ColumnLog, link: Link, accent: colours.Colour) -> None:
    mesh = link_mesh(link, colours.pale(accent))
    if mesh is not None:
        log.log(f"robot/{link.name}", rr.Mesh3D(**mesh._asdict()))
    elif link.shapes:
        arrays = capsules(link.shapes, accent)._asdict()
        log.log(f"robot/{link.name}", rr.Capsules3D(**arrays, fill_mode="solid"))


def _write_feet(log: ColumnLog, scene: Scene, accent: colours.Colour) -> None:
    robot = scene.description
    for side, foot in zip(SIDES, robot.feet, strict=False):
        link = f"robot/{robot.links[foot.joint].link.name}"
        log.log(f"{link}/sole", rr.Mesh3D(**sole_mesh(foot, accent)._asdict()))
        rim = rr.LineStrips3D([sole_rim(foot)], radii=_RIM_RADIUS_M, colors=accent)
        log.log(f"{link}/rim", rim)
        forces = scene.sensor_forces_n(side)
        if forces is None:
            continue
        points_m, forces_n = forces
        upward_m = np.array([0.0, 0.0, scene.arrow_m_per_n])
        look = rr.Arrows3D.from_fields(
            origins=points_m, radii=_ARROW_RADIUS_M, colors=colours.FORCE
        )
        log.log(f"{link}/force", look)
        vectors = forces_n[:, :, np.newaxis] * upward_m
        log.send(f"{link}/force", rr.Arrows3D, vectors=vectors)


def _write_states(log: ColumnLog, scene: Scene) -> None:
    rows, legs = support_changes(scene)
    if legs:
        log.log(SUPPORT, support_look())
        log.send_rows(SUPPORT, rr.StateChange.columns(state=legs), rows)
    end = scene.recording.metadata.end
    if end:
        level = "WARN" if end in tuple(End) else "INFO"
        text = rr.TextLog.columns(text=[end], level=[level])
        log.send_rows("events", text, np.array([scene.recording.ticks - 1]))

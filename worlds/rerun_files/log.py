"""Writes recordings as Rerun files: robots, ground and curves.

All paths of a scene begin with its name, so that one file can have several scenes:

| entity | content |
|---|---|
| `<scene>/robot/<link>` | mesh or capsules, and pose of the link in the world |
| `<scene>/robot/<foot>/{sole,rim,force}` | plate, its edge, arrows of forces |
| `<scene>/ground` | the heightfield's triangles |
| `<scene>/joints/<joint>/{position,velocity,command,...}` | as recorded |
| `<scene>/contact/{left,right}` | force on each foot [N] |
| `<scene>/imu/{gyroscope,accelerometer}` | x, y, z [rad/s, m/s^2] |
| `<scene>/support` | leg on which the gait means to stand: left, right or both |
| `<scene>/events` | why the rollout ended |
| `<scene>/{balance,fall}`, `<scene>/contact/support` | see `rerun_files.balance` |

A file may also hold further curves, each at a path of its own.

Timelines are `sim_time`, the recording's time, and `tick`, its row. An entity has no
value at a row in which one is missing. The recording's metadata are properties of the
file, under the scene's name.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.files import write_bytes
from robots.description import Link
from worlds.recordings.columns import SUPPORT
from worlds.rerun_files.balance import support_look, write_balance
from worlds.rerun_files.columns import ColumnLog
from worlds.rerun_files.layout import blueprint
from worlds.rerun_files.meshes import link_mesh
from worlds.scenes import colours
from worlds.scenes.curves import Curve, support_changes, traces
from worlds.scenes.scene import SIDES, Scene, check_beside, content_id
from worlds.scenes.shapes import capsules, ground_mesh, sole_mesh, sole_rim
from worlds.world import End

if TYPE_CHECKING:
    import rerun as rr

_ARROW_RADIUS_M, _RIM_RADIUS_M = 0.006, 0.0015
_FAILURES = tuple(End)


def write_rrd(
    path: Path,
    scenes: Sequence[Scene],
    recording_id: str | None = None,
    pages: Mapping[str, Sequence[Curve]] | None = None,
) -> None:
    """Write recordings side by side into one Rerun file, atomically.

    Args:
      path: the `.rrd` file.
      scenes: recordings with robot and ground, from left to right; may be empty.
      recording_id: the viewer shows files with equal ids as one recording; None for a
        hash of the scenes.
      pages: further curves by the name of their tab. They are below the robots, two in
        a row, instead of the scenes' own curves.

    Raises:
      BadValueError: there are neither scenes nor pages, or a scene has the name of
        another one or a name that is the first part of another one's path.

    Example:
      >>> write_rrd(Path("walk.rrd"), [Scene("sim", recording, robots.get("nao"))])
    """
    import rerun as rr

    pages = pages or {}
    if scenes or not pages:
        check_beside(scenes)
    identity = recording_id or content_id(scenes)
    stream = rr.RecordingStream("groundwalk", recording_id=identity)
    file = stream.memory_recording()
    stream.send_blueprint(blueprint(scenes, pages))
    stream.send_recording_name(path.stem)
    stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for index, scene in enumerate(scenes):
        _SceneLog(stream, scene, colours.accent(index)).write()
    for curve in (curve for page in pages.values() for curve in page):
        ColumnLog(stream, "", curve.time_s).trace(curve.trace)
    write_bytes(path, file.drain_as_bytes())


class _SceneLog(ColumnLog):
    """Writes one scene, with robot, ground and curves, into a Rerun stream."""

    def __init__(
        self, stream: "rr.RecordingStream", scene: Scene, accent: colours.Colour
    ) -> None:
        super().__init__(stream, f"{scene.name}/", scene.recording.time_s)
        self._scene = scene
        self._accent = accent

    def write(self) -> None:
        import rerun as rr

        properties = rr.AnyValues(**self._scene.properties)
        self._stream.send_property(self._scene.name, properties)
        if self._scene.ground is not None:
            ground = ground_mesh(self._scene.ground)
            self.log("ground", rr.Mesh3D(**ground._asdict()))
        self._write_robot()
        self._write_feet()
        self._write_states()
        for trace in traces(self._scene):
            self.trace(trace)
        if self._scene.description.feet:
            write_balance(self, self._scene)

    def _write_robot(self) -> None:
        import rerun as rr

        robot = self._scene.description
        for link in (robot.root, *(joint.link for joint in robot.links)):
            self._write_look(link)
        for name, pose in self._scene.link_poses().items():
            self.send(
                f"robot/{name}",
                rr.Transform3D,
                translation=pose.position_m,
                quaternion=np.roll(pose.orientation, -1, axis=1),
            )

    def _write_look(self, link: Link) -> None:
        import rerun as rr

        entity = f"robot/{link.name}"
        mesh = link_mesh(link, colours.pale(self._accent))
        if mesh is not None:
            self.log(entity, rr.Mesh3D(**mesh._asdict()))
        elif link.shapes:
            arrays = capsules(link.shapes, self._accent)._asdict()
            self.log(entity, rr.Capsules3D(**arrays, fill_mode="solid"))

    def _write_feet(self) -> None:
        import rerun as rr

        robot = self._scene.description
        for side, foot in zip(SIDES, robot.feet, strict=False):
            link = f"robot/{robot.links[foot.joint].link.name}"
            sole = sole_mesh(foot, self._accent)
            self.log(f"{link}/sole", rr.Mesh3D(**sole._asdict()))
            rim = rr.LineStrips3D(
                [sole_rim(foot)], radii=_RIM_RADIUS_M, colors=self._accent
            )
            self.log(f"{link}/rim", rim)
            forces = self._scene.sensor_forces_n(side)
            if forces is None:
                continue
            points_m, forces_n = forces
            arrows_m = forces_n[:, :, np.newaxis] * (
                0.0,
                0.0,
                self._scene.arrow_m_per_n,
            )
            look = rr.Arrows3D.from_fields(
                origins=points_m, radii=_ARROW_RADIUS_M, colors=colours.FORCE
            )
            self.log(f"{link}/force", look)
            self.send(f"{link}/force", rr.Arrows3D, vectors=arrows_m)

    def _write_states(self) -> None:
        import rerun as rr

        rows, legs = support_changes(self._scene)
        if legs:
            self.log(SUPPORT, support_look())
            self.send_rows(SUPPORT, rows, rr.StateChange.columns(state=legs))
        end = self._scene.recording.metadata.end
        if end:
            last = np.array([self._time.size - 1])
            level = "WARN" if end in _FAILURES else "INFO"
            text = rr.TextLog.columns(text=[end], level=[level])
            self.send_rows("events", last, text)

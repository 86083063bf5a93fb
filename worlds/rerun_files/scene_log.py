"""Writes one scene, with robot, ground and curves, into a Rerun stream.

Columns of values over timelines are written by `ColumnLog`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import rerun as rr

from groundwalk.arrays import FloatArray, IntArray
from robots.description import Link
from worlds.recordings.recording import SUPPORT
from worlds.rerun_files.meshes import link_mesh
from worlds.scenes import colours
from worlds.scenes.balance import Balance, balance, loaded_feet
from worlds.scenes.curves import (
    MEASURED_SUPPORT,
    SIDEWAYS,
    Trace,
    support_changes,
    traces,
)
from worlds.scenes.lanes import Lane
from worlds.scenes.scene import SIDES, Scene
from worlds.scenes.shapes import capsules, fall_ring, ground_mesh, sole_mesh, sole_rim
from worlds.world import FALLS, End


def tick_times(time_s: FloatArray) -> dict[str, npt.NDArray[Any]]:
    """Rerun's timelines (ticks,) of a recording: `sim_time`, and `tick`, from 0."""
    # Rounded, because Rerun cuts off fractions of a nanosecond.
    nanoseconds = np.rint(time_s * 1e9).astype("timedelta64[ns]")
    return {"sim_time": nanoseconds, "tick": np.arange(time_s.size)}


class ColumnLog:
    """Writes values that share their times, as Rerun entities below one path."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        at: str,
        timelines: Mapping[str, npt.NDArray[Any]],
    ) -> None:
        """Write into a Rerun stream, at paths that begin with `at`.

        Of each timeline, there are (ticks,) times: durations or whole numbers.
        """
        self._stream, self._at, self._timelines = stream, at, timelines
        self._all = np.arange(len(next(iter(timelines.values()))))

    def log(self, path: str, what: rr.AsComponents) -> None:
        """Write something that does not change over time to the entity `path`."""
        self._stream.log(f"{self._at}{path}", what, static=True, strict=True)

    def trace(self, trace: Trace) -> None:
        """Write lines over time, with their names and colours."""
        self.log(trace.path, rr.SeriesLines(names=trace.names, colors=trace.lines))
        self.send(trace.path, rr.Scalars, scalars=trace.values)

    def send(self, path: str, kind: Any, **columns: FloatArray) -> None:
        """Write fields (ticks, ...) of the Rerun archetype `kind`, over time.

        Rows in which a value is NaN are left out.
        """
        parts = [values.reshape(self._all.size, -1) for values in columns.values()]
        rows = np.flatnonzero(~np.isnan(np.hstack(parts)).any(axis=1))
        known = {name: values[rows] for name, values in columns.items()}
        if rows.size:
            self.send_rows(path, kind.columns(**known), rows)

    def show(self, path: str, look: Any, columns: Any, rows: Any = None) -> None:
        """Write columns of a Rerun archetype at `rows`, and its constant `look`."""
        self.log(path, look)
        self.send_rows(path, columns, rows)

    def send_rows(self, path: str, columns: Any, rows: IntArray | None = None) -> None:
        """Write columns of a Rerun archetype at times numbered `rows` (k,), or all."""
        rows = self._all if rows is None else rows
        indexes = [
            rr.TimeColumn(name, duration=times[rows])
            if times.dtype.kind == "m"
            else rr.TimeColumn(name, sequence=times[rows])
            for name, times in self._timelines.items()
        ]
        self._stream.send_columns(f"{self._at}{path}", indexes, columns, strict=True)


def write_lane(stream: rr.RecordingStream, lane: Lane) -> None:
    """Write the states of a lane over the recording's time."""
    times_s = np.array([time_s for time_s, _ in lane.changes])
    at = rr.TimeColumn("sim_time", duration=tick_times(times_s)["sim_time"])
    states = rr.StateChange.columns(state=[state for _, state in lane.changes])
    stream.send_columns(lane.path, [at], states, strict=True)


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
    _write_support(log, SUPPORT, *support_changes(scene))
    end = scene.recording.metadata.end
    if end:
        level = "WARN" if end in tuple(End) else "INFO"
        text = rr.TextLog.columns(text=[end], level=[level])
        log.send_rows("events", text, np.array([scene.recording.ticks - 1]))


_LIFT_M = 0.002
"""Height of marks above the ground [m], so that the ground does not hide them."""
_POINT_M, _LINE_M = 0.008, 0.003


def write_balance(log: ColumnLog, scene: Scene) -> None:
    """Write the balance of a scene's robot, and where it fell if it did."""
    found = balance(scene)
    _write_points(log, found, scene.recording.has("base.position"))
    if found.polygons_m is not None:
        _write_polygons(log, found.polygons_m)
    _write_support(log, MEASURED_SUPPORT, *_measured_support(scene))
    _write_fall(log, scene, found)


def _write_points(log: ColumnLog, found: Balance, is_placed: bool) -> None:
    points = {
        "centre_of_mass": (found.centre_of_mass_m, colours.MASS),
        "below": (found.below_m, colours.MASS),
        "pressure": (found.pressure_m, colours.FORCE),
        "zmp": (found.zmp_m, colours.ZMP),
    }
    for name, (place_m, colour) in points.items():
        if place_m is not None:
            look = rr.Points3D.from_fields(
                radii=_POINT_M, colors=colour, labels=[name], show_labels=False
            )
            lift_m = np.array([0.0, 0.0, 0.0 if name == "centre_of_mass" else _LIFT_M])
            # At a tick without the point show nothing, not the last known point.
            known = np.isfinite(place_m[:, 0])
            columns = rr.Points3D.columns(positions=(place_m + lift_m)[known])
            shown = columns.partition(known.astype(int))
            log.show(f"balance/{name}", look, shown)
            if is_placed and name != "below":
                trace = [name.replace("_", " ")], place_m[:, 1], [colour]
                log.trace(Trace(f"{SIDEWAYS}/{name}", *trace))
    is_known = np.isfinite(found.centre_of_mass_m).all(axis=1)
    track = rr.LineStrips3D(
        [found.centre_of_mass_m[is_known]], radii=_LINE_M / 2, colors=colours.MASS
    )
    log.log("balance/centre_of_mass/track", track)


def _write_polygons(log: ColumnLog, polygons_m: list[FloatArray]) -> None:
    look = rr.LineStrips3D.from_fields(radii=_LINE_M, colors=colours.SUPPORT_POLYGON)
    lift_m = np.array([0.0, 0.0, _LIFT_M])
    strips = [np.vstack([corners, corners[:1]]) + lift_m for corners in polygons_m]
    log.show("balance/polygon", look, rr.LineStrips3D.columns(strips=strips))


def _write_support(log: ColumnLog, path: str, rows: IntArray, legs: list[str]) -> None:
    """Write the supporting legs ("left", "right", "both", "none") from some rows on."""
    if legs:
        lanes = {**colours.SIDES, "both": colours.NEITHER_SIDE, "none": colours.FALL}
        look = rr.StateConfiguration(values=[*lanes], colors=[*lanes.values()])
        log.show(path, look, rr.StateChange.columns(state=legs), rows)


def _measured_support(scene: Scene) -> tuple[IntArray, list[str]]:
    """Rows where the loaded feet change, and the new: left, right, both or none."""
    loaded = loaded_feet(scene)
    if loaded is None:
        return np.empty(0, np.intp), []
    code = loaded["left"] + 2 * loaded["right"]
    rows = np.flatnonzero(np.diff(code, prepend=-1) != 0)
    return rows, [("none", "left", "right", "both")[k] for k in code[rows]]


def _write_fall(log: ColumnLog, scene: Scene, found: Balance) -> None:
    """Write a ring where the robot fell, shown from the start of the recording."""
    end = scene.recording.metadata.end
    place_m = found.below_m[-1]
    if end not in FALLS or not np.isfinite(place_m).all():
        return
    strip_m = fall_ring(place_m, scene.ground)
    text = f"{end} at {scene.recording.time_s[-1]:.2f} s"
    look = rr.LineStrips3D(
        [strip_m], radii=1.5 * _LINE_M, colors=colours.FALL, labels=[text]
    )
    log.log("fall", look)

"""Writes walks of a search's best gaits to Rerun: robots in poses along each walk.

| entity | content |
|---|---|
| `search/walk/robot/<link>` | mesh, in several poses, from start to end of the walk |
| `search/walk/robot/<foot>/sole` | the sole's plate, in the same poses |
| `search/walk/track` | path of the centre of mass |
| `search/walk/fall` | a ring on the ground where the robot fell, if it did |
| `search/walk/ground` | the ground under the walks, with a margin |
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from groundwalk.arrays import FloatArray, IntArray
from robots.description import Link
from terrain import Heightfield
from worlds.rerun_files.meshes import capsule_mesh, link_mesh
from worlds.rerun_files.scene_log import ColumnLog
from worlds.rerun_files.search_history import SearchWalk
from worlds.scenes import colours
from worlds.scenes.balance import balance
from worlds.scenes.shapes import Mesh, fall_ring, ground_mesh, sole_mesh

AT = "search/walk"
POSES = 7
"""Number of poses drawn of one walk, at even times from the first to the last tick."""

_BESIDE_M = 0.35
"""Width of the ground drawn beyond the places that any joint reaches [m]."""

_TRACK_M, _RING_M = 0.003, 0.0045


def write_walks(
    stream: rr.RecordingStream,
    walks: Sequence[SearchWalk],
    timeline: str,
    colour: colours.Colour,
) -> None:
    """Write walks of one robot: its poses, paths and ground.

    The walks, at least one, are numbered from 0 on the timeline; their grounds are on
    the same grid, or none has one. `colour` marks the robot.
    """
    stream.log(AT, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True, strict=True)
    log = ColumnLog(stream, f"{AT}/", {timeline: np.arange(len(walks))})
    _write_robot(log, walks, colour)
    _write_tracks(log, walks)
    _write_ground(log, walks)


def stills(ticks: int) -> IntArray:
    """At most `POSES` row indices (k,), evenly spaced over a recording of `ticks`."""
    return np.unique(np.rint(np.linspace(0, ticks - 1, POSES)).astype(np.intp))


def _write_robot(
    log: ColumnLog, walks: Sequence[SearchWalk], colour: colours.Colour
) -> None:
    robot = walks[0].scene.description
    poses = _still_poses(walks)
    for link in (robot.root, *(joint.link for joint in robot.links)):
        mesh = _look(link, colour)
        if mesh is not None:
            look = rr.Mesh3D(**mesh._asdict())
            log.show(f"robot/{link.name}", look, poses[link.name])
    for foot in robot.feet:
        link = robot.links[foot.joint].link
        sole = rr.Mesh3D(**sole_mesh(foot, colour)._asdict())
        log.show(f"robot/{link.name}/sole", sole, poses[link.name])


def _look(link: Link, colour: colours.Colour) -> Mesh | None:
    mesh = link_mesh(link, colours.pale(colour))
    if mesh is None and link.shapes:
        return capsule_mesh(link.shapes, colour)
    return mesh


def _still_poses(walks: Sequence[SearchWalk]) -> dict[str, Any]:
    """Rerun columns of poses by link name; a walk's row has several poses."""
    rows = [stills(walk.scene.recording.ticks) for walk in walks]
    whole = [walk.scene.link_poses() for walk in walks]
    columns = {}
    for name in whole[0]:
        poses = [one[name] for one in whole]
        places = [pose.position_m[row] for pose, row in zip(poses, rows, strict=True)]
        turns = [pose.orientation[row] for pose, row in zip(poses, rows, strict=True)]
        columns[name] = rr.InstancePoses3D.columns(
            translations=np.vstack(places),
            quaternions=np.roll(np.vstack(turns), -1, axis=1),
        ).partition(list(map(len, rows)))
    return columns


def _write_tracks(log: ColumnLog, walks: Sequence[SearchWalk]) -> None:
    """Write the paths of the centre of mass, and rings where robots fell."""
    found = [balance(walk.scene) for walk in walks]
    tracks_m = [one.centre_of_mass_m for one in found]
    look = rr.LineStrips3D.from_fields(radii=_TRACK_M, colors=colours.MASS)
    log.show("track", look, rr.LineStrips3D.columns(strips=tracks_m))
    fell = [walk.fell for walk in walks]
    if not any(fell):
        return
    rings_m, texts = [], []
    for walk, one in zip(walks, found, strict=True):
        if walk.fell:
            rings_m.append(fall_ring(one.below_m[-1], walk.scene.ground))
            end = walk.scene.recording.metadata.end
            texts.append(f"{end} at {walk.time_s:.2f} s")
    look = rr.LineStrips3D.from_fields(radii=_RING_M, colors=colours.FALL)
    columns = rr.LineStrips3D.columns(strips=rings_m, labels=texts)
    # A walk without a fall removes the ring of the walk before.
    log.show("fall", look, columns.partition(np.array(fell, int)))


def _write_ground(log: ColumnLog, walks: Sequence[SearchWalk]) -> None:
    """Write the ground of each walk, or only one if all grounds are equal."""
    around_m = _reached(walks) + np.array([[-_BESIDE_M], [_BESIDE_M]])
    grounds = [
        _cropped(walk.scene.ground, around_m)
        for walk in walks
        if walk.scene.ground is not None
    ]
    if len(grounds) < len(walks):
        return
    meshes = [ground_mesh(ground) for ground in grounds]
    first_m = grounds[0].heights_m
    if all(np.array_equal(first_m, ground.heights_m) for ground in grounds):
        log.log("ground", rr.Mesh3D(**meshes[0]._asdict()))
        return
    look = rr.Mesh3D.from_fields(
        triangle_indices=meshes[0].triangle_indices,
        vertex_colors=meshes[0].vertex_colors,
    )
    columns = rr.Mesh3D.columns(
        vertex_positions=np.vstack([mesh.vertex_positions for mesh in meshes]),
        vertex_normals=np.vstack([mesh.vertex_normals for mesh in meshes]),
    )
    sizes = [ground.heights_m.size for ground in grounds]
    log.show("ground", look, columns.partition(sizes))


def _reached(walks: Sequence[SearchWalk]) -> FloatArray:
    """(2, 2) least x and y, then largest x and y, of all joints in all walks [m]."""
    places_m = [
        pose.position_m[:, :2]
        for walk in walks
        for pose in walk.scene.link_poses().values()
    ]
    low_m = np.min([place_m.min(axis=0) for place_m in places_m], axis=0)
    high_m = np.max([place_m.max(axis=0) for place_m in places_m], axis=0)
    return np.stack([low_m, high_m])


def _cropped(ground: Heightfield, around_m: FloatArray) -> Heightfield:
    """Cut out the part of a ground that covers a rectangle, as far as the ground goes.

    `around_m` (2, 2) holds the rectangle's least x and y, then its largest x and y.
    """
    size = np.array(ground.heights_m.shape[::-1])
    cells = (around_m - ground.origin_m) / ground.spacing_m
    # At least one cell, even if no robot was on the ground.
    first = np.clip(np.floor(cells[0]).astype(np.intp), 0, size - 2)
    last = np.clip(np.ceil(cells[1]).astype(np.intp), first + 1, size - 1)
    (column, row), (right, left) = first.tolist(), last.tolist()
    x_m, y_m = (ground.origin_m + ground.spacing_m * first).tolist()
    heights_m = ground.heights_m[row : left + 1, column : right + 1]
    return Heightfield(heights_m, (x_m, y_m), ground.spacing_m)


def walk_view(walks: Sequence[SearchWalk], name: str) -> rrb.Spatial3DView:
    """View with the title `name` of one or more walks, from the right of the robot."""
    low_m, high_m = _reached(walks)
    size_m = walks[0].scene.description.scale.length
    middle_m = np.array([*((low_m + high_m) / 2), 0.15 * size_m])
    far_m = max(high_m[0] - low_m[0], size_m)
    eye_m = np.array([0.1, -0.45, 0.2]) * far_m + np.array([0.0, -0.35, 0.15]) * size_m
    eye = rrb.EyeControls3D(position=middle_m + eye_m, look_target=middle_m)
    return rrb.Spatial3DView(
        name=name, origin=AT, eye_controls=eye, line_grid=rrb.LineGrid3D(visible=False)
    )

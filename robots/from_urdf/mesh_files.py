"""Finds the files that a URDF names, and reads meshes (STL, OBJ and COLLADA).

trimesh reads STL. The other two formats are read here, because sizes of feet depend on
them: of COLLADA files trimesh 5.2 ignores the unit and the up axis; in OBJ files it
takes index -1 for the last point of the whole file, not for the last one read so far.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import TYPE_CHECKING, cast
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError

if TYPE_CHECKING:
    from trimesh import Trimesh

_COLLECTION = "example-robot-data"
_PACKAGE, _FILE = "package://", "file://"


@cache
def example_robots() -> dict[str, Path]:
    """URDF files of the Python package example-robot-data, by name; none without it.

    A name is the file's stem, such as "go2"; if two files have the same stem, the name
    starts with their folder's, such as "anymal_b_simple_description/anymal".
    """
    try:
        listed = files(_COLLECTION) or []
    except PackageNotFoundError:
        return {}
    found = [file for file in listed if file.suffix == ".urdf"]
    times = Counter(file.stem for file in found)
    return {
        file.stem if times[file.stem] == 1 else f"{file.parts[-3]}/{file.stem}": Path(
            str(file.locate())
        )
        for file in found
    }


def mesh_path(urdf: Path, name: str) -> Path:
    """Find a file that a URDF names by a path, or file:// or package:// address.

    An address `package://NAME/...` is searched in the folders of the environment
    variable ROS_PACKAGE_PATH, as in ROS; then in the folders above the URDF, one of
    which is usually the package or contains it; last where example-robot-data is
    installed, so that a copy of one of its URDFs works anywhere.
    """
    if not name.startswith(_PACKAGE):
        path = Path(name.removeprefix(_FILE))
        tried = [path if path.is_absolute() else urdf.parent / path]
    else:
        package, _, rest = name.removeprefix(_PACKAGE).partition("/")
        roots = [*_ros_folders(), *urdf.resolve().parents, *_example_folders()]
        inside = [root / package / rest for root in roots]
        tried = inside + [root / rest for root in roots if root.name == package]
    for path in tried:
        if path.is_file():
            return path
    raise BadModelError(
        f"{urdf}: {name} is not found; set ROS_PACKAGE_PATH to the folder that holds "
        "its package"
    )


def _ros_folders() -> list[Path]:
    paths = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    return [Path(path) for path in paths if path]


@cache
def _example_folders() -> tuple[Path, ...]:
    """Installed folders in which packages of example-robot-data lie; () without it."""
    some = next(iter(example_robots().values()), None)
    if some is None:
        return ()
    package = next((one for one in some.parents if one.name == _COLLECTION), None)
    return () if package is None else (package.parent, package / "robots")


Element = ElementTree.Element

_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Rotation that turns the y axis, COLLADA's default up axis, into the z axis."""


def read_mesh(path: Path) -> "Trimesh":
    """Read all surfaces of a .stl, .obj or .dae (COLLADA) file as one mesh.

    It has `vertices` (points, 3) [m] and `faces` (triangles, 3), whose corners run
    counterclockwise seen from outside. Points that the file has twice are kept twice.
    COLLADA meshes are turned so that z is up.

    Raises:
      BadModelError: the file cannot be read, or has another format.
    """
    readers = {".stl": _read_stl, ".obj": _read_obj, ".dae": _read_collada}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise BadModelError(f"{path}: a mesh must be one of {', '.join(readers)}")
    try:
        mesh = reader(path)
        faces, points = mesh.faces, len(mesh.vertices)
    except (
        *(OSError, ValueError, IndexError, KeyError, TypeError, AttributeError),
        ElementTree.ParseError,
    ) as error:
        raise BadModelError(f"mesh {path} cannot be read: {error}") from error
    if points == 0 or not np.isfinite(mesh.vertices).all():
        raise BadModelError(f"mesh {path} holds no points")
    if ((faces < 0) | (faces >= points)).any():
        raise BadModelError(f"mesh {path} has faces between points that it lacks")
    return mesh


def _read_stl(path: Path) -> "Trimesh":
    import trimesh

    return trimesh.load_mesh(path, process=False)


def _read_obj(path: Path) -> "Trimesh":
    points: list[list[float]] = []
    faces: list[list[int]] = []
    for line in path.read_text(errors="replace").splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([float(number) for number in rest[:3]])
        elif word == "f":
            corners = [int(corner.partition("/")[0]) for corner in rest]
            # Indices count from 1, or backward from the last point so far.
            faces.append([at + len(points) if at < 0 else at - 1 for at in corners])
    return _mesh(np.array(points, float).reshape(-1, 3), _triangles(faces))


def _mesh(points_m: FloatArray, triangles: IntArray) -> "Trimesh":
    """Make a mesh of points (points, 3) and triangles without merging equal points."""
    import trimesh

    return trimesh.Trimesh(points_m, triangles, process=False)


def _triangles(faces: Sequence[npt.ArrayLike]) -> IntArray:
    """Divide faces, each a list of 3 or more point indices, into triangles (k, 3)."""
    from trimesh.geometry import triangulate_quads

    return np.asarray(triangulate_quads(faces)).reshape(-1, 3)


def _read_collada(path: Path) -> "Trimesh":
    root = ElementTree.parse(path).getroot()
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    unit = root.find("asset/unit")
    metre = 1.0 if unit is None else float(unit.get("meter", "1"))
    shapes = {
        shape.get("id", ""): (_positions(shape), _faces(shape))
        for shape in root.iterfind("library_geometries/geometry")
    }
    is_y_up = root.findtext("asset/up_axis", "Y_UP") == "Y_UP"
    upright = metre * (_Y_UP if is_y_up else np.eye(3))
    parts = []
    for scene in root.iterfind("library_visual_scenes/visual_scene"):
        for name, placement in _instances(scene, np.eye(4)):
            if name not in shapes:
                continue
            points_m, faces = shapes[name]
            points_m = points_m @ placement[:3, :3].T + placement[:3, 3]
            is_mirrored = np.linalg.det(placement[:3, :3]) < 0
            faces = faces[:, ::-1] if is_mirrored else faces
            parts.append(_mesh(points_m @ upright.T, faces))
    return joined(parts)


def joined(meshes: "Sequence[Trimesh]") -> "Trimesh":
    """Join several meshes into one; without any, the result is an empty mesh."""
    import trimesh

    whole = trimesh.util.concatenate(meshes) if meshes else trimesh.Trimesh()
    return cast("Trimesh", whole)


def _positions(shape: Element) -> FloatArray:
    """(points, 3) vertices of one COLLADA geometry, in the file's length unit."""
    sources = {
        source.get("id", ""): source.findtext("float_array") or ""
        for source in shape.iterfind("mesh/source")
    }
    numbers = [
        _floats(sources.get(entry.get("source", "")[1:], ""))
        for entry in shape.iterfind("mesh/vertices/input")
        if entry.get("semantic") == "POSITION"
    ]
    return np.concatenate([*numbers, np.empty(0)]).reshape(-1, 3)


def _faces(shape: Element) -> IntArray:
    """(triangles, 3) vertex indices of the triangles of one COLLADA geometry."""
    return _triangles(
        [
            face
            for kind in ("triangles", "polylist", "polygons")
            for group in shape.iterfind(f"mesh/{kind}")
            for face in _polygons(group)
        ]
    )


def _polygons(group: Element) -> list[IntArray]:
    """Vertex indices of each face of a COLLADA triangles, polylist or polygons."""
    offsets = {
        entry.get("semantic"): int(entry.get("offset", "0"))
        for entry in group.iterfind("input")
    }
    if "VERTEX" not in offsets:
        raise ValueError(f"{group.tag} without VERTEX")
    width, at = 1 + max(offsets.values()), offsets["VERTEX"]
    lists = [
        np.array((part.text or "").split(), np.intp).reshape(-1, width)[:, at]
        for part in group.iterfind("p")
    ]
    if group.tag == "polygons":
        return lists
    corners = np.concatenate([*lists, np.empty(0, np.intp)])
    counts = np.full(len(corners) // 3, 3)
    if group.tag == "polylist":
        counts = np.array(group.findtext("vcount", "").split(), np.intp)
    if counts.sum() != len(corners):
        raise ValueError(f"faces have {counts.sum()} corners, not {len(corners)}")
    return np.split(corners, np.cumsum(counts)[:-1])


def _instances(
    node: Element, placement: FloatArray
) -> Iterator[tuple[str, FloatArray]]:
    """Name and (4, 4) placement of each geometry below a node of a COLLADA scene."""
    for element in node:
        if element.tag == "instance_geometry":
            yield element.get("url", "")[1:], placement
        elif element.tag == "node":
            yield from _instances(element, placement)
        elif element.text and element.tag in _MOVES:
            move: FloatArray = _MOVES[element.tag](_floats(element.text))
            placement = placement @ move


def _floats(text: str) -> FloatArray:
    return np.array(text.split(), float)


def _placement(turn: FloatArray, shift: FloatArray | Sequence[float]) -> FloatArray:
    """Make the (4, 4) transform of a (3, 3) rotation and a (3,) translation."""
    move = np.eye(4)
    move[:3, :3], move[:3, 3] = turn, shift
    return move


_MOVES: dict[str, Callable[[FloatArray], FloatArray]] = {
    "matrix": lambda values: values.reshape(4, 4),
    "translate": lambda values: _placement(np.eye(3), values),
    "rotate": lambda values: _placement(
        Rotation.from_rotvec(np.radians(values[3]) * values[:3]).as_matrix(), (0, 0, 0)
    ),
    "scale": lambda values: np.diag([*values, 1.0]),
}
"""For each transform element of a COLLADA node: function from its numbers to a (4, 4)
matrix."""

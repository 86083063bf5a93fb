"""Points and triangles of a mesh: STL, OBJ and COLLADA, which MuJoCo cannot read."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError

_HEADER, _FACET = 84, 50
_STL_FACET = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
)

_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Turns the axis y, which COLLADA calls up unless told otherwise, to z."""


class Surface(NamedTuple):
    """Triangles between points."""

    points_m: FloatArray
    """(points, 3), z up where the file says what is up."""
    triangles: IntArray
    """(triangles, 3) indices of points, counterclockwise seen from outside."""

    def moved(self, turn: FloatArray, way_m: FloatArray) -> "Surface":
        """The surface after a (3, 3) matrix, which may mirror it, and a way."""
        mirrored = np.linalg.det(turn) < 0
        triangles = self.triangles[:, ::-1] if mirrored else self.triangles
        return Surface(self.points_m @ turn.T + way_m, triangles)


def mesh_vertices(path: Path) -> FloatArray:
    """(points, 3) of every surface in a file [m]; see `mesh_surface`."""
    return mesh_surface(path).points_m


def mesh_surface(path: Path) -> Surface:
    """All surfaces in a file as one; faces of more corners become triangles.

    Raises:
      BadModelError: the file cannot be read, or has a format that is not known here.
    """
    readers = {".stl": _stl, ".obj": _obj, ".dae": _collada}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise BadModelError(f"{path}: a mesh must be one of {', '.join(readers)}")
    try:
        points, triangles = surface = reader(path)
    except (OSError, ValueError, ElementTree.ParseError) as error:
        raise BadModelError(f"mesh {path} cannot be read: {error}") from error
    if len(points) == 0 or not np.isfinite(points).all():
        raise BadModelError(f"mesh {path} holds no points")
    if ((triangles < 0) | (triangles >= len(points))).any():
        raise BadModelError(f"mesh {path} has faces between points that it lacks")
    return surface


def _stl(path: Path) -> Surface:
    """Binary if its length says so: text files may begin like binary ones."""
    content = path.read_bytes()
    facets = int.from_bytes(content[80:_HEADER], "little")
    if len(content) == _HEADER + _FACET * facets:
        table = np.frombuffer(content, _STL_FACET, facets, _HEADER)
        points = table["corners"].reshape(-1, 3).astype(float)
    else:
        rows = map(str.split, content.decode(errors="replace").splitlines())
        points = _numbered(rows, "vertex")
    return Surface(points, np.arange(len(points) // 3 * 3).reshape(-1, 3))


def _obj(path: Path) -> Surface:
    rows = [line.split() for line in path.read_text(errors="replace").splitlines()]
    counts, corners, points = [], [], 0
    for word, *rest in filter(None, rows):
        points += word == "v"
        if word == "f":
            # Counted from 1, or backward from the last point so far.
            places = [int(corner.partition("/")[0]) for corner in rest]
            corners += [at + points if at < 0 else at - 1 for at in places]
            counts.append(len(places))
    return Surface(_numbered(rows, "v"), _fans(counts, corners))


def _numbered(rows: Iterable[list[str]], word: str) -> FloatArray:
    """The three numbers after a word that begins a line."""
    points = [row[1:4] for row in rows if row and row[0] == word]
    return np.array(points, float).reshape(-1, 3)


def _fans(counts: Sequence[int], corners: Sequence[int]) -> IntArray:
    """(triangles, 3) of faces with so many corners each: all from its first corner."""
    corner = np.asarray(corners, np.intp)
    if sum(counts) != len(corner):
        raise ValueError(f"faces have {sum(counts)} corners, not {len(corner)}")
    within = np.maximum(np.asarray(counts, np.intp) - 2, 0)
    first = np.repeat(np.cumsum(counts, dtype=np.intp) - counts, within)
    second = 1 + np.arange(within.sum())
    second += first - np.repeat(np.cumsum(within) - within, within)
    return np.asarray(corner[np.stack([first, second, second + 1], axis=1)])


def _collada(path: Path) -> Surface:
    root = ElementTree.parse(path).getroot()
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    unit = root.find("asset/unit")
    metre = 1.0 if unit is None else float(unit.get("meter", "1"))
    shapes = {
        shape.get("id", ""): Surface(_positions(shape), _faces(shape))
        for shape in root.iterfind("library_geometries/geometry")
    }
    parts = [
        shapes[name].moved(way[:3, :3], way[:3, 3])
        for scene in root.iterfind("library_visual_scenes/visual_scene")
        for name, way in _instances(scene, np.eye(4))
        if name in shapes
    ]
    turn = _Y_UP if root.findtext("asset/up_axis", "Y_UP") == "Y_UP" else np.eye(3)
    return joined(parts).moved(metre * turn, np.zeros(3))


def joined(parts: Sequence[Surface]) -> Surface:
    """Surfaces as one."""
    starts = np.cumsum([0, *(len(part.points_m) for part in parts)])
    triangles = [
        part.triangles + start for part, start in zip(parts, starts, strict=False)
    ]
    return Surface(
        np.vstack([np.empty((0, 3)), *(part.points_m for part in parts)]),
        np.vstack([np.empty((0, 3), np.intp), *triangles]),
    )


def _positions(shape: ElementTree.Element) -> FloatArray:
    """(points, 3) vertices of one geometry."""
    sources = {
        source.get("id", ""): source.findtext("float_array") or ""
        for source in shape.iterfind("mesh/source")
    }
    inputs = shape.iterfind("mesh/vertices/input")
    names = [
        entry.get("source", "")[1:]
        for entry in inputs
        if entry.get("semantic") == "POSITION"
    ]
    numbers = [np.array(sources.get(name, "").split(), float) for name in names]
    return np.concatenate([*numbers, np.empty(0)]).reshape(-1, 3)


def _faces(shape: ElementTree.Element) -> IntArray:
    """(triangles, 3) of one geometry."""
    groups = [
        group
        for kind in ("triangles", "polylist", "polygons")
        for group in shape.iterfind(f"mesh/{kind}")
    ]
    faces = [_fans(*_corners(group)) for group in groups]
    return np.vstack([np.empty((0, 3), np.intp), *faces])


def _corners(group: ElementTree.Element) -> tuple[list[int], list[int]]:
    """How many corners each face of a group has, and the points of all."""
    offsets = {
        entry.get("semantic"): int(entry.get("offset", "0"))
        for entry in group.iterfind("input")
    }
    if "VERTEX" not in offsets:
        raise ValueError(f"{group.tag} without VERTEX")
    width, at = 1 + max(offsets.values()), offsets["VERTEX"]
    lists = [
        np.array((part.text or "").split(), np.intp).reshape(-1, width)[:, at].tolist()
        for part in group.iterfind("p")
    ]
    corners = [corner for part in lists for corner in part]
    if group.tag == "polygons":
        return [len(part) for part in lists], corners
    if group.tag == "polylist":
        return [int(word) for word in group.findtext("vcount", "").split()], corners
    return [3] * (len(corners) // 3), corners


def _instances(
    node: ElementTree.Element, placement: FloatArray
) -> Iterator[tuple[str, FloatArray]]:
    """Geometries below a node of the scene, and the (4, 4) way to each."""
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


def _translate(values: FloatArray) -> FloatArray:
    move = np.eye(4)
    move[:3, 3] = values
    return move


def _rotate(values: FloatArray) -> FloatArray:
    move = np.eye(4)
    turn = np.radians(values[3]) * values[:3]
    move[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    return move


_MOVES: dict[str, Callable[[FloatArray], FloatArray]] = {
    "matrix": lambda values: values.reshape(4, 4),
    "translate": _translate,
    "rotate": _rotate,
    "scale": lambda values: np.diag([*values, 1.0]),
}

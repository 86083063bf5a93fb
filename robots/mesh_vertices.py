"""The points of a mesh: STL, OBJ and COLLADA, which MuJoCo cannot read."""

from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError

_HEADER, _FACET = 84, 50
_STL_FACET = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
)

_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Turns the axis y, which COLLADA calls up unless told otherwise, to z."""


def mesh_vertices(path: Path) -> FloatArray:
    """(points, 3) of every surface in a file [m], z up where the file says what is up.

    Raises:
      BadModelError: the file cannot be read, or has a format that is not known here.
    """
    readers = {".stl": _stl, ".obj": _obj, ".dae": _collada}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise BadModelError(f"{path}: a mesh must be one of {', '.join(readers)}")
    try:
        points = reader(path)
    except (OSError, ValueError, ElementTree.ParseError) as error:
        raise BadModelError(f"mesh {path} cannot be read: {error}") from error
    if len(points) == 0 or not np.isfinite(points).all():
        raise BadModelError(f"mesh {path} holds no points")
    return points


def _stl(path: Path) -> FloatArray:
    """Binary if its length says so: text files may begin like binary ones."""
    content = path.read_bytes()
    facets = int.from_bytes(content[80:_HEADER], "little")
    if len(content) == _HEADER + _FACET * facets:
        table = np.frombuffer(content, _STL_FACET, facets, _HEADER)
        return table["corners"].reshape(-1, 3).astype(float)
    return _numbered(content.decode(errors="replace"), "vertex")


def _obj(path: Path) -> FloatArray:
    return _numbered(path.read_text(errors="replace"), "v")


def _numbered(text: str, word: str) -> FloatArray:
    """The three numbers after a word that begins a line."""
    rows = [line.split() for line in text.splitlines()]
    points = [row[1:4] for row in rows if row and row[0] == word]
    return np.array(points, float).reshape(-1, 3)


def _collada(path: Path) -> FloatArray:
    root = ElementTree.parse(path).getroot()
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    unit = root.find("asset/unit")
    metre = 1.0 if unit is None else float(unit.get("meter", "1"))
    shapes = {
        shape.get("id", ""): _positions(shape)
        for shape in root.iterfind("library_geometries/geometry")
    }
    parts = [
        points @ placement[:3, :3].T + placement[:3, 3]
        for scene in root.iterfind("library_visual_scenes/visual_scene")
        for name, placement in _instances(scene, np.eye(4))
        if (points := shapes.get(name)) is not None
    ]
    turn = _Y_UP if root.findtext("asset/up_axis", "Y_UP") == "Y_UP" else np.eye(3)
    return metre * np.vstack(parts) @ turn.T if parts else np.empty((0, 3))


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

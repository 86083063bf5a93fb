"""Mesh files, written here by hand."""

import struct

import numpy as np
import pytest

from groundwalk.errors import BadModelError
from robots.from_urdf.mesh_files import read_mesh

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 3]])
TEXT_STL = """solid made by hand
facet normal 0 0 1
outer loop
  vertex {}
  vertex {}
  vertex {}
endloop
endfacet
endsolid
"""
DAE = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema">
<asset><unit meter="0.01"/>{up}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array count="9">0 0 0 1 0 0 0 2 3</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene><node><translate>10 0 0</translate>
<rotate>0 0 1 90</rotate><scale>2 2 2</scale>
<node><instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes>
</COLLADA>"""


def turned(faces):
    """Triangles in any order, each from its least corner on, the way round kept."""
    faces = [tuple(map(int, face)) for face in faces]
    return sorted(min(face[k:] + face[:k] for k in range(3)) for face in faces)


def test_binary_stl(tmp_path):
    facet = struct.pack("<12fH", 0, 0, 1, *CORNERS.ravel(), 0)
    path = tmp_path / "one.STL"
    path.write_bytes(b"solid".ljust(80) + struct.pack("<I", 1) + facet)
    np.testing.assert_allclose(read_mesh(path).vertices, CORNERS)


def test_text_stl_and_obj(tmp_path):
    rows = [" ".join(map(str, corner)) for corner in CORNERS]
    stl, obj = tmp_path / "one.stl", tmp_path / "one.obj"
    stl.write_text(TEXT_STL.format(*rows))
    obj.write_text("\n".join([*(f"v {row}" for row in rows), "vn 0 0 1", "f 1 2 3"]))
    np.testing.assert_allclose(read_mesh(stl).vertices, CORNERS)
    np.testing.assert_allclose(read_mesh(obj).vertices, CORNERS)


def test_collada_with_its_scene(tmp_path):
    """Twice as large, a quarter turn to the left, 10 units forward, a unit is 1 cm."""
    path = tmp_path / "one.dae"
    path.write_text(DAE.format(up="<up_axis>Z_UP</up_axis>"))
    expected = [[0.1, 0, 0], [0.1, 0.02, 0], [0.06, 0, 0.06]]
    np.testing.assert_allclose(read_mesh(path).vertices, expected, atol=1e-12)


def test_collada_whose_y_is_up(tmp_path):
    """(x, y, z) with y up is (x, -z, y) with z up; y is up unless the file says."""
    path = tmp_path / "one.dae"
    expected = [[0.1, 0, 0], [0.1, 0, 0.02], [0.06, -0.06, 0]]
    for up in ("", "<up_axis>Y_UP</up_axis>"):
        path.write_text(DAE.format(up=up))
        np.testing.assert_allclose(read_mesh(path).vertices, expected, atol=1e-12)


FACES = {
    "polylist": "<vcount>3 4</vcount><p>0 9 1 9 2 9 2 9 1 9 0 9 2 9</p>",
    "triangles": "<p>0 9 1 9 2 9 2 9 1 9 0 9 2 9 0 9 2 9</p>",
    "polygons": "<p>0 9 1 9 2 9</p><p>2 9 1 9 0 9 2 9</p>",
}


@pytest.mark.parametrize("kind", FACES)
def test_faces_of_collada(tmp_path, kind):
    """Behind each corner stands its normal, 9; a face of four becomes two."""
    inputs = '<input semantic="VERTEX" offset="0"/><input semantic="N" offset="1"/>'
    faces = f"<{kind}>{inputs}{FACES[kind]}</{kind}></mesh>"
    path = tmp_path / "one.dae"
    path.write_text(DAE.format(up="").replace("</mesh>", faces))
    expected = [[0, 1, 2], [2, 1, 0], [2, 0, 2]]
    assert turned(read_mesh(path).faces) == turned(expected)
    path.write_text(path.read_text().replace("<p>0", "<p>3"))
    with pytest.raises(BadModelError, match="lacks"):
        read_mesh(path)


def test_a_mirror_in_the_scene_turns_faces_round(tmp_path):
    faces = '<triangles><input semantic="VERTEX"/><p>0 1 2</p></triangles></mesh>'
    path = tmp_path / "one.dae"
    text = DAE.format(up="").replace("</mesh>", faces)
    path.write_text(text.replace("<scale>2 2 2", "<scale>2 2 -2"))
    assert turned(read_mesh(path).faces) == turned([[2, 1, 0]])


def test_faces_of_obj_and_stl(tmp_path):
    """Counted from 1, or backward from the last point before the face."""
    obj, stl = tmp_path / "one.obj", tmp_path / "one.stl"
    points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    obj.write_text(points + "f 1/7/8 2/7/8 3 4\nf -1 -2 -3\nv 1 1 1\n")
    expected = [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
    assert turned(read_mesh(obj).faces) == turned(expected)
    stl.write_text(TEXT_STL.format("0 0 0", "1 0 0", "0 1 0"))
    assert turned(read_mesh(stl).faces) == turned([[0, 1, 2]])
    obj.write_text(points + "f 1 2 5\n")
    with pytest.raises(BadModelError, match="lacks"):
        read_mesh(obj)


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.glb", "x"), ("a.stl", "nothing"), ("a.dae", "<a>"), ("a.obj", "v 1 2 x")],
)
def test_what_is_no_mesh(tmp_path, name, content):
    path = tmp_path / name
    path.write_text(content)
    with pytest.raises(BadModelError, match=name):
        read_mesh(path)

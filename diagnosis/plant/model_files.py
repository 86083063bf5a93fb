"""Reads robot models from MJCF and URDF files."""

from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from groundwalk.errors import BadModelError

_COMPILER = {"balanceinertia": "true", "boundmass": "1e-6", "boundinertia": "1e-9"}
_NO_DYNAMICS = ("transmission", "gazebo", "material", "mujoco")


def urdf_spec(path: Path, contacts: bool) -> mujoco.MjSpec:
    """Read a URDF as a MuJoCo specification without visual shapes.

    Meshes are never read: they do not matter to the dynamics, and their paths are
    often wrong. Impossible inertias are replaced as MuJoCo's `balanceinertia` does;
    moving links without mass or inertia get a tiny one. With `contacts`, collision
    shapes that are boxes, cylinders and spheres stay; they touch only the ground.

    Raises:
      BadModelError: the file cannot be read or is no URDF.
    """
    try:
        root = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, OSError) as error:
        raise BadModelError(f"{path} cannot be read: {error}") from error
    if root.tag != "robot":
        raise BadModelError(f"{path} is no URDF: its root is <{root.tag}>, not <robot>")
    for link in root.iter("link"):
        _strip(link, contacts)
    for tag in _NO_DYNAMICS:
        for element in root.findall(tag):
            root.remove(element)
    extension = ElementTree.SubElement(root, "mujoco")
    ElementTree.SubElement(extension, "compiler", _COMPILER)
    try:
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    except (ValueError, IndexError) as error:
        raise _not_a_model(path, error) from error
    for geom in spec.geoms:
        geom.conaffinity = 0
    return spec


def mjcf_spec(path: Path) -> mujoco.MjSpec:
    """Read an MJCF file as a MuJoCo specification.

    Raises:
      BadModelError: MuJoCo cannot read the file.
    """
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise _not_a_model(path, error) from error


def _strip(link: ElementTree.Element, contacts: bool) -> None:
    """Remove shapes and massless inertials of a link; replace impossible inertias."""
    for shape in [*link.findall("visual"), *link.findall("collision")]:
        is_mesh = shape.find("geometry/mesh") is not None
        if shape.tag == "visual" or is_mesh or not contacts:
            link.remove(shape)
    for inertial in link.findall("inertial"):
        mass = inertial.find("mass")
        if mass is None or float(mass.get("value", "0")) <= 0:
            link.remove(inertial)
        for inertia in inertial.findall("inertia"):
            if not _is_positive(inertia):
                least = dict.fromkeys(("ixx", "iyy", "izz"), _COMPILER["boundinertia"])
                inertia.attrib = {**dict.fromkeys(("ixy", "ixz", "iyz"), "0"), **least}


def _is_positive(inertia: ElementTree.Element) -> bool:
    """Whether all eigenvalues of a URDF inertia are positive, as MuJoCo demands."""
    rows = (("xx", "xy", "xz"), ("xy", "yy", "yz"), ("xz", "yz", "zz"))
    matrix = [[float(inertia.get(f"i{axes}", "0")) for axes in row] for row in rows]
    return bool(np.linalg.eigvalsh(matrix).min() > 0)


def _not_a_model(path: Path, error: Exception) -> BadModelError:
    reason = str(error).partition("\n")[0]
    return BadModelError(f"{path} is no model that MuJoCo can read: {reason}")

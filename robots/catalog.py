"""Makes descriptions of robots from their names or files.

Links that a TOML description fixes to others are merged into their parents.
"""

import dataclasses
import tomllib
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy.spatial import ConvexHull

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError, UnknownNameError
from robots.description import (
    SENSORS_PER_FOOT,
    Capsule,
    Description,
    Foot,
    Imu,
    Joint,
    Link,
    Motor,
)
from robots.from_urdf.adaptation import Adaptation, read_adaptation
from robots.from_urdf.adapter import adapted
from robots.rigid_body import Inertial, combined, inertia_matrix

Table = dict[str, Any]
T = TypeVar("T")


def read_description(path: Path) -> Description:
    """Read the robot of a TOML file in the format of `robots/nao.toml`."""
    table = tomllib.loads(path.read_text())
    joints: dict[str, Table] = table["joint"]
    root_name = table["root"]
    carrier = {name: _carrier(name, joints, root_name) for name in joints}
    moving = [name for name, joint in joints.items() if not joint.get("fixed", False)]
    index = {name: i for i, name in enumerate(moving)} | {root_name: -1}
    pairs = [tuple(pair["joints"]) for pair in table.get("coupled", ())]
    coupled = {name for pair in pairs for name in pair}
    motors = {name: _motor(values) for name, values in table["motor"].items()}

    def joint(name: str) -> Joint:
        values = joints[name]
        axis = np.array(values["axis"], float)
        parent, offset = _parent(name, joints, root_name)
        motor = _named("motor", values["motor"], motors)
        return Joint(
            name=name,
            parent=index[parent],
            origin_m=np.array(values["origin"], float) + offset,
            axis=axis / np.linalg.norm(axis),
            range_rad=(float(values["range"][0]), float(values["range"][1])),
            motor=motor.shared(2) if name in coupled else motor,
            link=_link(values["link"], name, joints, carrier, values),
        )

    return Description(
        name=table["name"],
        root=_link(root_name, root_name, joints, carrier, table[root_name]),
        links=tuple(joint(name) for name in moving),
        coupled=tuple(
            (_named("joint", first, index), _named("joint", second, index))
            for first, second in pairs
        ),
        feet=(
            _foot(table["foot"]["left"], index),
            _foot(table["foot"]["right"], index),
        ),
        imu=Imu(
            gyroscope_m=_place(table["imu"]["gyroscope"]),
            accelerometer_m=_place(table["imu"]["accelerometer"]),
        ),
    )


def _parent(name: str, joints: dict[str, Table], root: str) -> tuple[str, FloatArray]:
    """The next moving joint (or root) above; the direct parent's place there [m]."""
    offset = np.zeros(3)
    parent = joints[name]["parent"]
    while parent != root:
        if parent not in joints:
            raise UnknownNameError(f"parent of {name}", parent, [*joints, root])
        if not joints[parent].get("fixed", False):
            break
        offset += np.array(joints[parent]["origin"], float)
        parent = joints[parent]["parent"]
    return parent, offset


def _carrier(name: str, joints: dict[str, Table], root: str) -> tuple[str, FloatArray]:
    """The moving joint (or root) that carries a link, and its place there [m]."""
    if not joints[name].get("fixed", False):
        return name, np.zeros(3)
    parent, offset = _parent(name, joints, root)
    return parent, offset + np.array(joints[name]["origin"], float)


def _link(
    link: str,
    owner: str,
    joints: dict[str, Table],
    carrier: dict[str, tuple[str, FloatArray]],
    own: Table,
) -> Link:
    """The link of a moving joint or the root, with all fixed links merged in."""
    bodies = [_inertial(own)]
    shapes = [_capsule(shape, np.zeros(3)) for shape in own.get("shapes", ())]
    for name, (carried_by, offset) in carrier.items():
        if carried_by == owner and name != owner:
            bodies.append(_inertial(joints[name]).moved(offset))
            shapes += [_capsule(s, offset) for s in joints[name].get("shapes", ())]
    return Link(link, combined(bodies), tuple(shapes))


def _inertial(values: Table) -> Inertial:
    com = np.array(values["com"], float)
    return Inertial(float(values["mass"]), com, inertia_matrix(values["inertia"]))


def _capsule(values: Table, offset: FloatArray) -> Capsule:
    start, end = np.array(values["from"]) + offset, np.array(values["to"]) + offset
    colour = values.get("colour", "shell")
    return Capsule(_place(start), _place(end), float(values["radius"]), colour)


def _place(values: Iterable[float]) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z


def _motor(values: Table) -> Motor:
    """Make a servo: its duty cycle follows the position error, back-EMF damps it."""
    stall, no_load = float(values["stall_torque"]), float(values["no_load_speed"])
    return Motor(
        stall_torque_nm=stall,
        no_load_speed_rad_s=no_load,
        kp_nm_rad=stall / float(values["error_at_full_duty"]),
        kd_nm_s_rad=stall / no_load,
        rotor_kg_m2=float(values["rotor_inertia"]) * float(values["gear"]) ** 2,
    )


def _foot(values: Table, index: dict[str, int]) -> Foot:
    outline = np.array(values["outline"], float)
    corners = outline[np.sort(ConvexHull(outline).vertices)]
    sensors = np.array([values["sensors"][name] for name in SENSORS_PER_FOOT], float)
    joint = _named("joint", values["joint"], index)
    return Foot(joint, float(values["sole_height"]), corners, sensors)


def _named(kind: str, name: str, known: dict[str, T]) -> T:
    """Look a name up; UnknownNameError if it is missing, with the kind of the name."""
    if name not in known:
        raise UnknownNameError(kind, name, known)
    return known[name]


_FOLDER = Path(__file__).parent
_URDF, _TOML = ".urdf", ".toml"


def names() -> list[str]:
    """List the names of the built-in robots.

    Example:
      >>> "nao" in robots.names()
      True
    """
    return sorted(path.stem for path in _FOLDER.glob(f"*{_TOML}"))


@cache
def get(name: str) -> Description:
    """Describe a robot by its name, or from a file.

    A file is a URDF (.urdf) of a robot on two legs, or a TOML file (.toml) like
    robots/nao.toml or that completes a URDF. GroundwalkError if there is no such robot,
    or the file holds no robot that walks on two legs; the message says why.

    Example:
      >>> get("nao").joints[:2]
      ('LHipYawPitch', 'LHipRoll')
    """
    path = Path(name)
    if path.suffix.lower() not in (_URDF, _TOML):
        if name not in names():
            raise UnknownNameError("robot", name, names())
        path = _FOLDER / f"{name}{_TOML}"
    if not path.is_file():
        raise BadModelError(f"{path}: no such file")
    if path.suffix.lower() == _URDF:
        return adapted(name, Adaptation(urdf=path.name), path.parent)
    if "urdf" in _keys(path):
        return adapted(name, read_adaptation(path), path.parent)
    description = read_description(path)
    own = path.parent != _FOLDER
    return dataclasses.replace(description, name=name) if own else description


def _keys(path: Path) -> set[str]:
    try:
        return set(tomllib.loads(path.read_text()))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise BadModelError(f"{path} is no robot: {error}") from error

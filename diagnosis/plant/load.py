"""Loads the nominal robot model (the plant) from a robot's name or a model file."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from diagnosis.plant.base import lock_joints, set_base, standing_bodies
from diagnosis.plant.plant import ROOT, Base, ModelOptions, Plant
from diagnosis.plant.servo import (
    Gains,
    Servo,
    add_rotors,
    add_servos,
    described_servo,
    model_servo,
    remove_actuators,
    with_gains,
)
from groundwalk.errors import BadModelError, BadRecordingError, UnknownNameError
from robots import Description
from robots import get as robot
from robots import names as robot_names
from robots.engine_models.mjcf import quiet_mujoco
from robots.from_urdf.mesh_files import example_robots
from worlds.recordings.recording import nearest
from worlds.recordings.stated_model import MODEL_FILES

_HELD_AT_M = 1.0
"""Height [m] at which the base of a robot from `robots` is placed in the model."""


def load_plant(
    source: str | Path,
    base: Base,
    joints: Sequence[str] | None = None,
    servo: Gains | None = None,
) -> Plant:
    """Load the nominal robot model that a diagnosis simulates.

    Joints that the recordings lack are locked at position 0. Contacts exist only with a
    floating base. The integrator is MuJoCo's implicitfast; the state of a simulation
    that diverges becomes NaN.

    Args:
      source: a robot of `robots`, a path to MJCF (.xml) or URDF (.urdf), or a robot
        of example-robot-data, such as "so101".
      base: "fixed" to the world or "floating".
      joints: joints that the recordings have; None for all hinges and slides.
      servo: servo gains that replace the model's own, and rotor inertias for joints
        whose model has none.

    Raises:
      UnknownNameError: no robot has this name, or `servo` names an unknown joint.
      BadModelError: the model file is missing, cannot be read or does not compile.
      BadRecordingError: the model lacks one of the joints.

    Example:
      >>> load_plant("nao", "fixed").joints[:2]
      ('LHipYawPitch', 'LHipRoll')
    """
    quiet_mujoco()  # no warnings on trial values that diverge, or on mimic joints
    name, spec, description = _read(source, base)
    known = _compiled(spec.copy(), name)  # compiling may merge bodies
    ours = _chosen(known, joints, name)
    if description is not None:
        own = described_servo(description, ours)
    else:
        own = model_servo(known, ours)
    own = with_gains(own, ours, servo)
    options = None
    if description is not None or Path(source).suffix == ".xml":
        own_step_s, flags = spec.option.timestep, int(spec.option.disableflags)
        options = ModelOptions(own_step_s, int(spec.option.integrator), flags)
    _equip(spec, base, ours, own)
    add_rotors(spec, ours, servo)
    model = _compiled(spec, name)
    if description is not None:
        feet = _described_feet(description)
    else:
        feet = standing_bodies(model) if base == "floating" else ()
    return Plant(name, spec, ours, own, base, feet, options)


def described_plant(description: Description, spec: mujoco.MjSpec, base: Base) -> Plant:
    """Make the plant of a robot whose MuJoCo specification, changed here, exists."""
    servo = described_servo(description, description.joints)
    _equip(spec, base, description.joints, servo)
    feet = _described_feet(description)
    return Plant(description.name, spec, description.joints, servo, base, feet)


def _equip(
    spec: mujoco.MjSpec, base: Base, joints: Sequence[str], servo: Servo
) -> None:
    """Fix or free the base, lock all joints but `joints`, and add their servos."""
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    remove_actuators(spec)
    set_base(spec, base)
    lock_joints(spec, {*joints, ROOT} if base == "floating" else set(joints))
    add_servos(spec, joints, servo)
    for body in spec.bodies:
        body.simple = False  # or its centre of mass could not be moved later


def _read(
    source: str | Path, base: Base
) -> tuple[str, mujoco.MjSpec, Description | None]:
    text = str(source)
    if Path(text).suffix in MODEL_FILES:
        path = Path(text)
        if not path.is_file():
            raise BadModelError(f"{path}: no such file")
        if path.suffix == ".xml":
            return path.stem, mjcf_spec(path), None
        return path.stem, urdf_spec(path, base == "floating"), None
    if text in robot_names():
        description = robot(text)
        return text, _described_spec(description), description
    examples = example_robots()
    if text not in examples:
        raise UnknownNameError("robot", text, {*robot_names(), *examples})
    return text, urdf_spec(examples[text], base == "floating"), None


def _described_spec(description: Description) -> mujoco.MjSpec:
    from robots.engine_models.mjcf import mujoco_spec

    spec = mujoco_spec(description)
    spec.worldbody.bodies[0].pos = [0, 0, _HELD_AT_M]
    for geom in spec.geoms:
        # The sole's own friction counts, not the larger one of sole and ground.
        geom.priority = int(geom.contype == 1)
    return spec


def _compiled(spec: mujoco.MjSpec, name: str) -> mujoco.MjModel:
    try:
        return spec.compile()
    except ValueError as error:
        reason = str(error).partition("\n")[0]
        raise BadModelError(
            f"the model of {name} does not compile: {reason}"
        ) from error


def _chosen(
    model: mujoco.MjModel, joints: Sequence[str] | None, name: str
) -> tuple[str, ...]:
    """Names of the hinges and slides, in the model's order; only `joints` if given."""
    kinds = (mujoco.mjtJoint.mjJNT_HINGE.value, mujoco.mjtJoint.mjJNT_SLIDE.value)
    names = [model.joint(i).name for i in range(model.njnt)]
    there = [
        joint
        for joint, kind in zip(names, model.jnt_type, strict=True)
        if joint and kind in kinds
    ]
    for joint in joints or ():
        if joint not in there:
            hint = nearest(joint, there) or f"; it has {', '.join(there)}"
            raise BadRecordingError(
                f"the recordings have a joint {joint!r} that {name} lacks{hint}"
            )
    return tuple(joint for joint in there if joints is None or joint in joints)


def _described_feet(description: Description) -> tuple[str, ...]:
    return tuple(description.links[foot.joint].link.name for foot in description.feet)


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

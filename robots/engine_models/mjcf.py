"""Makes the MuJoCo model of a robot from its description.

The ground is not part of the model: a world adds it. The robot's only collision shapes
are small spheres around each sole, which touch planes and heightfields in one point
each and need a quarter of the computing time of boxes.
"""

import contextlib
import ctypes
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.errors import BadValueError, UnknownNameError
from robots.description import Capsule, Description, Foot, Joint, Link
from robots.rigid_body import Inertial
from robots.sole import CONTACT_RADIUS_M, FRICTION, contact_points

if TYPE_CHECKING:
    import mujoco

CONTACT_GROUP, SHAPE_GROUP = 3, 2
ROOT_JOINT = "root"
# Coupling of two joints of one motor, as stiff as the time step allows: MuJoCo raises
# 1 ms to two steps. The joints differ by 0.1 mrad, with MuJoCo's defaults by 2 mrad.
COUPLING_SOLREF = (0.001, 1.0)
COUPLING_SOLIMP = (0.99, 0.999, 0.001, 0.5, 2.0)
SIDES = ("left", "right")


def quiet_mujoco() -> None:
    """Switch off MuJoCo's log, on console and file, and the clock of its profiler.

    Both stay off for the whole process. The log is not needed: worlds themselves report
    unstable physics, and users cannot change the deprecated attributes in Gymnasium's
    models, about which MuJoCo warns. `MjData.timer` is not read either, but the clock
    behind it is at every stage of a step: half of the time of an arm of two joints.
    """
    import mujoco

    log = mujoco.MjLogConfig.get()
    log.logto_console = log.logto_file = False
    log.set()
    # `mujoco.set_mjcb_time(None)` leaves the clock that the package has set itself
    with contextlib.suppress(ValueError):  # not found: slower, and nothing else
        ctypes.c_void_p.in_dll(mujoco_library(), "mjcb_time").value = None


def mujoco_library() -> ctypes.CDLL:
    """MuJoCo's C library, for what its Python package has no name for."""
    import mujoco

    return ctypes.CDLL(mujoco._functions.__file__)


def mujoco_spec(description: Description) -> "mujoco.MjSpec":
    """Make an editable MuJoCo specification of a robot, without ground.

    Joints and actuators have the description's joint names in its order; the floating
    root comes first. A control is a position target [rad]; the actuator is a DC
    motor whose drive voltage saturates (see `Motor`). Sensors: `gyroscope`,
    `accelerometer`, and for each contact sphere `touch_<side>_<k>` [N]. The
    integrator is implicitfast.
    """
    import mujoco

    spec = mujoco.MjSpec()
    spec.modelname = description.name
    spec.compiler.degree = False
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    root = _body(spec.worldbody, description.root, description.root.inertial)
    root.add_freejoint(name=ROOT_JOINT)
    bodies: list[Any] = []
    for joint in description.links:
        parent = root if joint.parent < 0 else bodies[joint.parent]
        body = _body(parent, joint.link, joint.moved_inertial)
        body.pos = joint.origin_m
        body.add_joint(
            name=joint.name,
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=joint.axis,
            range=joint.range_rad,
        )
        bodies.append(body)
        _add_motor(spec, joint)
    for first, second in description.coupled:
        spec.add_equality(
            name=f"coupled_{first}_{second}",
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=description.joints[first],
            name2=description.joints[second],
            data=[0, 1] + [0] * 10,
            solref=COUPLING_SOLREF,
            solimp=COUPLING_SOLIMP,
        )
    for side, foot in zip(SIDES, description.feet, strict=True):
        _add_sole(spec, bodies[foot.joint], foot, side)
    _add_imu(spec, root, description)
    return spec


def _body(parent: Any, link: Link, inertial: Inertial) -> Any:
    body = parent.add_body(name=link.name)
    body.mass = inertial.mass_kg
    body.ipos = inertial.com_m
    inertia = inertial.inertia_kg_m2
    body.fullinertia = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    body.explicitinertial = True
    for shape in link.shapes:
        _add_shape(body, shape)
    return body


def _add_shape(body: Any, shape: Capsule) -> None:
    import mujoco

    kind = mujoco.mjtGeom
    is_sphere = shape.start_m == shape.end_m
    geom = body.add_geom(
        type=kind.mjGEOM_SPHERE if is_sphere else kind.mjGEOM_CAPSULE,
        size=[shape.radius_m, 0, 0],
        mass=0,
        contype=0,
        conaffinity=0,
        group=SHAPE_GROUP,
    )
    if is_sphere:
        geom.pos = shape.start_m
    else:
        geom.fromto = [*shape.start_m, *shape.end_m]


def _add_motor(spec: Any, joint: Joint) -> None:
    """Add a joint's DC motor; its voltage follows the position error, up to full."""
    import mujoco

    motor = joint.motor
    actuator = spec.add_actuator(
        name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    actuator.set_to_dcmotor(
        motorconst=[0.0, 0.0],
        resistance=0.0,
        nominal=[1.0, motor.stall_torque_nm, motor.no_load_speed_rad_s],
        controller=[motor.kp_nm_rad, 0.0, motor.kd_nm_s_rad, 0.0, 0.0, 1.0],
        ctrlspec=mujoco.mjtCtrlInput.mjINPUT_POS.value,
    )


def _add_sole(spec: Any, body: Any, foot: Foot, side: str) -> None:
    import mujoco

    for k, (x, y) in enumerate(contact_points(foot)):
        centre = [x, y, foot.sole_height_m + CONTACT_RADIUS_M]
        body.add_geom(
            name=f"sole_{side}_{k}",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[CONTACT_RADIUS_M, 0, 0],
            pos=centre,
            mass=0,
            contype=1,
            conaffinity=0,
            condim=3,
            friction=[FRICTION, 0, 0],
            group=CONTACT_GROUP,
        )
        site = body.add_site(
            name=f"touch_{side}_{k}", pos=centre, size=[2 * CONTACT_RADIUS_M, 0, 0]
        )
        spec.add_sensor(
            name=site.name,
            type=mujoco.mjtSensor.mjSENS_TOUCH,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=site.name,
        )


def _add_imu(spec: Any, root: Any, description: Description) -> None:
    import mujoco

    imu, kind = description.imu, mujoco.mjtSensor
    for name, place, sensor in (
        ("gyroscope", imu.gyroscope_m, kind.mjSENS_GYRO),
        ("accelerometer", imu.accelerometer_m, kind.mjSENS_ACCELEROMETER),
    ):
        root.add_site(name=name, pos=place)
        spec.add_sensor(
            name=name, type=sensor, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=name
        )


def scale_mass(model: Any, data: Any, factor: float, bodies: Sequence[str]) -> None:
    """Multiply masses and inertias of an `MjModel`'s bodies; () means all.

    Changing masses alone would leave the inertias and MuJoCo's derived constants
    unchanged (MuJoCo issue 609); `mj_setConst` computes the constants again, and also
    puts `data` into the model's reference pose.
    """
    import mujoco

    if not 0 < factor < float("inf"):
        raise BadValueError(f"the masses' factor is {factor}; it must be positive")
    names = [model.body(index).name for index in range(1, model.nbody)]
    for name in bodies or names:
        if name not in names:
            raise UnknownNameError("body", name, names)
        index = model.body(name).id
        model.body_mass[index] *= factor
        model.body_inertia[index] *= factor
    mujoco.mj_setConst(model, data)

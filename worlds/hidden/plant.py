"""Nominal robots to which hidden physics is added: models, servos and joint ranges."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import robots
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, UnknownNameError
from robots.description import Description
from robots.engine_models.mjcf import ROOT_JOINT, mujoco_spec
from robots.engine_models.urdf import model_urdf
from worlds.recordings.load import Load
from worlds.recordings.metadata import ServoGains

if TYPE_CHECKING:
    import mujoco

_SO101 = "so_arm_description/urdf/so101.urdf"
_SO101_HELD = "gripper"
SO101_TORQUE_NM = 2.9
"""Largest torque of each servo of the SO-101 arm [N m], as its model file states it."""
SO101_ROTOR_KG_M2 = 0.003
"""Rotor inertia of each SO-101 servo seen through its gear [kg m^2], assumed. The wrist
alone has 4e-5 kg m^2, which would not show beside a servo of 17 N m/rad."""

RIGID_NM_RAD = 3000.0
"""Stiffness [N m/rad] of surfaces that stick and of gear teeth that touch: under a
torque of 3 N m they yield by 0.001 rad, less than an encoder's resolution."""

PENDULUM = """<mujoco model="pendulum">
  <compiler angle="radian"/>
  <worldbody>
    <body name="link">
      <joint name="swing" type="hinge" axis="0 1 0" range="-3 3"
        actuatorfrcrange="-4 4"/>
      <inertial pos="0 0 -0.3" mass="0.5" diaginertia="0.002 0.002 0.001"/>
      <geom type="capsule" size="0.01" fromto="0 0 0 0 0 -0.3" mass="0"
        contype="0" conaffinity="0"/>
    </body>
  </worldbody>
</mujoco>
"""
"""MJCF of a pendulum: 0.5 kg, 0.3 m below a hinge of +-3 rad and +-4 N m."""


@dataclass(frozen=True, eq=False)
class HiddenPlant:
    """A robot without hidden physics; arrays are (j,) in the order of `joints`.

    Attributes:
      name: "pendulum", "so101" or the name of a robot of `groundwalk list robots`.
      file: (name, text) of its model file; None for a robot of that list.
      make_spec: makes a new `mujoco.MjSpec` without actuators and ground.
      joints, links: names of the joints, which all have servos, and of their bodies.
      kp_nm_rad, kd_nm_s_rad, max_torque_nm, back_emf_nm_s_rad: the servos,
        torque = clip(kp (command - position) - kd v, +-max) - back_emf v.
      range_rad: (j, 2) lowest and highest angle.
      speed_rad_s: highest speed of commands.
      rigid: stiffness of gear teeth as a multiple of the servo's, where that is more
        than `RIGID_NM_RAD`.
      description: of a robot of `groundwalk list robots`; else None.

    Example:
      >>> hidden_plant("pendulum").with_gains(0.5).joints
      ('swing',)
    """

    name: str
    file: tuple[str, str] | None
    make_spec: Callable[[], "mujoco.MjSpec"]
    joints: tuple[str, ...]
    links: tuple[str, ...]
    kp_nm_rad: FloatArray
    kd_nm_s_rad: FloatArray
    max_torque_nm: FloatArray
    back_emf_nm_s_rad: FloatArray
    range_rad: FloatArray
    speed_rad_s: FloatArray
    floating: bool = False
    description: Description | None = None
    rigid: float = 0.0

    @property
    def servo(self) -> dict[str, ServoGains]:
        """Each joint's servo gains as recordings state them: kd is kd plus back-EMF."""
        damping = self.kd_nm_s_rad + self.back_emf_nm_s_rad
        rows = zip(self.kp_nm_rad, damping, self.max_torque_nm, strict=True)
        gains = [ServoGains(*map(float, row)) for row in rows]
        return dict(zip(self.joints, gains, strict=True))

    def joint(self, name: str) -> int:
        """Index of a joint in all arrays (j,); UnknownNameError if it is none."""
        if name not in self.joints:
            raise UnknownNameError(f"joint of {self.name}", name, self.joints)
        return self.joints.index(name)

    def rigid_nm_rad(self, joint: int) -> float:
        """Stiffness [N m/rad] of surfaces that stick, and of gear teeth, at a joint."""
        return max(RIGID_NM_RAD, self.rigid * float(self.kp_nm_rad[joint]))

    def with_masses(self, extra_kg: Mapping[str, float]) -> "HiddenPlant":
        """A copy whose bodies, by name, are heavier by so many kg, or lighter if < 0.

        Centres of mass, and inertias about them, stay as they are: point masses.
        """

        def make() -> "mujoco.MjSpec":
            spec = self.make_spec()
            for name, more in extra_kg.items():
                spec.body(name).mass += more
            return spec

        return replace(self, make_spec=make)

    def with_loads(self, loads: Mapping[str, Load]) -> "HiddenPlant":
        """A copy that carries loads, by the name of the body they are fixed to.

        Raises:
          UnknownNameError: the robot has no such body.
        """

        def make() -> "mujoco.MjSpec":
            spec = self.make_spec()
            model = spec.compile()
            for name, load in loads.items():
                _carry(spec.body(name), model.body(name), load)
            return spec

        bare = self.make_spec()
        known = [body.name for body in bare.bodies if body.name != "world"]
        for name in loads:
            if name not in known:
                raise UnknownNameError(f"body of {self.name}", name, known)
        return replace(self, make_spec=make) if loads else self

    def with_gains(self, stiffness: float, damping: float = 1.0) -> "HiddenPlant":
        """A copy of this robot with all kp and kd multiplied, the back-EMF kept."""
        return replace(
            self,
            kp_nm_rad=self.kp_nm_rad * stiffness,
            kd_nm_s_rad=self.kd_nm_s_rad * damping,
        )


def _carry(body: "mujoco.MjsBody", bare: Any, load: Load) -> None:
    """Give a specification's body the inertia that it has with a load.

    `bare` is the same body of the compiled model. Inertias of both are about their
    common centre of mass (the parallel axis theorem).
    """
    import mujoco

    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, bare.iquat)
    axes = turn.reshape(3, 3)
    inertia = axes @ np.diag(bare.inertia) @ axes.T
    masses = np.array([bare.mass[0], load.mass])
    places = np.array([bare.ipos, load.at])
    centre = masses @ places / masses.sum()
    for mass, away in zip(masses, places - centre, strict=True):
        inertia = inertia + mass * (away @ away * np.eye(3) - np.outer(away, away))
    body.explicitinertial = True
    body.mass, body.ipos = masses.sum(), centre
    body.inertia, body.iquat = [0, 0, 0], [1, 0, 0, 0]
    xx, yy, zz = np.diag(inertia)
    body.fullinertia = [xx, yy, zz, inertia[0, 1], inertia[0, 2], inertia[1, 2]]


def hidden_plant(name: str, floating: bool = False) -> HiddenPlant:
    """A nominal robot: "pendulum", "so101", or a name of `groundwalk list robots`.

    GroundwalkError if there is no such robot, or its base cannot float.

    Example:
      >>> float(hidden_plant("pendulum").max_torque_nm[0])
      4.0
    """
    if name in ("pendulum", "so101"):
        if floating:
            raise BadValueError(f"{name} stands on a fixed base")
        if name == "pendulum":
            servo = np.array([8.0, 0.2, 4.0, 6.0])
            return hinged_plant("pendulum", "nominal.xml", PENDULUM, servo)
        # Gains and highest speed are chosen: the package has none.
        servo = np.array([17.0, 0.6, SO101_TORQUE_NM, 4.0])
        return hinged_plant("so101", "nominal.urdf", so101_urdf(), servo)
    return described_hidden_plant(robots.get(name), floating)


def hinged_plant(name: str, file: str, text: str, servo: FloatArray) -> HiddenPlant:
    """A robot of j hinges on a fixed base, from the text of its model file.

    Args:
      name: the robot's name.
      file: file name for the text, which ends in .xml (MJCF) or .urdf.
      text: the model.
      servo: kp [N m/rad], kd [N m s/rad], largest torque [N m] and highest speed of
        commands [rad/s]: (4,) for all joints, or (j, 4).
    """
    import mujoco

    model = mujoco.MjModel.from_xml_string(text)
    joints = tuple(model.joint(i).name for i in range(model.njnt))
    kp, kd, most, speed = np.broadcast_to(servo, (len(joints), 4)).T.copy()
    return HiddenPlant(
        name=name,
        file=(file, text),
        make_spec=lambda: mujoco.MjSpec.from_string(text),
        joints=joints,
        links=tuple(model.body(int(i)).name for i in model.jnt_bodyid),
        kp_nm_rad=kp,
        kd_nm_s_rad=kd,
        max_torque_nm=most,
        back_emf_nm_s_rad=np.zeros(len(joints)),
        range_rad=model.jnt_range.copy(),
        speed_rad_s=speed,
    )


def example_urdf(tail: str) -> str:
    """Text, without meshes, of the URDF in example-robot-data whose path ends so.

    BadValueError if the files of example-robot-data are not installed.
    """
    try:
        files = distribution("example-robot-data").files or []
        path = next(Path(str(f.locate())) for f in files if str(f).endswith(tail))
        text = path.read_text()
    except (PackageNotFoundError, StopIteration, OSError):
        raise BadValueError(
            "the files of example-robot-data are missing; groundwalk doctor tells more"
        ) from None
    shapes = r"<(visual|collision)\b(?:[^<>]*/>|.*?</\1>)"
    return re.sub(shapes, "", text, flags=re.DOTALL)


def so101_urdf() -> str:
    """URDF of example-robot-data's SO-101, with rotors, without meshes, gripper fixed.

    Raises BadValueError if the files of example-robot-data are not installed.
    """
    import mujoco

    spec = mujoco.MjSpec.from_string(example_urdf(_SO101))
    spec.delete(spec.joint(_SO101_HELD))
    return model_urdf(spec.compile(), "so101", SO101_ROTOR_KG_M2, SO101_TORQUE_NM)


def described_hidden_plant(description: Description, floating: bool) -> HiddenPlant:
    """The nominal robot that a description describes.

    Its servos have the stiffness, back-EMF and stall torque of the motors; commands
    may reach 70 % of a motor's no-load speed. The base is free if `floating`.
    """

    def make() -> "mujoco.MjSpec":
        spec = mujoco_spec(description)
        for actuator in list(spec.actuators):
            spec.delete(actuator)
        if not floating:
            spec.delete(spec.joint(ROOT_JOINT))
        return spec

    motors = [link.motor for link in description.links]
    return HiddenPlant(
        name=description.name,
        file=None,
        make_spec=make,
        joints=description.joints,
        links=tuple(joint.link.name for joint in description.links),
        kp_nm_rad=np.array([motor.kp_nm_rad for motor in motors]),
        kd_nm_s_rad=np.zeros(len(motors)),
        max_torque_nm=np.array([motor.stall_torque_nm for motor in motors]),
        back_emf_nm_s_rad=np.array([motor.kd_nm_s_rad for motor in motors]),
        range_rad=description.joint_range_rad,
        speed_rad_s=0.7 * description.no_load_speed_rad_s,
        floating=floating,
        description=description,
    )

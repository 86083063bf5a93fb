"""Random arms of one to seven joints, as MuJoCo models."""

import math
from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np

from groundwalk.arrays import FloatArray
from worlds.recordings.metadata import ServoGains

_STEP_S = 1e-4
"""Physics step [s]: short, so that recordings obey the model and not its integrator."""
_SETTLED_S = 3.0
"""Time [s] in which an arm comes to rest at its first command."""
_AXES = ("0 0 1", "0 1 0")
"""Axes of joints; links lie along x. The first joint has the second one, so that it
carries weight."""
_LINK_M, _LINK_KG = (0.12, 0.35), (0.2, 2.0)
"""Ranges of a link's length and of the first link's mass; each further one has 0.7 of
the mass before."""
_LIGHTER = 0.7
_ARMATURE_KGM2, _DAMPING = (0.005, 0.03), (0.0, 0.3)
"""Ranges of rotor inertia and of viscous friction [N m s/rad]."""
_DRY_NM, _DRY_SHARE = (0.02, 0.2), 1 / 3
"""Range of dry friction, and the share of arms that have it."""
_OWN_RAD_S, _RATIO = (12.0, 25.0), (0.5, 1.0)
"""Ranges of the servo's own frequency and damping ratio with the inertia at rest."""
_MOST_TORQUE_NM = 1e4
"""Torque limit that is stated, far beyond what is needed."""

_ACTUATORS = "<!-- actuators -->"
"""Where actuators are put once the inertia of an arm is known."""

Drive = Literal["actuators", "loop"]
"""What moves an arm: MuJoCo's position actuators, or motors and a loop of its own."""


@dataclass(frozen=True, eq=False)
class RandomArm:
    """A random arm.

    Attributes:
      xml: its MJCF; with position actuators, or motors if a loop drives it.
      joints: names of its joints.
      gains: of their servos, by joint.
      drive: what moves it.
    """

    xml: str
    joints: tuple[str, ...]
    gains: dict[str, ServoGains]
    drive: Drive

    @classmethod
    def drawn(cls, joints: int, drive: Drive, rng: np.random.Generator) -> "RandomArm":
        """Draw an arm with so many joints."""
        names = tuple(f"joint{number}" for number in range(1, joints + 1))
        bare = _model(_bodies(names, rng))
        inertia = mujoco.MjModel.from_xml_string(bare).dof_M0  # the arm is stretched
        own, ratio = rng.uniform(*_OWN_RAD_S, joints), rng.uniform(*_RATIO, joints)
        kp, kd = inertia * own**2, 2 * ratio * own * inertia
        gains = {
            name: ServoGains(round(float(p), 4), round(float(d), 5), _MOST_TORQUE_NM)
            for name, p, d in zip(names, kp, kd, strict=True)
        }
        actuators = "\n".join(_actuator(name, gains[name], drive) for name in names)
        return cls(bare.replace(_ACTUATORS, actuators), names, gains, drive)

    def moved(self, command_rad: FloatArray, tick_s: float) -> FloatArray:
        """(T, j) angles at each tick when commands (T, j) are held for a tick each.

        The arm has settled at the first command before.
        """
        model = mujoco.MjModel.from_xml_string(self.xml)
        data: Any = mujoco.MjData(model)
        data.qpos[:] = command_rad[0]
        kp = np.array([self.gains[name].kp for name in self.joints])
        kd = np.array([self.gains[name].kd for name in self.joints])

        def advance(target: FloatArray, steps: int) -> None:
            for _ in range(steps):
                if self.drive == "actuators":
                    data.ctrl[:] = target
                else:
                    data.ctrl[:] = kp * (target - data.qpos) - kd * data.qvel
                mujoco.mj_step(model, data)

        advance(command_rad[0], round(_SETTLED_S / _STEP_S))
        steps, angles = round(tick_s / _STEP_S), np.empty_like(command_rad)
        for row, target in enumerate(command_rad):
            angles[row] = data.qpos
            advance(target, steps)
        return angles


def _model(bodies: str) -> str:
    """MJCF of an arm without contacts, and without actuators yet."""
    return f"""<mujoco model="arm">
  <compiler angle="radian"/>
  <option timestep="{_STEP_S}" integrator="implicitfast">
    <flag contact="disable"/>
  </option>
  <worldbody>
{bodies}  </worldbody>
  <actuator>
{_ACTUATORS}
  </actuator>
</mujoco>
"""


def _bodies(joints: tuple[str, ...], rng: np.random.Generator) -> str:
    """Nested bodies: each link hangs by a joint at the end of the one before."""
    mass_kg, dry = rng.uniform(*_LINK_KG), rng.uniform() < _DRY_SHARE
    text, ends, start_m = "", "", 0.0
    for number, joint in enumerate(joints):
        length_m = rng.uniform(*_LINK_M)
        axis = _AXES[int(rng.integers(len(_AXES))) if number else 1]
        low, high = np.log(_DRY_NM)
        dry_nm = math.exp(rng.uniform(low, high)) if dry else 0.0
        text += (
            f'    <body name="link{number + 1}" pos="{start_m:.4f} 0 0">\n'
            f'      <joint name="{joint}" axis="{axis}" '
            f'armature="{rng.uniform(*_ARMATURE_KGM2):.4f}" '
            f'damping="{rng.uniform(*_DAMPING):.4f}" frictionloss="{dry_nm:.4f}"/>\n'
            f'      <geom type="capsule" size="0.025" mass="{mass_kg:.4f}" '
            f'fromto="0 0 0 {length_m:.4f} 0 0"/>\n'
        )
        ends += "    </body>\n"
        mass_kg, start_m = _LIGHTER * mass_kg, length_m
    return text + ends


def _actuator(joint: str, gains: ServoGains, drive: Drive) -> str:
    if drive == "actuators":
        return f'    <position joint="{joint}" kp="{gains.kp}" kv="{gains.kd}"/>'
    return f'    <motor joint="{joint}"/>'

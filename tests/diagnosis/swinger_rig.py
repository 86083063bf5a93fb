"""A box that stands on four balls and swings two arms, as MuJoCo moves it."""

from dataclasses import replace

import mujoco
import numpy as np
from joint_rigs import servo_of

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace

KP, KD = 12.0, 0.6
STEP_S, TICK_S = 2.5e-4, 0.01
NOISE_RAD, PLACE_NOISE_M = 4e-4, 2e-4
JOINTS = "left", "right"
_BALLS = "".join(
    f'<geom type="sphere" size=".01" pos="{x} {y} -.09" conaffinity="0"/>'
    for x in (-0.1, 0.1)
    for y in (-0.08, 0.08)
)
_ARMS = "".join(
    f"""<body name="{name}_arm" pos="0 {y} .05"><joint name="{name}" axis="0 1 0"/>
    <inertial pos="0 0 -.12" mass=".5" diaginertia=".002 .002 .001"/></body>"""
    for name, y in zip(JOINTS, (0.06, -0.06), strict=True)
)
_SERVOS = "".join(
    f'<general name="{name}" joint="{name}" biastype="affine"/>' for name in JOINTS
)
XML = f"""<mujoco><option integrator="implicitfast"><flag autoreset="disable"/></option>
  <worldbody>
  <geom name="ground" type="plane" size="0 0 1" contype="0" conaffinity="1"/>
  <body name="box" pos="0 0 .1"><freejoint name="root"/>
  <inertial pos="0 0 0" mass="3" diaginertia=".02 .02 .03"/>{_BALLS}{_ARMS}</body>
  </worldbody><actuator>{_SERVOS}</actuator></mujoco>"""


def swinger():
    """The plant."""
    spec = mujoco.MjSpec.from_string(XML)
    return Plant("swinger", spec, JOINTS, servo_of(2, KP, KD), "floating", ("box",))


def command(time_s, seed):
    """(T, 2) sums of sines that begin at rest."""
    random = np.random.default_rng(seed)
    phases, rates = random.uniform(0, 6, (2, 3)), random.uniform(3, 9, (2, 3))
    waves = np.sin(rates[:, :, None] * time_s + phases[:, :, None]).sum(axis=1)
    return ((1 - np.exp(-((time_s / 0.3) ** 2))) * 0.3 * waves).T


def moved(seed, gain=(1.0, 1.0), load=None, duration_s=3.0, noise=1.0):
    """A recording.

    Args:
      seed: of command and noise.
      gain: of the servos' stiffness, as a factor.
      load: (2,) torque of something else, from time, positions and velocities.
      duration_s: how long.
      noise: factor of the sensors' noise.
    """
    model = mujoco.MjModel.from_xml_string(XML)
    model.opt.timestep = STEP_S
    data = mujoco.MjData(model)
    time_s = np.arange(round(duration_s / TICK_S)) * TICK_S
    asked, kp = command(time_s, seed), KP * np.array(gain)
    rows = []
    for target in asked:
        rows.append(np.concatenate([data.qpos, data.qvel]))
        for _ in range(round(TICK_S / STEP_S)):
            q, v = data.qpos[7:], data.qvel[6:]
            torque = kp * (target - q) - KD * v
            data.qfrc_applied[6:] = torque + (load(data.time, q, v) if load else 0.0)
            mujoco.mj_step(model, data)
    seen = np.array(rows)
    random = np.random.default_rng(seed + 1000)
    seen[:, :3] += noise * PLACE_NOISE_M * random.standard_normal((len(seen), 3))
    seen[:, 3:9] += noise * NOISE_RAD * random.standard_normal((len(seen), 6))
    turn = seen[:, 3:7] / np.linalg.norm(seen[:, 3:7], axis=1, keepdims=True)
    return Trace(
        f"swing {seed}",
        time_s,
        seen[:, 7:9],
        servo_of(2, KP, KD),
        command_rad=asked,
        base_position_m=seen[:, :3],
        base_orientation=turn,
    )


def with_speeds(trace, linear_m_s, angular_rad_s):
    """The trace, with constant measured speeds of the base."""
    rows = trace.ticks
    return replace(
        trace,
        base_linear_velocity_m_s=np.tile(linear_m_s, (rows, 1)),
        base_angular_velocity_rad_s=np.tile(angular_rad_s, (rows, 1)),
    )

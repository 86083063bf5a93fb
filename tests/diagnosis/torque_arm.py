"""An arm of three joints that some controller moves, of which only torques are known.

MuJoCo simulates it, with its own friction; nothing of the diagnosis is used.
"""

import mujoco
import numpy as np
from joint_rigs import servo_of

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace

JOINTS = "yaw", "shoulder", "elbow"
LINKS = "turret", "upper", "lower"
LOWER_KG = 1.5
STEP_S, TICK_S = 5e-4, 0.01
NOISE_RAD, NOISE_NM = 2e-5, 0.05
XML = f"""<mujoco>
  <option integrator="implicitfast"><flag autoreset="disable"/></option>
  <worldbody>
  <body name="turret" simple="false"><joint name="yaw" axis="0 0 1"/>
    <inertial pos="0 0 .1" mass="4" diaginertia=".05 .05 .04"/>
  <body name="upper" simple="false" pos="0 0 .3"><joint name="shoulder" axis="0 1 0"/>
    <inertial pos=".2 0 .02" mass="3" diaginertia=".005 .04 .04"/>
  <body name="lower" simple="false" pos=".4 0 0"><joint name="elbow" axis="0 1 0"/>
    <inertial pos=".15 .01 0" mass="{LOWER_KG}" diaginertia=".002 .01 .01"/>
  </body></body></body></worldbody>
  <actuator>{
    "".join(
        f'<general name="{name}" joint="{name}" biastype="affine"/>' for name in JOINTS
    )
}</actuator></mujoco>"""


def arm(lower_kg=LOWER_KG):
    """The nominal model, of whose servos nothing is known."""
    spec = mujoco.MjSpec.from_string(XML)
    spec.body("lower").mass = lower_kg
    return Plant("arm", spec, JOINTS, servo_of(3))


def wanted(time_s, seed):
    """(3,) angles that the controller wants: sums of sines that begin at rest."""
    random = np.random.default_rng(seed)
    phases, rates = random.uniform(0, 6, (2, 3, 4)), random.uniform(0.5, 4, (2, 3, 4))
    rise = 1 - np.exp(-((time_s / 0.5) ** 2))
    return rise * 0.3 * np.sin(rates[0] * time_s + phases[0]).sum(axis=1)


def moved(change=None, seed=0, duration_s=10.0, noise_rad=NOISE_RAD, scale=(1, 1, 1)):
    """A recording of positions and motor torques.

    Args:
      change: function that changes the true MjModel.
      seed: of motion and noise.
      duration_s: how long.
      noise_rad: of the encoders.
      scale: measured over true torque of each joint.
    """
    model = mujoco.MjModel.from_xml_string(XML)
    model.opt.timestep = STEP_S
    if change is not None:
        change(model)
        mujoco.mj_setConst(model, mujoco.MjData(model))
    data, rows, torques = mujoco.MjData(model), [], []
    times = np.arange(round(duration_s / TICK_S)) * TICK_S
    total = np.zeros(3)
    for _ in times:
        rows.append(data.qpos.copy())
        for step in range(round(TICK_S / STEP_S)):
            error = wanted(data.time, seed) - data.qpos
            total += error * STEP_S
            torque = 600 * error - 40 * data.qvel + 400 * total
            data.qfrc_applied[:] = torque
            mujoco.mj_step(model, data)
            if step == 0:
                torques.append(torque)
    random = np.random.default_rng(seed + 1000)
    position = np.array(rows) + noise_rad * random.standard_normal((len(rows), 3))
    seen = np.array(torques) * scale + NOISE_NM * random.standard_normal((len(rows), 3))
    return Trace(f"arm {seed}", times, position, servo_of(3), torque_nm=seen)


def loaded(mass_kg, link):
    """A change that puts a point mass at the centre of mass of a link."""

    def change(model):
        model.body_mass[model.body(link).id] += mass_kg

    return change


def rubbing(coulomb_nm, viscous_nm_s_rad):
    """A change that gives all joints dry and viscous friction."""

    def change(model):
        model.dof_frictionloss[:] = coulomb_nm
        model.dof_solimp[:] = 0.999, 0.9999, 0.001, 0.5, 2
        model.dof_solref[:] = -1, -1 / STEP_S
        model.dof_damping[:] = viscous_nm_s_rad

    return change

"""Small plants whose motion is known, and what an integrator says of them."""

from itertools import pairwise

import mujoco
import numpy as np
from scipy.integrate import solve_ivp

from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run

INERTIA = 0.02
"""Of the wheel and of the pendulum, about their axes [kg m^2]."""
PENDULUM_MASS_KG, PENDULUM_ARM_M, GRAVITY = 0.5, 0.1, 9.81
PENDULUM_LEVER_NM = PENDULUM_MASS_KG * GRAVITY * PENDULUM_ARM_M

WHEEL = f"""<body name="wheel"><joint name="hinge" axis="0 0 1"/>
  <inertial pos="0 0 0" mass="1" diaginertia="1 1 {INERTIA}"/></body>"""
_CENTRAL = INERTIA - PENDULUM_MASS_KG * PENDULUM_ARM_M**2
PENDULUM = f"""<body name="rod"><joint name="hinge" axis="0 -1 0"/>
  <inertial pos="0 0 -{PENDULUM_ARM_M}" mass="{PENDULUM_MASS_KG}"
            diaginertia="{_CENTRAL} {_CENTRAL} 1e-3"/></body>"""
SLED_KG = 2.0
SLED = f"""<body name="sled"><joint name="slide" type="slide" axis="1 0 0"/>
  <inertial pos="0 0 0" mass="{SLED_KG}" diaginertia="1 1 1"/></body>"""
LINKS_KG, LINKS_M = (0.6, 0.4), (0.25, 0.2)
ARM = f"""<body name="upper"><joint name="shoulder" axis="0 -1 0"/>
  <inertial pos="0 0 -{LINKS_M[0]}" mass="{LINKS_KG[0]}" diaginertia=".001 .001 .001"/>
  <body name="lower" pos="0 0 -{LINKS_M[0]}"><joint name="elbow" axis="0 -1 0"/>
  <inertial pos="0 0 -{LINKS_M[1]}" mass="{LINKS_KG[1]}" diaginertia=".001 .001 .001"/>
  </body></body>"""
LINK_INERTIA = 0.001


def servo_of(joints, kp=0.0, kd=0.0, limit=np.inf, emf=0.0):
    """The same servo at each joint."""
    return Servo(*(np.full(joints, float(value)) for value in (kp, kd, limit, emf)))


def plant_of(body, armature=0.0, **gains):
    """A plant of one of the bodies above; actuators as a plant must have them."""
    joints = tuple(
        part.split('"')[0] for part in body.split('joint name="')[1:] if part
    )
    actuators = "".join(
        f'<general name="{joint}" joint="{joint}" biastype="affine"/>'
        for joint in joints
    )
    servo = servo_of(len(joints), **gains)
    emf = servo.back_emf_nm_s_rad[0]
    xml = f"""<mujoco>
      <option integrator="implicitfast"><flag autoreset="disable"/></option>
      <default><joint damping="{emf}" armature="{armature}"/></default>
      <worldbody>{body}</worldbody><actuator>{actuators}</actuator></mujoco>"""
    return Plant("rig", mujoco.MjSpec.from_string(xml), joints, servo)


def ticks(duration_s, tick_s=0.01, start_s=0.0):
    return start_s + np.arange(round(duration_s / tick_s) + 1) * tick_s


def trace_of(plant, time_s, position_rad=None, **channels):
    """A trace of single columns or of (T, j) arrays."""
    shape = (len(time_s), len(plant.joints))
    channels = {
        name: np.broadcast_to(np.reshape(values, (-1, shape[1])), shape).astype(float)
        for name, values in channels.items()
    }
    if position_rad is None:
        position_rad = np.zeros(shape)
    position_rad = np.asarray(position_rad, float).reshape(shape)
    return Trace("made up", time_s, position_rad, plant.servo, **channels)


def run_from(trace, position_rad=0.0, velocity_rad_s=0.0):
    """A trace from a start that is known."""
    j = trace.position_rad.shape[1]
    start = (
        np.broadcast_to(x, j).astype(float) for x in (position_rad, velocity_rad_s)
    )
    return Run(trace, *start)


def replayed(plant, run, *effects, step_s=1e-3):
    """Positions (T, j) and velocities of a run; effects are (name, place, *values)."""
    model = tuple(PlacedEffect(name, place, values) for name, place, *values in effects)
    (result,) = replay([run], variants_of(plant, [model]), step_s)
    return result.position_rad[0], result.velocity_rad_s[0]


def exact(plant, run, *effects, step_s=1e-3):
    """Positions (T, j) as the step goes to 0: the first order is taken out."""
    coarse, _ = replayed(plant, run, *effects, step_s=step_s)
    fine, _ = replayed(plant, run, *effects, step_s=step_s / 2)
    return 2 * fine - coarse


def stiffly_integrated(law, time_s, start):
    """As `integrated`, where some of the states follow at once."""
    return integrated(law, time_s, start, method="LSODA")


def integrated(law, time_s, start, method="RK45"):
    """(T, states) of y' = law(t, y, k), row k by row, as commands change by rows.

    k is the row whose command holds.
    """
    states = [np.asarray(start, float)]
    for k, (begin, end) in enumerate(pairwise(time_s)):
        part = solve_ivp(
            law, (begin, end), states[-1], method, args=(k,), rtol=1e-8, atol=1e-10
        )
        states.append(part.y[:, -1])
    return np.array(states)


def smooth_command(time_s):
    """(T,) a motion that begins at rest at 0, with two frequencies."""
    rise = 1 - np.exp(-((time_s / 0.15) ** 2))
    return rise * (0.3 * np.sin(5 * time_s) + 0.1 * np.sin(13 * time_s))


def arm_law(torque_nm):
    """y' of the two links for torques (t, q, v) -> (2,); y = q1, q2, v1, v2.

    Textbook equations of a planar arm (Craig 2005, section 6.7, with inertias about
    the centres of mass, which are at the links' ends); angles from hanging down.
    """
    (m1, m2), (l1, l2), g = LINKS_KG, LINKS_M, GRAVITY

    def law(t, y, k):
        q1, q2, v1, v2 = y
        c2, s2 = np.cos(q2), np.sin(q2)
        m22 = m2 * l2**2 + LINK_INERTIA
        m12 = m22 + m2 * l1 * l2 * c2
        m11 = (m1 + m2) * l1**2 + LINK_INERTIA + m22 + 2 * m2 * l1 * l2 * c2
        fold = m2 * l1 * l2 * s2
        t1, t2 = torque_nm(t, y[:2], y[2:], k)
        g2 = m2 * g * l2 * np.sin(q1 + q2)
        g1 = (m1 + m2) * g * l1 * np.sin(q1) + g2
        r1 = t1 + fold * (2 * v1 * v2 + v2**2) - g1
        r2 = t2 - fold * v1**2 - g2
        det = m11 * m22 - m12**2
        return [v1, v2, (m22 * r1 - m12 * r2) / det, (m11 * r2 - m12 * r1) / det]

    return law

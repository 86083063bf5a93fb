"""A pendulum that follows three sines, for the tests of baselines.

The truth is MuJoCo at a quarter of a millisecond, driven by a servo written here.
"""

import mujoco
import numpy as np

from diagnosis.traces.trace import Trace

XML = """<mujoco model="pendulum"><compiler angle="radian"/><worldbody>
<body name="link"><joint name="swing" axis="0 1 0" range="-3 3"/>
<inertial pos="0 0 -0.3" mass="0.5" diaginertia="0.002 0.002 0.001"/></body>
</worldbody></mujoco>"""
KP, KD, LIMIT = 8.0, 0.2, 4.0
STEP_S, TICK_S, QUANTUM_RAD = 0.00025, 0.01, 0.0005


def swing(plant, seed, damping=0.0, dry=0.0, gain=1.0, seconds=4.0):
    """A recording of the pendulum following three sines, with physics added."""
    spec = mujoco.MjSpec.from_string(XML)
    spec.option.timestep = STEP_S
    spec.joint("swing").damping[0] = damping
    spec.joint("swing").frictionloss = dry
    model = spec.compile()
    model.dof_solimp[:] = (0.999, 0.9999, 0.001, 0.5, 2.0)
    model.dof_solref[:] = (2 * STEP_S, 1.0)
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    phase, ticks = rng.uniform(0, 2 * np.pi, 3), round(seconds / TICK_S) + 1
    time_s = TICK_S * np.arange(ticks)
    waves = np.sin(2 * np.pi * np.outer(time_s, (0.3, 0.8, 1.7)) + phase)
    command = waves @ np.array([0.5, 0.3, 0.15])
    data.qpos[0] = command[0]
    position = np.zeros(ticks)
    for row in range(ticks):
        position[row] = data.qpos[0]
        for _ in range(round(TICK_S / STEP_S)):
            torque = gain * KP * (command[row] - data.qpos[0]) - KD * data.qvel[0]
            data.qfrc_applied[0] = np.clip(torque, -LIMIT, LIMIT)
            mujoco.mj_step(model, data)
    position += rng.normal(0, 0.0003, ticks)
    measured = np.round(position / QUANTUM_RAD) * QUANTUM_RAD
    name = f"swing_{seed}"
    return Trace(name, time_s, measured[:, None], plant.servo, None, command[:, None])

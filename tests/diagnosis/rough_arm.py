"""An arm of three joints with servos, which rubs and cogs far more than its model does.

MuJoCo simulates it; nothing of the diagnosis is used. It is not quite the same in all
recordings, as no real robot is.
"""

from dataclasses import replace

import mujoco
import numpy as np
from joint_rigs import servo_of
from torque_arm import JOINTS, STEP_S, TICK_S, XML, wanted

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace

KP, KD, NOISE_RAD = 150.0, 6.0, 2e-4
ROUGH_NM, SMOOTH_NM = (3.0, 4.0, 1.5), (0.05, 0.08, 0.03)


def stiff_arm():
    """The nominal model, with its servos."""
    spec = mujoco.MjSpec.from_string(XML)
    return Plant("arm", spec, JOINTS, servo_of(3, KP, KD))


def followed(change=None, seed=0, duration_s=12.0, friction_nm=ROUGH_NM):
    """A recording of positions and commands.

    Args:
      change: function that changes the true MjModel.
      seed: of motion, noise and what differs from recording to recording.
      duration_s: how long.
      friction_nm: of the joints; it is not in the nominal model.
    """
    model = mujoco.MjModel.from_xml_string(XML)
    model.opt.timestep = STEP_S
    if change is not None:
        change(model)
        mujoco.mj_setConst(model, mujoco.MjData(model))
    random = np.random.default_rng(seed + 1000)
    today = np.array(friction_nm) * (1 + 0.03 * random.standard_normal(3))
    data, rows, commands = mujoco.MjData(model), [], []
    for k in range(round(duration_s / TICK_S)):
        rows.append(data.qpos.copy())
        command = wanted(k * TICK_S, seed)
        commands.append(command)
        for _ in range(round(TICK_S / STEP_S)):
            torque = KP * (command - data.qpos) - KD * data.qvel
            rubs = today * np.tanh(data.qvel / 0.02) * (1 + 0.3 * np.sin(9 * data.qpos))
            data.qfrc_applied[:] = torque - rubs
            mujoco.mj_step(model, data)
    position = np.array(rows) + NOISE_RAD * random.standard_normal((len(rows), 3))
    times, servo = np.arange(len(rows)) * TICK_S, servo_of(3, KP, KD)
    return Trace(f"arm {seed}", times, position, servo, command_rad=np.array(commands))


def declaring(trace, joint, factor):
    """A recording whose servo is declared `factor` times as stiff at one joint."""
    kp = trace.servo.kp_nm_rad.copy()
    kp[JOINTS.index(joint)] *= factor
    return replace(trace, servo=replace(trace.servo, kp_nm_rad=kp))


def hurried(trace, ticks):
    """A recording whose commands are written some ticks early."""
    rows = slice(ticks, None)
    return replace(
        trace,
        time_s=trace.time_s[:-ticks],
        position_rad=trace.position_rad[:-ticks],
        command_rad=trace.command_rad[rows],
    )

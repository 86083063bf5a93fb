"""A folder of made-up recordings and models in the layout of the real ones.

Two-joint arms are simulated here with MuJoCo and a servo law written out, so that what
a doctoring does can be checked against a simulation; other robots only wave.
"""

import json

import mujoco
import numpy as np

from worlds.recordings import (
    Recording,
    RecordingMetadata,
    ServoGains,
    write_recording,
)

ARM = """<mujoco model="arm"><compiler angle="radian"/>
<option timestep="0.001" integrator="implicitfast"/>
<worldbody>
 <body name="link02" pos="0 0 0.1">
  <joint name="joint2" axis="0 1 0"/>
  <inertial pos="0.15 0 0" mass="1.0" diaginertia="0.002 0.01 0.01"/>
  <body name="link03" pos="0.3 0 0">
   <joint name="joint3" axis="0 1 0"/>
   <inertial pos="0.1 0 0" mass="0.6" diaginertia="0.001 0.004 0.004"/>
  </body>
 </body>
</worldbody></mujoco>"""
PUBLISHED = {
    joint: {"armature": "0.0001", "frictionloss": "0.4", "damping": "0.4"}
    for joint in ("joint2", "joint3")
}
"""What the simulated arm has."""
GAINS = ServoGains(60.0, 1.5, 30.0)
SWINGS = {"joint2": (0.4, 0.7), "joint3": (0.5, 1.6)}
"""Amplitude [rad] and frequency [Hz] of each joint's command."""
TICK_S, STEPS = 0.005, 5
NOISE_RAD = 5e-5
SO101_JOINTS = (
    "shoulder_pan",
    "shoulder_lift",
    "elbow_flex",
    "wrist_flex",
    "wrist_roll",
)
CARRIAGE = """<mujoco model="emps"><option gravity="0 0 0"/><worldbody>
<body name="carriage"><joint name="carriage" type="slide" axis="1 0 0"/>
<geom type="box" size="0.1 0.1 0.05" mass="95.11"/></body></worldbody>
<actuator><position name="carriage" joint="carriage" kp="1e6" kv="8e3"/></actuator>
</mujoco>"""


def arm_recording(duration_s, begin_s):
    """The arm of `ARM`, driven by servos with `GAINS`, as noisy encoders see it."""
    spec = mujoco.MjSpec.from_string(ARM)
    for joint in spec.joints:  # damping of the servos, implicit as in a real one
        joint.damping = [GAINS.kd + float(PUBLISHED[joint.name]["damping"]), 0, 0]
        joint.frictionloss = float(PUBLISHED[joint.name]["frictionloss"])
    model = spec.compile()
    data = mujoco.MjData(model)
    rows = round(duration_s / TICK_S)
    time_s = np.arange(rows) * TICK_S
    commands = np.stack(
        [a * np.sin(2 * np.pi * f * (time_s + begin_s)) for a, f in SWINGS.values()], 1
    )
    data.qpos[:] = commands[0]
    encoder = np.random.default_rng(round(begin_s))
    positions = np.empty_like(commands)
    for k, command in enumerate(commands):
        positions[k] = data.qpos
        for _ in range(STEPS):
            data.qfrc_applied[:] = GAINS.kp * (command - data.qpos)
            mujoco.mj_step(model, data)
    columns = {"time": time_s}
    for j, joint in enumerate(SWINGS):
        columns[f"position.{joint}"] = positions[:, j] + encoder.normal(
            0, NOISE_RAD, rows
        )
        columns[f"command.{joint}"] = commands[:, j]
    servo = dict.fromkeys(SWINGS, GAINS)
    return Recording(columns, RecordingMetadata("m.xml", "fixed", "made up", servo))


def waving(joints, duration_s, tick_s, quantities, number=0):
    """A recording in which all joints wave, each at a frequency of its own."""
    time_s = np.arange(round(duration_s / tick_s)) * tick_s
    columns = {"time": time_s}
    for j, joint in enumerate(joints):
        wave = 0.3 * np.sin((1 + 0.7 * j + 0.1 * number) * time_s)
        columns |= {f"{quantity}.{joint}": wave for quantity in quantities}
        if "command" in quantities:  # what a servo needs to follow
            columns[f"command.{joint}"] = 1.2 * wave
    return Recording(columns, RecordingMetadata("m.xml", "fixed", f"wave {number}"))


def carriage_recording(duration_s):
    """The carriage of `CARRIAGE`, shaken, with the force that this takes."""
    time_s = np.arange(round(duration_s / 0.001)) * 0.001
    wave, faster = np.sin(9 * time_s), np.sin(23 * time_s)
    columns = {
        "time": time_s,
        "position.carriage": 0.1 * wave + 0.02 * faster,
        "command.carriage": 0.1 * wave + 0.02 * faster,
        "torque.carriage": -95.11 * (81 * 0.1 * wave + 529 * 0.02 * faster),
    }
    return Recording(columns, RecordingMetadata("m.xml", "fixed", "shaken"))


def write_arm(data):
    folder = data / "labelled" / "z1_arm"
    folder.mkdir(parents=True)
    (folder / "model.xml").write_text(ARM)
    effects = [
        {"name": "coulomb_friction", "place": joint, "published": values}
        for joint, values in PUBLISHED.items()
    ]
    (folder / "truth.json").write_text(json.dumps({"effects": effects}))
    for k, name in enumerate("ab"):
        path = folder / "recordings" / f"{name}.parquet"
        write_recording(arm_recording(4.0, 4.0 * k), path)


def write_data(data):
    """Write recordings of three robots: z1, so101 and emps."""
    write_arm(data)
    for k in range(8):
        duration_s = 40.0 if k else 15.0
        one = waving(SO101_JOINTS, duration_s, 0.02, ("position", "command"), k)
        write_recording(one, data / "so101" / f"wave{k}.parquet")
    write_recording(carriage_recording(6.0), data / "emps" / "sweep.parquet")
    (data / "emps" / "emps.xml").write_text(CARRIAGE)

"""Things of a user's own that no page knows: arms, their recordings, a picture.

The recordings are made here with MuJoCo alone and written with the standard library, as
somebody would who has never seen this project's code.
"""

import csv
import json
import struct

import mujoco
import numpy as np

KP, KD, MAX_TORQUE = 60.0, 3.0, 40.0
STEP_S, TICK_S = 5e-4, 0.01
NOISE_RAD = 2e-4

LINKS = (  # axis, offset of the joint [m], length of the link [m], mass [kg]
    ("0 0 1", 0.08, 0.06, 2.1),
    ("0 1 0", 0.06, 0.31, 1.7),
    ("0 1 0", 0.31, 0.27, 1.2),
    ("1 0 0", 0.27, 0.05, 0.6),
    ("0 1 0", 0.05, 0.09, 0.4),
    ("1 0 0", 0.09, 0.06, 0.25),
)


def arm_urdf():
    """An arm of six hinges on a table."""
    parts = ['<robot name="six"><link name="table"/>']
    parent = "table"
    for k, (axis, offset_m, length_m, mass_kg) in enumerate(LINKS, 1):
        along = mass_kg * length_m**2 / 12 + 1e-3
        parts.append(
            f'<link name="link_{k}"><inertial><origin xyz="0 0 {length_m / 2}"/>'
            f'<mass value="{mass_kg}"/><inertia ixx="{along}" iyy="{along}" '
            f'izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="axis_{k}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link_{k}"/><origin xyz="0 0 {offset_m}"/>'
            f'<axis xyz="{axis}"/><limit lower="-2.5" upper="2.5" '
            f'effort="{MAX_TORQUE}" velocity="6"/></joint>'
        )
        parent = f"link_{k}"
    return "".join([*parts, "</robot>"])


def arm_mjcf():
    """Two hinges whose links are meshes, read from `wedge.stl` beside the file."""
    return """
<mujoco model="two">
  <compiler angle="radian"/>
  <asset><mesh name="wedge" file="wedge.stl"/></asset>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" range="-3 3" limited="true"/>
      <inertial pos="0 0 -0.15" mass="1.1" diaginertia="0.01 0.01 0.001"/>
      <geom type="mesh" mesh="wedge" contype="0" conaffinity="0"/>
      <body name="lower" pos="0 0 -0.3">
        <joint name="elbow" axis="0 1 0" range="-3 3" limited="true"/>
        <inertial pos="0 0 -0.12" mass="0.7" diaginertia="0.005 0.005 0.0005"/>
        <geom type="mesh" mesh="wedge" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def wedge_stl():
    """A tetrahedron as a binary STL file."""
    corners = np.array([[0, 0, 0], [0.04, 0, 0], [0, 0.04, 0], [0, 0, -0.25]])
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    content = bytes(80) + struct.pack("<I", len(faces))
    for face in faces:
        content += struct.pack("<12fH", 0, 0, 0, *corners[list(face)].ravel(), 0)
    return content


def sway(model, seed, duration_s, friction_nm):
    """(T,) times, (T, j) commands and measured positions under PD servos.

    Args:
      model: MuJoCo's, with hinges only.
      seed: of the motion's phases and of the encoders' noise.
      duration_s: of the recording.
      friction_nm: dry friction of some joints, by name; the model file has none.
    """
    for name, value in friction_nm.items():
        model.dof_frictionloss[model.joint(name).dofadr[0]] = value
    model.opt.timestep, j = STEP_S, model.nv
    rng = np.random.default_rng(seed)
    rates, phases = rng.uniform(1.5, 4.0, (3, j)), rng.uniform(0, 2 * np.pi, (3, j))
    time_s = np.arange(0, duration_s, TICK_S)
    waves = np.sin(time_s[:, None, None] * rates + phases) - np.sin(phases)
    command = 0.15 * waves.sum(axis=1)
    data = mujoco.MjData(model)
    position = np.empty_like(command)
    for k, target in enumerate(command):
        position[k] = data.qpos
        for _ in range(round(TICK_S / STEP_S)):
            asked = KP * (target - data.qpos) - KD * data.qvel
            data.qfrc_applied[:] = np.clip(asked, -MAX_TORQUE, MAX_TORQUE)
            mujoco.mj_step(model, data)
    return time_s, command, position + NOISE_RAD * rng.standard_normal(position.shape)


def write_csv(path, robot, model, seed, duration_s, friction_nm):
    """A recording as CSV, and what belongs to it as JSON beside it."""
    joints = [model.joint(k).name for k in range(model.njnt)]
    time_s, command, position = sway(model, seed, duration_s, friction_nm)
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(
            [
                "time",
                *(f"command.{j}" for j in joints),
                *(f"position.{j}" for j in joints),
            ]
        )
        rows.writerows(np.column_stack([time_s, command, position]).tolist())
    servo = {"kp": KP, "kd": KD, "max_torque": MAX_TORQUE}
    about = {
        "format": 1,
        "robot": robot,
        "base": "fixed",
        "source": "made for a test",
        "servo": dict.fromkeys(joints, servo),
    }
    path.with_suffix(".json").write_text(json.dumps(about))

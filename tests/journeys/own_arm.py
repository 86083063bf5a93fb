"""An arm of a user's own, with logs that its user's own program wrote, or LeRobot.

Made with MuJoCo alone: hobby servos behind three hinges, one of which rubs, CSV files
with degrees and milliseconds, and a data set of two episodes with degrees.
"""

import csv

import mujoco
import numpy as np
from foreign_files import write_lerobot

KP, BACK_EMF, MAX_TORQUE, ROTOR = 24.92, 0.6662, 4.744, 0.01195
"""MX-64 at 12 V with a P gain of 32, from kt = 1.622 N m/A and R = 3.949 ohm."""
FRICTION_NM = 0.25
"""Dry friction of the elbow, of which the URDF knows nothing."""
STEP_S, TICK_S, DURATION_S, NOISE_RAD = 2e-5, 0.01, 8.0, 3e-4
FRAMES_HZ = 50
"""Rate of the data set."""
JOINTS = ("shoulder", "elbow", "wrist")
LINKS = ((0.22, 0.45), (0.18, 0.30), (0.10, 0.15))
"""Length [m] and mass [kg] of each link."""


def arm_urdf():
    """Three links in a row that turn about the same horizontal axis."""
    parts, parent, offset_m = ['<robot name="my_arm"><link name="base"/>'], "base", 0.1
    for name, (length_m, mass_kg) in zip(JOINTS, LINKS, strict=True):
        inertia = mass_kg * length_m**2 / 12
        parts.append(
            f'<link name="{name}_link"><inertial><origin xyz="0 0 {length_m / 2}"/>'
            f'<mass value="{mass_kg}"/><inertia ixx="{inertia}" iyy="{inertia}" '
            f'izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
            f'<child link="{name}_link"/><origin xyz="0 0 {offset_m}"/>'
            f'<axis xyz="0 1 0"/><limit lower="-2.0" upper="2.0" effort="5" '
            f'velocity="6"/></joint>'
        )
        parent, offset_m = f"{name}_link", length_m
    return "".join([*parts, "</robot>"])


def write_own_arm(folder):
    """`my_arm.urdf`, two logs in the folder `logs`, and `tuesday.csv`."""
    (folder / "my_arm.urdf").write_text(arm_urdf())
    (folder / "logs").mkdir()
    for seed, (name, motion) in enumerate(MOTIONS.items()):
        place = folder if name == "tuesday" else folder / "logs"
        moved = _moved(motion, np.random.default_rng(seed))
        _write_log(place / f"{name}.csv", *moved)


def write_own_episodes(folder):
    """The data set `arm_episodes`, for `my_arm.urdf`."""
    episodes = []
    for seed, motion in enumerate((_ramps, _chirp)):
        random = np.random.default_rng(10 + seed)
        _, command, position = _moved(motion, random, 1 / FRAMES_HZ)
        episodes.append((np.degrees(position), np.degrees(command)))
    names = [f"{joint}.pos" for joint in JOINTS]
    write_lerobot(folder / "arm_episodes", episodes, names, rate_hz=FRAMES_HZ)


def _ramps(t, k):
    return 0.5 * (2 * np.abs(2 * ((t / (3.1 + 0.4 * k)) % 1) - 1) - 1)


def _chirp(t, k):
    return 0.2 * np.sin(2 * np.pi * (0.3 * t + (0.1 + 0.02 * k) * t**2))


def _waves(t, k):
    return 0.3 * np.sin((2.1 + 0.5 * k) * t) + 0.1 * np.sin((5.3 - k) * t)


MOTIONS = {"ramps": _ramps, "chirp": _chirp, "tuesday": _waves}


def _moved(motion, rng, tick_s=TICK_S):
    """(T,) times [s], (T, 3) commands and measured angles [rad]."""
    spec = mujoco.MjSpec.from_string(arm_urdf())
    for name in JOINTS:
        servo = spec.add_actuator(name=name, target=name)
        servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
        servo.set_to_position(kp=KP)
        servo.forcerange = [-MAX_TORQUE, MAX_TORQUE]
        servo.forcelimited = True
    model = spec.compile()
    model.opt.timestep = STEP_S
    model.dof_armature[:], model.dof_damping[:] = ROTOR, BACK_EMF
    model.dof_frictionloss[JOINTS.index("elbow")] = FRICTION_NM
    # by default MuJoCo's friction lets joints creep; gears do not
    model.dof_solref[:], model.dof_solimp[:, :2] = (2 * STEP_S, 1.0), (0.999, 0.9999)
    time_s = np.arange(0, DURATION_S, tick_s)
    command = np.stack([motion(time_s, k) for k in range(len(JOINTS))], axis=1)
    data, position = mujoco.MjData(model), np.empty_like(command)
    data.qpos[:] = command[0]
    for row, target in enumerate(command):
        position[row], data.ctrl[:] = data.qpos, target
        mujoco.mj_step(model, data, nstep=round(tick_s / STEP_S))
    return time_s, command, position + NOISE_RAD * rng.standard_normal(position.shape)


def _write_log(path, time_s, command, position):
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        columns = [f"{joint}_{kind}_deg" for kind in ("cmd", "pos") for joint in JOINTS]
        rows.writerow(["t_ms", *columns])
        degrees = np.degrees(np.concatenate([command, position], axis=1))
        table = np.column_stack([1e3 * time_s, degrees])
        rows.writerows([[f"{value:.4f}" for value in row] for row in table])

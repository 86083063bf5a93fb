"""Files of other programs, as a reader of the pages would have them."""

import json

import numpy as np
from foreign_files import (
    joint_state,
    states,
    write_bag,
    write_calibration,
    write_lerobot,
)


def write_foreign_things(folder):
    """One file of each kind that `groundwalk convert` reads, called as on the pages."""
    _write_log(folder / "log.csv")
    efforts = states(effort=[(1.0, 2.0)] * 5)
    write_bag(folder / "a_bag", efforts).rename(folder / "arm.db3")
    commands = [("/targets", 0, joint_state(0, ["hip", "knee"], [0.5, 0.25]))]
    mcap = write_bag(folder / "another_bag", [*states(), *commands], mcap=True)
    mcap.rename(folder / "arm.mcap")
    angles = np.random.default_rng(1).uniform(0, 90, (20, 2))
    names = ("shoulder_pan.pos", "gripper.pos")
    write_lerobot(folder / "pick_place", [(angles, angles), (angles, angles)], names)
    ranges = {"shoulder_pan": (700, 3400), "gripper": (2000, 3400)}
    write_calibration(folder / "follower.json", **ranges)
    _write_lift(folder / "lift.json")
    time_s = np.arange(50) * 0.0025
    wave = np.sin(time_s)[:, None] * np.ones(3)
    np.savez(folder / "chirp.npz", time=time_s, dof_pos=wave, des_dof_pos=wave)


def _write_log(path):
    rows = [f"{10 * k},{k},{2 * k},0.5,30" for k in range(20)]
    header = "t_ms,elbow_pos_deg,elbow_cmd_deg,tau_elbow,temperature"
    path.write_text("\n".join([header, *rows]) + "\n")


def _write_lift(path):
    entries = [
        {
            "timestamp": 0.01 * k,
            "position": 0.01 * k,
            "speed": 1.0,
            "goal_position": 0.5,
            "torque_enable": True,
        }
        for k in range(30)
    ]
    path.write_text(json.dumps({"mass": 0.5, "kp": 32, "entries": entries}))

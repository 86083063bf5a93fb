"""Measures torques, speeds, ranges and masses of the nominal robot in a motion."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray, IntArray
from worlds.hidden.engine import least_inertia_kg_m2
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.run import Run
from worlds.hidden.servos import Servos, servo_torque_nm
from worlds.hidden.setting import Scales

if TYPE_CHECKING:
    import mujoco

_MOSTLY = 95
"""Percentile of a servo's absolute torque that counts as its usual torque; below 100 so
that single peaks at the start of a motion do not count."""
_POSES = 100
"""Number of poses, evenly spaced over each run, in which bodies are measured."""


def scales(plant: HiddenPlant, runs: Sequence[Run]) -> Scales:
    """Measure simulated runs of the nominal robot without hidden effects.

    Where runs differ, the largest value counts.
    """
    torque = [_servo_nm(plant, run) for run in runs]
    asked = [
        np.abs(np.diff(run.command_rad, axis=0)) / np.diff(run.clock.time_s)[:, None]
        for run in runs
    ]
    places = np.concatenate([run.position_rad for run in runs])
    commands = np.concatenate([run.command_rad for run in runs])
    model = plant.make_spec().compile()
    joints = [int(model.joint(name).id) for name in plant.joints]
    links = [int(model.body(name).id) for name in plant.links]
    names, bodies, base_kg = plant.links, links, 0.0
    if plant.description is not None and plant.floating:
        root = plant.description.root
        names, bodies = (*names, root.name), [*links, int(model.body(root.name).id)]
        base_kg = root.inertial.mass_kg
    centres, levers, branches, carried = _views(
        model, _poses(plant, runs), bodies, model.jnt_dofadr[joints]
    )
    axis = model.jnt_axis[joints]
    away_m = model.body_ipos[links] - model.jnt_pos[joints]
    along_m = np.sum(away_m * axis, axis=1, keepdims=True)
    return Scales(
        torque_nm=np.max([np.percentile(t, _MOSTLY, axis=0) for t in torque], axis=0),
        peak_nm=np.concatenate(torque).max(axis=0),
        peak_rad_s=np.concatenate(asked).max(axis=0),
        reach_rad=np.stack([places.min(axis=0), places.max(axis=0)], axis=1),
        asked_rad=np.ptp(commands, axis=0),
        inertia_kg_m2=least_inertia_kg_m2(plant, runs[0].position_rad[0]),
        carried_kg=model.body_subtreemass[links],
        axis=axis,
        moving_kg=float(sum(model.body_mass[links].tolist())) + base_kg,
        bodies=names,
        moved_m=np.linalg.norm(np.ptp(centres, axis=0), axis=1),
        carried_by=np.asarray(carried.any(axis=0)),
        lever_m=levers.max(axis=0),
        branch_lever_m=branches.max(axis=0),
        arm_m=away_m - along_m * axis,
    )


def _servo_nm(plant: HiddenPlant, run: Run) -> FloatArray:
    """(rows, j) absolute torques of the servos [N m] in a run."""
    speed = np.gradient(run.position_rad, run.clock.time_s, axis=0)
    gains = Servos(plant, run.clock.step_s).gains(time_s=0.0)
    return np.abs(servo_torque_nm(gains, run.command_rad - run.position_rad, speed))


def _views(
    model: "mujoco.MjModel",
    poses: Sequence[FloatArray],
    bodies: Sequence[int],
    dofs: IntArray,
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Measure b bodies, first the links of the j joints, in p poses (MuJoCo's `qpos`).

    Returns centres of mass (p, b, 3) [m]; gravity's lever arm on each body about each
    joint (p, b, j) [m], and on all bodies beyond a joint together (p, j) [m]; whether a
    joint, by its degree of freedom in `dofs`, moves a body (p, b, j).
    """
    import mujoco

    data = mujoco.MjData(model)
    linear, angular = np.zeros((2, len(bodies), 3, model.nv))
    beyond = np.zeros((len(dofs), 3, model.nv))
    centres, levers, branches, carried = [], [], [], []
    for pose in poses:
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        for row, body in enumerate(bodies):
            mujoco.mj_jacBodyCom(model, data, linear[row], angular[row], body)
        for row in range(len(dofs)):
            mujoco.mj_jacSubtreeCom(model, data, beyond[row], bodies[row])
        centres.append(data.xipos[bodies])
        # Gravity's lever arm is the height gained by the centre of mass per radian.
        levers.append(np.abs(linear[:, 2, dofs]))
        branches.append(np.abs(beyond[np.arange(len(dofs)), 2, dofs]))
        carried.append(np.any(angular[:, :, dofs] != 0, axis=1))
    return np.array(centres), np.array(levers), np.array(branches), np.array(carried)


def _poses(plant: HiddenPlant, runs: Sequence[Run]) -> list[FloatArray]:
    """MuJoCo's `qpos` at 100 evenly spaced rows of each run."""
    poses = []
    for run in runs:
        first, rows = run.clock.first, len(run.position_rad)
        for row in np.linspace(first, rows - 1, _POSES).astype(int):
            parts = [run.position_rad[row]]
            if plant.floating:
                base = run.sense
                parts = [base["position_m"][row], base["orientation"][row], *parts]
            poses.append(np.concatenate(parts))
    return poses

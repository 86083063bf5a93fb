"""Measures torques, speeds, ranges and masses of the nominal robot in a motion."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from worlds.hidden.engine import least_inertia_kg_m2
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.run import Run
from worlds.hidden.servos import servo_torque_nm
from worlds.hidden.setting import Bodies, Scales

_MOSTLY = 95
"""Percentile of a servo's absolute torque that counts as its usual torque; below 100 so
that single peaks at the start of a motion do not count."""
_POSES = 100
"""Number of poses of each run in which bodies are measured: ten a second in 10 s."""


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
    joints = [model.joint(name) for name in plant.joints]
    base_kg = 0.0
    if plant.description is not None and plant.floating:
        base_kg = plant.description.root.inertial.mass_kg
    masses = [float(model.body(name).mass[0]) for name in plant.links]
    carried = [float(model.body(name).subtreemass[0]) for name in plant.links]
    return Scales(
        torque_nm=np.max([np.percentile(t, _MOSTLY, axis=0) for t in torque], axis=0),
        peak_nm=np.concatenate(torque).max(axis=0),
        peak_rad_s=np.concatenate(asked).max(axis=0),
        reach_rad=np.stack([places.min(axis=0), places.max(axis=0)], axis=1),
        asked_rad=np.ptp(commands, axis=0),
        inertia_kg_m2=least_inertia_kg_m2(plant, runs[0].position_rad[0]),
        carried_kg=np.array(carried),
        axis=np.array([model.jnt_axis[joint.id] for joint in joints]),
        moving_kg=float(sum(masses)) + base_kg,
        bodies=_bodies(plant, runs),
    )


def _servo_nm(plant: HiddenPlant, run: Run) -> FloatArray:
    """(rows, j) absolute torques of the servos [N m] in a run."""
    speed = np.gradient(run.position_rad, run.clock.time_s, axis=0)
    gains = (
        plant.kp_nm_rad,
        plant.kd_nm_s_rad,
        plant.back_emf_nm_s_rad,
        plant.max_torque_nm,
    )
    return np.abs(servo_torque_nm(gains, run.command_rad - run.position_rad, speed))


def _bodies(plant: HiddenPlant, runs: Sequence[Run]) -> Bodies:
    """Measure how bodies move and load the joints, in 100 poses of each run."""
    names = plant.links
    if plant.floating and plant.description is not None:
        names = (*names, plant.description.root.name)
    probe = _Probe(plant, names)
    views = [probe.view(pose) for pose in _poses(plant, runs)]
    centres, levers, branches, carried = (
        np.array(part) for part in zip(*views, strict=True)
    )
    return Bodies(
        names=names,
        moved_m=np.linalg.norm(np.ptp(centres, axis=0), axis=1),
        carried_by=np.asarray(np.any(carried, axis=0)),
        lever_m=levers.max(axis=0),
        branch_lever_m=branches.max(axis=0),
        arm_m=probe.arm_m(),
    )


class _Probe:
    """Computes geometry of the nominal robot's b bodies and j joints, pose by pose."""

    def __init__(self, plant: HiddenPlant, names: Sequence[str]) -> None:
        import mujoco

        self._mujoco = mujoco
        self._model = model = plant.make_spec().compile()
        self._data = mujoco.MjData(model)
        self._bodies = [int(model.body(name).id) for name in names]
        self._joints = [int(model.joint(name).id) for name in plant.joints]
        self._dofs = model.jnt_dofadr[self._joints]

    def view(
        self, qpos: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
        """Measure one pose (nq,).

        Returns:
          Centres of mass (b, 3) [m]; gravity's lever arm on each body about each joint
          (b, j) [m], and on all bodies beyond a joint together (j,) [m]; whether a
          joint moves a body (b, j).
        """
        self._data.qpos[:] = qpos
        self._mujoco.mj_kinematics(self._model, self._data)
        self._mujoco.mj_comPos(self._model, self._data)
        turns = [self._jacobians(body) for body in self._bodies]
        # Gravity's lever arm is the height gained by the centre of mass per radian.
        return (
            self._data.xipos[self._bodies],
            np.array([np.abs(linear[2]) for linear, _ in turns]),
            self._branch_levers(),
            np.array([np.any(angular != 0, axis=0) for _, angular in turns]),
        )

    def _jacobians(self, body: int) -> tuple[FloatArray, FloatArray]:
        linear = np.zeros((3, self._model.nv))
        angular = np.zeros_like(linear)
        self._mujoco.mj_jacBodyCom(self._model, self._data, linear, angular, body)
        return linear[:, self._dofs], angular[:, self._dofs]

    def _branch_levers(self) -> FloatArray:
        levers = np.zeros(len(self._dofs))
        jacobian = np.zeros((3, self._model.nv))
        for joint, dof in enumerate(self._dofs):
            body = self._bodies[joint]
            self._mujoco.mj_jacSubtreeCom(self._model, self._data, jacobian, body)
            levers[joint] = abs(jacobian[2, dof])
        return levers

    def arm_m(self) -> FloatArray:
        """(j, 3) shortest vector from each joint's axis to its link's centre of mass.

        In metres, in the link's frame.
        """
        own = self._bodies[: len(self._joints)]
        axis = self._model.jnt_axis[self._joints]
        away = self._model.body_ipos[own] - self._model.jnt_pos[self._joints]
        along = np.sum(away * axis, axis=1, keepdims=True)
        return np.asarray(away - along * axis)


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

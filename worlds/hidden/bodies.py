"""How far the nominal robot's bodies move in a motion, and what gravity does there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.run import Run

_ROWS = 100
"""Rows of a run that are looked at."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """Arrays over bodies: each joint's link in the joints' order, then a free trunk.

    Attributes:
      names: of the b bodies.
      moved_m: (b,) diagonal of the box in which the centre of mass stays.
      carried_by: (b, j) whether a joint moves the body against the base.
      lever_m: (b, j) most horizontal distance of the centre of mass from a joint's
        axis, as gravity feels it; 0 where the axis is vertical.
      branch_lever_m: (j,) the same for all that hangs on a joint.
      arm_m: (j, 3) from a joint's axis to its own link's centre of mass, link's frame.
    """

    names: tuple[str, ...]
    moved_m: FloatArray
    carried_by: BoolArray
    lever_m: FloatArray
    branch_lever_m: FloatArray
    arm_m: FloatArray


def bodies(plant: HiddenPlant, runs: Sequence[Run]) -> Bodies:
    """Measured in the poses of some runs of the nominal robot.

    Args:
      plant: the robot.
      runs: with nothing hidden.
    """
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
    """Looks at the nominal robot in one pose after another."""

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
        """Centres (b, 3), levers (b, j), the branches' (j,), who is carried (b, j)."""
        self._data.qpos[:] = qpos
        self._mujoco.mj_kinematics(self._model, self._data)
        self._mujoco.mj_comPos(self._model, self._data)
        turns = [self._jacobians(body) for body in self._bodies]
        # A joint's turn lifts a centre as fast as gravity has a lever there.
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
        """(j, 3) from each joint's axis to its link's centre of mass."""
        own = self._bodies[: len(self._joints)]
        axis = self._model.jnt_axis[self._joints]
        away = self._model.body_ipos[own] - self._model.jnt_pos[self._joints]
        along = np.sum(away * axis, axis=1, keepdims=True)
        return np.asarray(away - along * axis)


def _poses(plant: HiddenPlant, runs: Sequence[Run]) -> list[FloatArray]:
    """Position vectors (q,) of the model, some of each recording."""
    poses = []
    for run in runs:
        first, rows = run.clock.first, len(run.position_rad)
        for row in np.linspace(first, rows - 1, _ROWS).astype(int):
            parts = [run.position_rad[row]]
            if plant.floating:
                base = run.sense
                parts = [base["position_m"][row], base["orientation"][row], *parts]
            poses.append(np.concatenate(parts))
    return poses

"""Dry friction whose contacts bend like springs before they slide."""

from collections.abc import Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from diagnosis.corrected.laws.step import Joint, Law, Step


class Presliding(Law):
    """Springs of one stiffness in parallel, each of which slips at its own bend.

    Of n springs, spring i slips at reach_rad i / n; after long sliding their torque is
    torque_nm. The equation of the step is solved with the torque after the step, at
    this joint alone, and MuJoCo gets the torque's tangent there: a torque, and damping
    for one step. So springs that are stiff for the step are stable.
    """

    SPRINGS = 8

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        torque_nm: float,
        reach_rad: float,
    ) -> None:
        """Add the friction to a joint; all springs are relaxed at first."""
        self.joint, self.torque_nm = joints[joint], torque_nm
        self.most = reach_rad * np.arange(1, self.SPRINGS + 1) / self.SPRINGS
        self.stiffness = 2 * torque_nm / (reach_rad * (self.SPRINGS + 1))
        self.bend = np.zeros(self.SPRINGS)
        self.damping = float(model.dof_damping[self.joint.dof])
        self.mass = int(
            model.M_rowadr[self.joint.dof] + model.M_rownnz[self.joint.dof] - 1
        )
        self.last: tuple[float, float] | None = None
        self.line = 0.0, 0.0, 0.0
        """Torque, its slope, and the speed around which the last step was solved."""

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        dof, h = self.joint.dof, step.seconds
        angle = float(step.data.qpos[self.joint.qpos])
        speed = float(step.data.qvel[dof])
        drag = self.damping + (0.0 if self.joint.is_spring else self.joint.kd)
        inertia = float(step.data.M[self.mass]) + h * drag
        if self.last is None:
            rest = drag * speed + self.stiffness * float(self.bend.sum())
        else:
            before, speed_before = self.last
            bend = self.bend + (angle - before)
            self.bend = np.minimum(np.maximum(bend, -self.most), self.most)
            torque, slope, around = self.line
            rubbed = torque + slope * h * (speed - around)
            rest = inertia * (speed - speed_before) / h + drag * speed_before + rubbed
        self.last = angle, speed
        push = rest - drag * speed + inertia * speed / h
        moved, torque, slope = self._solved(inertia / h**2, push)
        self.line = torque, slope, moved / h
        step.data.qfrc_applied[dof] += slope * moved - torque
        step.model.dof_damping[dof] = self.damping + slope * h

    def _solved(self, weight: float, push: float) -> tuple[float, float, float]:
        """The way x [rad] with weight x + F(x) = push, the torque F and its slope."""
        edges = np.concatenate([-self.most - self.bend, self.most - self.bend])
        order = np.argsort(edges)
        edges = edges[order]
        slopes: npt.NDArray[np.float64] = self.stiffness * np.cumsum(
            np.where(order < self.SPRINGS, 1.0, -1.0)
        )
        rises = slopes[:-1] * np.diff(edges)
        torques = np.concatenate([[0.0], rises.cumsum()]) - self.torque_nm
        below = weight * edges + torques < push
        last = max(int(below.sum()) - 1, 0)
        slope = float(slopes[last]) if below[0] else 0.0
        edge, torque = float(edges[last]), float(torques[last])
        moved = edge + (push - torque - weight * edge) / (weight + slope)
        return moved, torque + slope * (moved - edge), slope

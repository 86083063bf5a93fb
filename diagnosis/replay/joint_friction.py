"""Dry friction of joints in a batch, as MuJoCo's `frictionloss`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.columns import columns
from diagnosis.replay.dry_friction import (
    SHARES_OF_LINKS,
    VARYING,
    DryFriction,
    depends_on,
)
from groundwalk.arrays import FloatArray

SOLIMP_FRICTION = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""MuJoCo's `solimp` (impedance d) of dry friction: the largest one that it allows.

A joint with damping D that friction T holds creeps at about (1 - d) T / D [rad/s]: at a
tenth of it by MuJoCo's default, and still by some mrad in 10 s with d = 0.999."""


class BatchFriction:
    """Sets MuJoCo's dry friction (`frictionloss`) of all joints in all simulations.

    Attributes:
      varies: whether some friction depends on speed, angle or load; if so, call
        `follow` at every step.
    """

    def __init__(
        self,
        batch: Any,
        plant: Plant,
        joints: Mapping[str, FloatArray],
        damping_nm_s_rad: FloatArray,
        step_s: float,
    ) -> None:
        """Set the friction torques that do not change.

        `joints` are arrays of `Joints` by name with a row for each simulation in the
        batch, `damping_nm_s_rad` (rows, j) all damping that is integrated implicitly.
        """
        self._joints, self._dofs = joints, columns(plant.dofs)
        self.varies = depends_on(joints, VARYING)
        self._bias: FloatArray | None = None
        if depends_on(joints, SHARES_OF_LINKS):
            self._bias = np.asarray(batch.bind("qfrc_bias"))
        self._torque_nm = np.asarray(batch.expand("dof_frictionloss"))
        self._torque_nm[:, self._dofs] += joints["coulomb_nm"]
        self._least_nm = self._torque_nm[:, self._dofs].copy()
        if plant.creeps:
            return
        np.asarray(batch.expand("dof_solimp"))[:] = SOLIMP_FRICTION
        inertia_kg_m2 = np.asarray(batch.expand("dof_M0"))
        damping = np.zeros_like(inertia_kg_m2)
        damping[:, self._dofs] = damping_nm_s_rad
        solref = stops_in_a_step(damping, inertia_kg_m2, step_s)
        np.asarray(batch.expand("dof_solref"))[:] = solref

    def follow(
        self,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        driven_nm: FloatArray,
    ) -> None:
        """Set friction by (rows, j) angles, speeds [rad/s] and motors' torques [N m].

        The links' torques are those of the step before, as are the motors'.
        """
        links_nm = 0.0 if self._bias is None else -self._bias[:, self._dofs]
        friction = DryFriction(self._joints, velocity_rad_s, links_nm, position_rad)
        self._torque_nm[:, self._dofs] = self._least_nm + friction.at(driven_nm)


def stops_in_a_step(
    damping_nm_s_rad: FloatArray, inertia_kg_m2: FloatArray, step_s: float
) -> FloatArray:
    """(..., 2) MuJoCo's `solref` for friction that can stop a joint within one step.

    MuJoCo's friction asks for the acceleration -rate * velocity as if there were no
    damping. Its integrator, where damping is implicit, gives only the share I / (I +
    step * damping) of that, with I the inertia at the joint with the links beyond it.
    With the usual rate, 1 / step, a light joint with a strong servo creeps on for
    seconds. (MuJoCo documentation, "Computation": implicit integrators, and "Modeling",
    solref: two negative numbers mean stiffness, which friction does not have, and
    damping.)
    """
    rate_1_s = 1 / step_s + damping_nm_s_rad / inertia_kg_m2
    damping = -SOLIMP_FRICTION[1] * rate_1_s
    return np.stack([np.full_like(damping, -1.0), damping], axis=-1)

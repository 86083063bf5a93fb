"""Regression columns: joint torques of effects that are linear in a parameter."""

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.baselines.sparse_torques import Torques, inverse_nm
from diagnosis.effects.effect import Effect
from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import JointMotion, PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import variants_of
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    import mujoco

NUDGE_RAD = 1e-4
"""Step of an angle [rad] for finite differences of inverse dynamics."""


@dataclass(frozen=True, eq=False)
class Column:
    """One column of the regression: torque of an effect for a parameter value of 1.

    Attributes:
      effect: name of the effect; empty for a constant torque, which is no effect alone.
      place: place of the effect.
      parameter: index of the effect's parameter.
      values: (N,) weighted torque for a coefficient of 1.
      damping_nm_s_rad: damping of the servo plus back-EMF at the joint.
    """

    effect: str
    place: str
    parameter: int
    values: FloatArray
    damping_nm_s_rad: float = 1.0

    def named(self, size: float, error: float) -> tuple[str, float, float]:
        """Effect name, parameter value and standard error for a fitted coefficient."""
        if not self.effect:
            return "", size, error
        return effect(self.effect).from_column(size, error, self.damping_nm_s_rad)


def torque_columns(
    plant: Plant, traces: Sequence[Trace], torques: Torques
) -> list[Column]:
    """Columns of all effects that are linear, or nearly so, in a parameter.

    Args:
      plant: the nominal robot model.
      traces: recordings that the torques were computed from.
      torques: motion, and the missing torque that is to be explained.
    """
    columns = [
        column
        for joint in range(len(plant.joints))
        for column in _joint_columns(plant, torques, joint)
    ]
    for kind in all_effects().values():
        if kind.by_inverse_dynamics:
            for place in kind.places(plant, traces):
                columns += _changed_columns(plant, torques, kind, place)
        elif kind.place_kind == "commands" and kind.places(plant, traces):
            columns += _signal_columns(plant, torques, kind)
    return columns


def _joint_columns(plant: Plant, torques: Torques, joint: int) -> Iterator[Column]:
    """Columns of effects at one joint alone, and of a constant torque there."""
    motion, place = _motion_of(torques, joint), plant.joints[joint]
    damping = float(np.median(torques.motion.damping_nm_s_rad[:, joint]))

    def column(name: str, parameter: int, values: FloatArray) -> Column:
        """The column of an effect whose torque (rows,) acts at this joint only."""
        whole = np.zeros_like(torques.motion.position_rad)
        whole[:, joint] = values
        return Column(name, place, parameter, _weighted(torques, whole), damping)

    for kind in all_effects().values():
        values = kind.torque_column(motion) if kind.place_kind == "joint" else None
        if values is not None:
            yield column(kind.name, kind.column_parameter, values)
    yield column("", 0, np.ones_like(motion.position_rad))


def _signal_columns(plant: Plant, torques: Torques, kind: Effect) -> Iterator[Column]:
    """The column of an effect on the commands of all joints, if it has one."""
    every = [
        kind.torque_column(_motion_of(torques, joint))
        for joint in range(len(plant.joints))
    ]
    values = [one for one in every if one is not None]
    if values:
        whole = np.stack(values, axis=1)
        place, number = kind.place_kind, kind.column_parameter
        yield Column(kind.name, place, number, _weighted(torques, whole))


def _motion_of(torques: Torques, joint: int) -> JointMotion:
    """The motion of one joint, taken from arrays of all joints."""
    motion = torques.motion
    return JointMotion(
        since_s=motion.since_s[:, 0],
        position_rad=motion.position_rad[:, joint],
        velocity_rad_s=motion.velocity_rad_s[:, joint],
        acceleration_rad_s2=motion.acceleration_rad_s2[:, joint],
        command_rad=motion.command_rad[:, joint],
        command_rate_rad_s=motion.command_rate_rad_s[:, joint],
        kp_nm_rad=motion.kp_nm_rad[:, joint],
        torque_nm=torques.nominal_nm[:, joint],
    )


def _changed_columns(
    plant: Plant, torques: Torques, kind: Effect, place: str
) -> Iterator[Column]:
    """Columns of an effect that changes model or pose, by finite differences.

    Each is the change of inverse dynamics' torque for a small value of one parameter.
    """
    motion = torques.motion
    parameters = kind.parameters(plant, place)
    for number, parameter in enumerate(parameters):
        size = parameter.typical or 0.1 * parameter.high
        if kind.place_kind == "joint":
            size = NUDGE_RAD
        values = tuple(size if i == number else 0.0 for i in range(len(parameters)))
        variants = variants_of(plant, [(PlacedEffect(kind.name, place, values),)])
        pose = motion.position_rad - variants.joints.offset_rad[0]
        other = inverse_nm(plant, _model_of(plant, variants), pose, motion)
        change = (other - torques.nominal_nm) / size
        yield Column(kind.name, place, number, _weighted(torques, change))


def _model_of(plant: Plant, variants: Variants) -> "mujoco.MjModel":
    """A compiled model of the robot with the changes of the first variant."""
    import mujoco

    if not variants.fields:
        return plant.model
    model = copy.copy(plant.model)
    for field, values in variants.fields.items():
        owner = model
        *parents, last = field.split(".")
        for parent in parents:
            owner = getattr(owner, parent)
        getattr(owner, last)[:] = values[0].reshape(getattr(owner, last).shape)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def _weighted(torques: Torques, values: FloatArray) -> FloatArray:
    return np.asarray((values * torques.weight_rad_nm).reshape(-1))

"""What each effect would add to the missing torque, linear in its size."""

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.baselines.sparse_torques import Torques, inverse_nm
from diagnosis.effects.effect import PlacedEffect
from diagnosis.effects.library import effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import variants_of
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    import mujoco

BODY_EFFECTS = ("payload_mass", "com_offset", "ground_slope")
"""Effects that change the model's numbers, and so the torques of several joints."""

_SPEED_RAD_S = 0.02
_STRIBECK_RAD_S = 0.1
_PLAY_RAD = 0.005
_NUDGE_RAD = 1e-4


@dataclass(frozen=True, eq=False)
class Column:
    """One column of the regression.

    Attributes:
      effect: that it stands for; empty for what no effect does alone.
      place: of the effect.
      parameter: which of the effect's parameters its size is.
      values: (N,) weighted torque for a size of one.
      stiffness: by which a size is divided to become the parameter.
    """

    effect: str
    place: str
    parameter: int
    values: FloatArray
    stiffness: float = 1.0

    def named(self, size: float, error: float) -> tuple[str, float, float]:
        """Effect, value and standard error of its parameter, for a size."""
        if self.effect == "servo_gain":  # kp (1 - factor) is missing
            return self.effect, 1 - size, error
        if self.effect == "viscous_friction" and size < 0 and self.stiffness > 0:
            share = 1 / self.stiffness
            return "servo_damping", 1 + size * share, error * share
        return self.effect, size, error


def torque_columns(
    plant: Plant, traces: Sequence[Trace], torques: Torques
) -> list[Column]:
    """Columns of all effects that are linear, or nearly so, in their size.

    Args:
      plant: nominal.
      traces: that the torques are of.
      torques: what is to be explained.
    """
    columns = [
        column
        for joint in range(len(plant.joints))
        for column in _joint_columns(plant, torques, joint)
    ]
    columns += _offset_columns(plant, torques)
    late = torques.motion.kp_nm_rad * torques.motion.command_rate_rad_s
    columns.append(Column("command_latency", "commands", 0, _weighted(torques, late)))
    for name in BODY_EFFECTS:
        for place in effect(name).places(plant, traces):
            columns += _model_columns(plant, torques, name, place)
    return columns


def _joint_columns(plant: Plant, torques: Torques, joint: int) -> Iterator[Column]:
    """What happens at one joint alone."""
    motion, place = torques.motion, plant.joints[joint]
    q, v = motion.position_rad[:, joint], motion.velocity_rad_s[:, joint]
    way = np.tanh(v / _SPEED_RAD_S)
    error = motion.command_rad[:, joint] - q
    pull = motion.kp_nm_rad[:, joint] * error
    play = motion.kp_nm_rad[:, joint] * np.tanh(error / _PLAY_RAD) / 2
    load = np.abs(torques.nominal_nm[:, joint])
    damping = float(np.median(motion.damping_nm_s_rad[:, joint]))
    slow = np.exp(-((v / _STRIBECK_RAD_S) ** 2))
    parts = (
        ("coulomb_friction", 0, way),
        ("stribeck_friction", 1, slow * way),
        ("load_friction", 0, load * way),
        ("viscous_friction", 0, v),
        ("armature", 0, motion.acceleration_rad_s2[:, joint]),
        ("servo_gain", 0, pull),
        ("servo_fade", 0, motion.since_s[:, 0] * pull),
        ("backlash", 0, play),
        ("joint_spring", 0, q),
        ("", 0, np.ones_like(q)),
    )
    for name, parameter, values in parts:
        whole = np.zeros_like(motion.position_rad)
        whole[:, joint] = values
        yield Column(name, place, parameter, _weighted(torques, whole), damping)


def _offset_columns(plant: Plant, torques: Torques) -> list[Column]:
    """Encoders that are off: the true pose takes other torques than the measured."""
    columns = []
    for joint, place in enumerate(plant.joints):
        pose = torques.motion.position_rad.copy()
        pose[:, joint] -= _NUDGE_RAD
        other = inverse_nm(plant, plant.model, pose, torques.motion)
        change = (other - torques.nominal_nm) / _NUDGE_RAD
        columns.append(Column("encoder_offset", place, 0, _weighted(torques, change)))
    return columns


def _model_columns(
    plant: Plant, torques: Torques, name: str, place: str
) -> Iterator[Column]:
    """Effects that change the model: what the motion takes with a little of them."""
    parameters = effect(name).parameters(plant, place)
    for number, parameter in enumerate(parameters):
        size = parameter.typical or 0.1 * parameter.high
        values = tuple(size if i == number else 0.0 for i in range(len(parameters)))
        model = _changed(plant, PlacedEffect(name, place, values))
        other = inverse_nm(plant, model, torques.motion.position_rad, torques.motion)
        change = (other - torques.nominal_nm) / size
        yield Column(name, place, number, _weighted(torques, change))


def _changed(plant: Plant, placed: PlacedEffect) -> "mujoco.MjModel":
    import mujoco

    model = copy.copy(plant.model)
    for field, values in variants_of(plant, [(placed,)]).fields.items():
        owner = model
        *parents, last = field.split(".")
        for parent in parents:
            owner = getattr(owner, parent)
        getattr(owner, last)[:] = values[0].reshape(getattr(owner, last).shape)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def _weighted(torques: Torques, values: FloatArray) -> FloatArray:
    return np.asarray((values * torques.weight_rad_nm).reshape(-1))

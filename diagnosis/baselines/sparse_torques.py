"""Servo torques and inverse dynamics of smoothed recordings, and their difference."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.plant.inverse_dynamics import inverse_dynamics
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    import mujoco

MOST_ROWS = 1500
"""Most rows of all traces together that enter the regression."""
_EDGE_S = 0.2
"""Time at both ends [s] that is left out, as smoothed accelerations are poor there."""


@dataclass(frozen=True, eq=False)
class Motion:
    """R rows of all traces together, with their smoothed motion and servo torques.

    Attributes:
      since_s: (R, 1) time since the trace's start.
      position_rad: (R, j) smoothed positions.
      velocity_rad_s: (R, j) rate of the smoothed positions.
      acceleration_rad_s2: (R, j) second derivative of the smoothed positions.
      command_rad: (R, j) position targets.
      command_rate_rad_s: (R, j) rate of the position targets.
      kp_nm_rad: (R, j) stiffness of the servos.
      damping_nm_s_rad: (R, j) damping and back-EMF of the servos.
      servo_nm: (R, j) torque that the servos ask for, without back-EMF.
    """

    since_s: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    command_rad: FloatArray
    command_rate_rad_s: FloatArray
    kp_nm_rad: FloatArray
    damping_nm_s_rad: FloatArray
    servo_nm: FloatArray

    @classmethod
    def of(cls, traces: Sequence[Trace]) -> "Motion":
        """Take at most `MOST_ROWS` of all rows, evenly spaced."""
        every = max(1, -(-sum(trace.ticks for trace in traces) // MOST_ROWS))
        parts = [_motion(trace, every) for trace in traces]
        return cls(
            *(
                np.concatenate([getattr(part, field.name) for part in parts])
                for field in fields(cls)
            )
        )


def _motion(trace: Trace, every: int) -> Motion:
    smoothed = [smooth(trace.time_s, column) for column in trace.position_rad.T]
    q = np.stack([one.value for one in smoothed], axis=1)
    v = np.stack([one.rate for one in smoothed], axis=1)
    a = np.stack([one.acceleration for one in smoothed], axis=1)
    command = trace.position_rad if trace.command_rad is None else trace.command_rad
    # around a row the one before it holds as long as its own
    command = (command + np.vstack([command[:1], command[:-1]])) / 2
    rate = np.gradient(command, trace.time_s, axis=0)
    servo = trace.servo
    kp = np.broadcast_to(servo.kp_nm_rad, q.shape)
    kd = np.broadcast_to(servo.kd_nm_s_rad, q.shape)
    torque = servo.torque(command - q, v)
    since_s = (trace.time_s - trace.time_s[0])[:, None]
    whole = np.isfinite(np.hstack([q, v, a, command, rate])).all(axis=1)
    inside = (since_s[:, 0] > _EDGE_S) & (since_s[:, 0] < since_s[-1, 0] - _EDGE_S)
    rows = np.flatnonzero(whole & inside)[::every]
    damping = kd + servo.back_emf_nm_s_rad
    columns = (since_s, q, v, a, command, rate, kp, damping, torque)
    return Motion(*(column[rows] for column in columns))


@dataclass(frozen=True, eq=False)
class Torques:
    """The torque that the nominal model does not explain.

    Attributes:
      motion: the motion in R rows.
      nominal_nm: (R, j) torque that the motion needs by the nominal model.
      weight_rad_nm: (j,) weights, one over the stiffness. They turn torques into
        position errors, which are about equally large at all joints.
      missing: (R j,) weighted servo torque less the torque that the motion needs.
    """

    motion: Motion
    nominal_nm: FloatArray
    weight_rad_nm: FloatArray
    missing: FloatArray

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Torques":
        """Compute servo torque less inverse dynamics for all traces of a plant."""
        motion = Motion.of(traces)
        # the model has the nominal servo's back-EMF as damping
        emf = traces[0].servo.back_emf_nm_s_rad - plant.servo.back_emf_nm_s_rad
        nominal = inverse_nm(plant, plant.model, motion.position_rad, motion)
        nominal = nominal + emf * motion.velocity_rad_s
        weight = 1 / np.maximum(np.median(motion.kp_nm_rad, axis=0), 1e-6)
        missing = ((motion.servo_nm - nominal) * weight).reshape(-1)
        return cls(motion, nominal, weight, missing)


def inverse_nm(
    plant: Plant, model: "mujoco.MjModel", position_rad: FloatArray, motion: Motion
) -> FloatArray:
    """Torques (R, j) [N m] that a motion needs, at positions other than its own.

    Args:
      plant: the nominal robot model.
      model: the compiled model to use: the plant's, or a copy with other numbers.
      position_rad: (R, j) positions, used instead of the motion's own.
      motion: gives velocities and accelerations.
    """
    return inverse_dynamics(
        plant, model, position_rad, motion.velocity_rad_s, motion.acceleration_rad_s2
    )

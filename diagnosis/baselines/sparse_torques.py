"""Missing torque: servo torque minus inverse dynamics, from smoothed recordings."""

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
"""Largest number of rows, of all recordings together, that regression uses."""
_EDGE_S = 0.2
"""Time at both ends of a recording that is left out, because smoothed accelerations are
poor there [s]."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Smoothed motion and servo torques in R rows of all recordings together.

    Attributes:
      since_s: (R, 1) time since the start of the row's recording.
      position_rad: (R, j) smoothed joint positions.
      velocity_rad_s: (R, j) first derivative of the smoothed positions.
      acceleration_rad_s2: (R, j) second derivative of the smoothed positions.
      command_rad: (R, j) position targets.
      command_rate_rad_s: (R, j) derivative of the position targets.
      kp_nm_rad: (R, j) stiffness of the servos.
      damping_nm_s_rad: (R, j) damping plus back-EMF of the servos.
      servo_nm: (R, j) torque by the servos' law, without back-EMF.
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
        """Take evenly spaced rows of all recordings, at most `MOST_ROWS` together."""
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
      motion: smoothed motion and servo torques in R rows.
      nominal_nm: (R, j) torque for the motion by the nominal model's inverse dynamics.
      weight_rad_nm: (j,) weights 1 / kp. They turn torques into position errors, which
        are about equally large at all joints.
      missing: (R j,) weighted difference of servo torque and `nominal_nm`.
    """

    motion: Motion
    nominal_nm: FloatArray
    weight_rad_nm: FloatArray
    missing: FloatArray

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Torques":
        """Compute servo torque minus inverse dynamics for recordings of a robot."""
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
    """Torques (R, j) [N m] by inverse dynamics, for a motion at given positions.

    Args:
      plant: the nominal robot model.
      model: the compiled model to use: the nominal one, or a copy that effects changed.
      position_rad: (R, j) positions, used instead of the motion's own.
      motion: gives velocities and accelerations.
    """
    return inverse_dynamics(
        plant, model, position_rad, motion.velocity_rad_s, motion.acceleration_rad_s2
    )

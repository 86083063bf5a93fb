"""Torques that servos give and that motions take, on smoothed recordings."""

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
_EDGE_S = 0.2
"""Smoothed accelerations are poor at both ends."""


@dataclass(frozen=True, eq=False)
class Motion:
    """R rows of all traces together, arrays (R, j); `since_s` is (R, 1).

    Attributes:
      since_s: since the trace's start.
      position_rad: smoothed, as are the next two.
      velocity_rad_s: its rate.
      acceleration_rad_s2: and the rate's.
      command_rad: position targets.
      command_rate_rad_s: how fast they change.
      kp_nm_rad: stiffness of the servos, of each row's trace.
      damping_nm_s_rad: their damping and back-EMF.
      servo_nm: torque that they give by their law, without back-EMF.
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
        """At most `MOST_ROWS` of all rows, evenly taken."""
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
    """What the nominal model cannot account for.

    Attributes:
      motion: of R rows.
      nominal_nm: (R, j) what the motion takes by the nominal model.
      weight_rad_nm: (j,) one over the stiffness: torques as errors of position, of
        which all joints' encoders make about as much.
      missing: (R j,) torque that servos gave and the motion did not take, weighted.
    """

    motion: Motion
    nominal_nm: FloatArray
    weight_rad_nm: FloatArray
    missing: FloatArray

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Torques":
        """Servo torque less inverse dynamics."""
        motion = Motion.of(traces)
        # what a servo does beside its own law is in the model as damping
        emf = traces[0].servo.back_emf_nm_s_rad - plant.servo.back_emf_nm_s_rad
        nominal = inverse_nm(plant, plant.model, motion.position_rad, motion)
        nominal = nominal + emf * motion.velocity_rad_s
        weight = 1 / np.maximum(np.median(motion.kp_nm_rad, axis=0), 1e-6)
        missing = ((motion.servo_nm - nominal) * weight).reshape(-1)
        return cls(motion, nominal, weight, missing)


def inverse_nm(
    plant: Plant, model: "mujoco.MjModel", position_rad: FloatArray, motion: Motion
) -> FloatArray:
    """(R, j) torques that a motion takes.

    Args:
      plant: tells which rows are the joints'.
      model: the plant's, or one with other numbers.
      position_rad: (R, j) instead of the motion's own.
      motion: velocities and accelerations.
    """
    return inverse_dynamics(
        plant, model, position_rad, motion.velocity_rad_s, motion.acceleration_rad_s2
    )

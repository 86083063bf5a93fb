"""Recordings of servos, to be replayed by the torques that were measured instead."""

from dataclasses import replace
from typing import Literal

from diagnosis.plant.servo import Servo
from diagnosis.traces.trace import Trace
from groundwalk.errors import BadRecordingError

DriveBy = Literal["servos", "torques"]


def driven_by_torques(trace: Trace) -> Trace:
    """A trace whose servos are forgotten: its torques drive the joints.

    A servo hides much of what its joint lacks, and what is not known of the servo, such
    as when it computes, is taken for the joint's. Its torques depend on neither.

    Raises:
      BadRecordingError: no torque was measured.
    """
    if trace.torque_nm is None:
        raise BadRecordingError(
            f"{trace.name}: no torque was measured that could drive the joints"
        )
    torque = trace.torque_nm
    if trace.added_nm is not None:
        torque = torque + trace.added_nm
    servo = Servo.ideal(torque.shape[1])
    return replace(trace, servo=servo, torque_nm=torque, added_nm=None)

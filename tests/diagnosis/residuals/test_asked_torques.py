"""Torques that servos ask for, in the motions that are compared."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import (
    INERTIA,
    PENDULUM,
    PENDULUM_LEVER_NM,
    plant_of,
    ticks,
    trace_of,
)

from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.asked import AskedTorques
from diagnosis.replay.inverse import NeededTorques
from diagnosis.residuals.replays import variants_of
from diagnosis.residuals.torques.asked_torques import asked_motions

KP, EMF = 50.0, 0.8


@pytest.mark.parametrize("more", [0.0, 0.3])
def test_back_emf_counts_once(more):
    """The model's joint has it as damping; the recording's servo may have `more`."""
    plant = plant_of(PENDULUM, kp=KP, emf=EMF)
    time_s = ticks(8.0)
    angle, speed = 0.4 * np.sin(3 * time_s), 1.2 * np.cos(3 * time_s)
    error = 0.05 * np.sin(5 * time_s)
    # the command holds until the next row: its mean is that of the middle between
    trace = trace_of(plant, time_s, angle, command_rad=angle + error)
    servo = replace(trace.servo, back_emf_nm_s_rad=np.array([EMF + more]))
    (ready,) = asked_motions(plant, [replace(trace, servo=servo)])
    middle = np.interp(time_s, time_s + 0.005, angle + error)
    wanted = KP * (middle - angle) - more * speed
    np.testing.assert_allclose(ready.torque_nm[2:-2, 0], wanted[2:-2], atol=2e-3)
    # the torque that the motion needs holds the model's back-EMF, as damping
    needed = NeededTorques(plant, [ready]).of(variants_of(plant, [()]))[0, :, 0]
    inertia, gravity = INERTIA * -9 * angle, PENDULUM_LEVER_NM * np.sin(angle)
    held = ready.motion.counts[:, 0]
    assert held.mean() > 0.5
    closed = inertia + gravity + EMF * speed
    np.testing.assert_allclose(needed[held], closed[held], atol=0.02)


@pytest.mark.parametrize("name", ["servo_gain", "servo_damping"])
def test_a_servo_that_is_not_as_declared_asks_for_other_torques(name):
    """The error is what true gains need: factor KP e = torque needed, and damping."""
    plant, factor = plant_of(PENDULUM, kp=KP, emf=EMF), 0.7
    time_s = ticks(8.0)
    angle, speed = 0.4 * np.sin(3 * time_s), 1.2 * np.cos(3 * time_s)
    without = INERTIA * -9 * angle + PENDULUM_LEVER_NM * np.sin(angle)
    gain, damping = (factor, 1.0) if name == "servo_gain" else (1.0, factor)
    error = (without + damping * EMF * speed) / (gain * KP)
    held = np.interp(time_s + 0.005, time_s, angle + error)
    trace = trace_of(plant, time_s, angle, command_rad=held)
    (ready,) = asked_motions(plant, [trace])
    one = (PlacedEffect(name, "hinge", (factor,)),)
    variants = variants_of(plant, [(), one])
    needed = NeededTorques(plant, [ready]).of(variants)
    asked = AskedTorques([ready], plant.servo.back_emf_nm_s_rad).of(needed, variants)
    counts = ready.motion.counts[:, 0]
    left = asked[:, counts, 0] - ready.torque_nm[counts, 0]
    nominal, right = np.sqrt(np.mean(left**2, axis=1))
    assert right < 0.02 < 0.1 < nominal

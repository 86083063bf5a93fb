"""Joints on springs: two masses, of which the encoder sees the motor's."""

import numpy as np
import pytest
from joint_rigs import (
    INERTIA,
    PENDULUM,
    PENDULUM_LEVER_NM,
    WHEEL,
    exact,
    integrated,
    plant_of,
    replayed,
    run_from,
    smooth_command,
    ticks,
    trace_of,
)
from scipy.optimize import fsolve

HINGE = "hinge"
MOTOR, SPRING, DAMPING = 0.01, 20.0, 0.1
KP, KD, EMF, LIMIT = 6.0, 0.15, 0.05, 0.3
TIME_S = ticks(0.8)
COMMAND = smooth_command(TIME_S)
ELASTIC = ("joint_elasticity", HINGE, SPRING, DAMPING)


def two_masses(limit=np.inf, lever_nm=0.0, motor=MOTOR, torque=None, kp=KP):
    """y' of y = motor's and link's angle, then their speeds."""

    def law(t, y, k):
        angle, q, w, v = y
        if torque is None:
            gain = kp(t) if callable(kp) else kp
            drive = np.clip(gain * (COMMAND[k] - angle) - KD * w, -limit, limit)
        else:
            drive = torque
        spring = SPRING * (angle - q) + DAMPING * (w - v)
        link = (spring - lever_nm * np.sin(q)) / INERTIA
        return [w, v, (drive - EMF * w - spring) / motor, link]

    return law


def plant(body=WHEEL, limit=np.inf, motor=MOTOR):
    return plant_of(body, armature=motor, kp=KP, kd=KD, emf=EMF, limit=limit)


def commanded(plant, command=COMMAND, time_s=TIME_S, **start):
    return run_from(trace_of(plant, time_s, command_rad=command), **start)


@pytest.mark.parametrize(
    ("body", "limit", "lever_nm"),
    [(WHEEL, np.inf, 0), (WHEEL, LIMIT, 0), (PENDULUM, np.inf, PENDULUM_LEVER_NM)],
)
def test_the_encoder_sees_the_motor_of_two_masses(body, limit, lever_nm):
    rig = plant(body, limit)
    truth = integrated(two_masses(limit, lever_nm), TIME_S, [0, 0, 0, 0])
    found = exact(rig, commanded(rig), ELASTIC, step_s=5e-4)[:, 0]
    assert np.abs(found - truth[:, 0]).max() < 2e-4
    assert np.abs(found - truth[:, 1]).max() > 5e-3
    rigid = exact(rig, commanded(rig))[:, 0]
    assert np.abs(rigid - truth[:, 0]).max() > 5e-3


def test_a_light_motor_on_a_stiff_spring_is_nearly_a_rigid_joint():
    """A thousandth of the inertia; stable also where steps are long for the spring."""
    rig = plant(motor=2e-5)
    stiff = ("joint_elasticity", HINGE, 5e3, 1.0)
    run = commanded(rig)
    gaps = [
        np.abs(replayed(rig, run, stiff, step_s=h)[0] - replayed(rig, run, step_s=h)[0])
        for h in (2e-3, 2.5e-4)
    ]
    assert gaps[0].max() < 0.03
    assert gaps[1].max() < 0.004


def test_gravity_winds_up_the_spring():
    """At rest kp (c - a) = K (a - q) = m g l sin q; measured is a."""
    rig = plant(PENDULUM)
    time_s = ticks(4.0, 0.05)
    run = commanded(rig, np.full(len(time_s), 0.8), time_s, position_rad=0.7)
    soft = ("joint_elasticity", HINGE, 4.0, 0.1)
    found, _ = replayed(rig, run, soft)

    def balance(x):
        torque = PENDULUM_LEVER_NM * np.sin(x[1])
        return KP * (0.8 - x[0]) - torque, 4.0 * (x[0] - x[1]) - torque

    motor, link = fsolve(balance, [0.7, 0.7])
    assert found[-1, 0] == pytest.approx(motor, abs=1e-5)
    assert abs(motor - link) > 0.05


def test_the_servo_of_an_elastic_joint_fades_at_the_motor():
    rig = plant(PENDULUM)
    law = two_masses(lever_nm=PENDULUM_LEVER_NM, kp=lambda t: KP * (1 - 0.5 * t))
    truth = integrated(law, TIME_S, [0, 0, 0, 0])[:, 0]
    fade = ("servo_fade", HINGE, 0.5)
    found = exact(rig, commanded(rig), ELASTIC, fade, step_s=5e-4)[:, 0]
    assert np.abs(found - truth).max() < 2e-4
    lasting = exact(rig, commanded(rig), ELASTIC, step_s=5e-4)[:, 0]
    assert np.abs(lasting - truth).max() > 5e-3


def test_a_torque_turns_the_motor_not_the_link():
    rig = plant()
    torque = 0.05
    trace = trace_of(rig, TIME_S, command_torque_nm=np.full(len(TIME_S), torque))
    truth = integrated(two_masses(torque=torque), TIME_S, [0, 0, 0, 0])[:, 0]
    found = exact(rig, run_from(trace), ELASTIC, step_s=5e-4)[:, 0]
    assert np.abs(found - truth).max() < 2e-4


def test_an_offset_is_the_encoders():
    """Without a load the measured motion does not know of it."""
    rig = plant()
    offset = ("encoder_offset", HINGE, 0.1)
    found, _ = replayed(rig, commanded(rig), ELASTIC, offset)
    without, _ = replayed(rig, commanded(rig), ELASTIC)
    np.testing.assert_allclose(found, without, atol=1e-9)


def test_motors_whose_speeds_overflow_say_so_by_their_values_only():
    """Warnings are errors in tests; a search sees by the values what diverged."""
    rig = plant()
    run = commanded(rig, command=np.full_like(COMMAND, 1e308))
    assert not np.isfinite(replayed(rig, run, ELASTIC)).all()

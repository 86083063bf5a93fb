"""A motor before a spring with play, against closed forms."""

import math

import numpy as np
import pytest

from worlds.hidden.servos import Transmission

STEP_S = 0.0001
STRONG = (1e5, 1.0, math.inf, 0.0)


def test_an_elastic_joint_rings_at_the_frequency_of_its_spring():
    stiffness, inertia = 200.0, 0.02
    joint = Transmission(stiffness, 0.0, 0.0, STEP_S)
    joint.motor_rad = 0.0
    angle, speed, angles = 0.05, 0.0, []
    for _ in range(10000):
        speed += joint.torque(angle, speed, 0.0, STRONG) / inertia * STEP_S
        angle += speed * STEP_S
        angles.append(angle)
    ups = np.flatnonzero((np.array(angles[:-1]) < 0) & (np.array(angles[1:]) >= 0))
    period_s = np.diff(ups).mean() * STEP_S
    assert period_s == pytest.approx(2 * math.pi / math.sqrt(stiffness / inertia), 5e-3)


def settled(joint, angle, command, servo):
    for _ in range(20000):
        torque = joint.torque(angle, 0.0, command, servo)
    return torque


def test_spring_and_servo_are_in_series():
    torque = settled(
        Transmission(50.0, 0.1, 0.0, STEP_S), 0.0, 0.1, (20.0, 0.5, 9.0, 0.0)
    )
    assert torque == pytest.approx(0.1 / (1 / 50.0 + 1 / 20.0), rel=1e-6)


def test_within_its_play_a_joint_feels_nothing():
    for angle in (-0.0099, 0.0, 0.0099):
        joint = Transmission(1e5, 0.0, 0.02, STEP_S)
        assert settled(joint, angle, 0.0, (20.0, 0.5, 9.0, 0.0)) == 0.0


@pytest.mark.parametrize("side", [-1, 1])
def test_beyond_its_play_it_feels_the_servo_less_half_the_gap(side):
    joint = Transmission(1e6, 0.0, 0.02, STEP_S)
    torque = settled(joint, side * 0.03, 0.0, (20.0, 0.5, 9.0, 0.0))
    assert torque == pytest.approx(-side * 20.0 * 0.02, rel=1e-3)


def test_the_servo_s_limit_holds_behind_a_spring():
    joint = Transmission(50.0, 0.1, 0.0, STEP_S)
    assert settled(joint, 0.0, 1.0, (20.0, 0.5, 0.7, 0.1)) == pytest.approx(0.7)


def test_a_joint_with_play_crosses_it_before_it_pulls_again():
    joint = Transmission(1e6, 0.0, 0.02, STEP_S)
    settled(joint, 0.0, 0.05, (20.0, 0.5, 9.0, 0.0))
    torques = [joint.torque(0.0, 0.0, -0.05, (20.0, 0.5, 9.0, 0.0)) for _ in range(200)]
    assert torques[1] == 0.0
    assert torques[100] == 0.0
    assert settled(joint, 0.0, -0.05, (20.0, 0.5, 9.0, 0.0)) < -0.7

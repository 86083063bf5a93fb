"""Signals that are not what they seem: units, signs, places, limits."""

from dataclasses import replace

import numpy as np
import pytest
from audited_arm import QUANTUM, changed, motions, one, texts

from diagnosis.audit import clocks
from diagnosis.audit.audit import audit
from diagnosis.plant.servo import Servo


def test_velocity_in_another_unit(trace, plant):
    rpm = replace(trace, velocity_rad_s=trace.velocity_rad_s * 60 / (2 * np.pi))
    assert texts([rpm], plant, "refuse") == []
    found = texts([rpm], plant, "limit")
    assert len(found) == 3
    one(found, "velocity.a", "9.5", "not used")
    weak = replace(trace, velocity_rad_s=1.3 * trace.velocity_rad_s)
    assert texts([weak], plant, "limit") == []


def test_times_in_milliseconds_are_refused(trace, plant):
    late = replace(trace, velocity_rad_s=1e3 * trace.velocity_rad_s)
    one(texts([late], plant, "refuse"), "velocity.a", "milliseconds")
    geared = replace(trace, velocity_rad_s=100 * trace.velocity_rad_s)
    assert texts([geared], plant, "refuse") == []


def test_a_clock_that_runs_otherwise_than_the_healthy_robots_is_refused(trace, plant):
    slow = replace(trace, name="slow", time_s=1.02 * trace.time_s)
    found = audit([trace, slow], plant, [trace, trace]).refused
    one(found, "slow", "10.2 ms", "every 10 ms", "time wrong by a factor of 1.020")
    # a crystal, and another rate that was chosen
    for factor in (1.0005, 2.0):
        other = replace(trace, time_s=factor * trace.time_s)
        assert audit([other], plant, [trace]).refused == ()


@pytest.mark.parametrize("constant", ["_LEAST", "_MOST"])
@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_for_clocks_a_factor_of_two_does_not_matter(
    monkeypatch, constant, factor, trace, plant
):
    monkeypatch.setattr(clocks, constant, factor * getattr(clocks, constant))
    test_a_clock_that_runs_otherwise_than_the_healthy_robots_is_refused(trace, plant)


def test_rates_that_a_busy_computer_happens_to_reach_are_no_clocks(trace, plant):
    random = np.random.default_rng(0)
    uneven = 0.01 * random.uniform(0.8, 1.2, (2, trace.ticks))
    busy, busier = (replace(trace, time_s=np.cumsum(one)) for one in uneven)
    slower = replace(busier, time_s=1.02 * busier.time_s)
    assert audit([slower], plant, [busy]).refused == ()


def test_swapped_joints(trace, plant):
    swapped = replace(
        trace, position_rad=trace.position_rad[:, [1, 0, 2]], velocity_rad_s=None
    )
    found = texts([swapped], plant, "refuse")
    assert len(found) == 2
    one(found, "position.a of good follows the command of b")
    one(found, "position.b of good follows the command of a")
    turned = replace(
        trace, position_rad=trace.position_rad[:, [1, 2, 0]], velocity_rad_s=None
    )
    assert len(texts([turned], plant, "refuse")) == 3


def test_swapped_joints_are_found_beside_one_with_the_same_command(trace, plant):
    """As at the legs of a robot that trots: which of both commands fits is chance."""
    little = 1.2e-3 * np.sin(2 * np.pi * 0.5 * trace.time_s)
    command = changed(trace.command_rad, 2, trace.command_rad[:, 0] + little)
    noise = trace.position_rad[:, 0] - motions(trace.time_s)[:, 0]
    own = changed(trace.position_rad, 2, command[:, 0] + noise[::-1])
    swapped = replace(
        trace,
        command_rad=command,
        position_rad=changed(own[:, [1, 0, 2]], 1, command[:, 2] + noise),
        velocity_rad_s=None,
    )
    found = texts([swapped], plant, "refuse")
    assert len(found) == 2
    one(found, "position.a of good follows the command of b")
    one(found, "position.b of good follows the command of")


def test_a_bad_joint_is_not_taken_for_a_swapped_one(trace, plant):
    # b hardly follows and happens to look like a; a is healthy
    weak = 0.9 * motions(trace.time_s)[:, 0]
    tired = replace(
        trace,
        position_rad=changed(trace.position_rad, 1, weak),
        velocity_rad_s=None,
    )
    assert texts([tired], plant, "refuse") == []


def test_flipped_sign(trace, plant):
    flipped = replace(
        trace,
        position_rad=changed(trace.position_rad, 2, -trace.position_rad[:, 2]),
        velocity_rad_s=None,
    )
    one(texts([flipped], plant, "refuse"), "position.c", "runs against its command")


def test_degrees_are_refused(trace, plant):
    both = replace(
        trace,
        position_rad=np.degrees(trace.position_rad),
        command_rad=np.degrees(trace.command_rad),
        velocity_rad_s=np.degrees(trace.velocity_rad_s),
    )
    found = texts([both], plant, "refuse")
    one(found, "position.a", "degrees")
    half = replace(trace, position_rad=0.5 * trace.position_rad, velocity_rad_s=None)
    assert texts([half], plant, "refuse") == []
    commands = replace(trace, command_rad=np.degrees(trace.command_rad))
    one(texts([commands], plant, "refuse"), "position.b", "its command", "degrees")


def test_clipping(trace, plant):
    torque = 4 * np.sin(2 * np.pi * 0.7 * trace.time_s)
    torques = np.zeros_like(trace.position_rad) + torque[:, None]
    free = replace(trace, torque_nm=torques)
    assert texts([free], plant, "limit") == []
    clipped = replace(trace, torque_nm=changed(torques, 1, np.clip(torque, -4, 2)))
    text = one(texts([clipped], plant, "limit"), "torque.b", "stuck at an extreme")
    # sin is above one half a third of the time
    share = audit([clipped], plant).traces[0].channels[-2].clipped_share
    assert share == pytest.approx(1 / 3, abs=0.02)
    assert f"{share:.1%}" in text


def test_positions_that_come_to_rest_are_not_clipped(trace, plant):
    steps = np.where(trace.time_s % 4 < 2, 0.0, 1.0)
    rest = np.zeros_like(steps)
    for k in range(1, len(rest)):
        rest[k] = rest[k - 1] + 0.1 * (steps[k] - rest[k - 1])
    rested = replace(
        trace,
        position_rad=changed(trace.position_rad, 0, np.round(rest / QUANTUM) * QUANTUM),
        command_rad=changed(trace.command_rad, 0, steps),
        velocity_rad_s=None,
    )
    assert audit([rested], plant).findings == ()


def test_repeated_rows(trace, plant):
    position = trace.position_rad.copy()
    position[1::2] = position[::2]
    twice = replace(trace, position_rad=position, velocity_rad_s=None)
    text = one(texts([twice], plant, "limit"), "repeat the positions")
    assert audit([twice], plant).traces[0].repeated_share == pytest.approx(
        0.5, abs=0.03
    )
    assert "50%" in text or "49%" in text or "51%" in text
    assert audit([trace], plant).traces[0].repeated_share < 0.02


def test_unknown_servo(trace, plant):
    unknown = replace(trace, servo=Servo.ideal(3))
    assert len(texts([unknown], plant, "refuse")) == 3
    one(texts([unknown], plant, "refuse"), "command.a", "no servo gains are known")
    driven = replace(unknown, torque_nm=1e-2 * trace.velocity_rad_s)
    assert texts([driven], plant, "refuse") == []


def test_joint_without_any_drive(trace, plant):
    half = replace(trace, command_rad=changed(trace.command_rad, 1, np.nan))
    one(texts([half], plant, "refuse"), "nothing says what drove b")
    none = replace(trace, command_rad=None)
    assert len(texts([none], plant, "refuse")) == 3


def test_a_joint_without_motor_is_passive_beside_others(trace, plant):
    kp = np.array([20.0, 0.0, 20.0])
    half = replace(
        trace,
        command_rad=changed(trace.command_rad, 1, np.nan),
        servo=replace(trace.servo, kp_nm_rad=kp),
    )
    assert texts([half], plant, "refuse") == []
    one(texts([half], plant, "limit"), "drove b", "passive")


def test_torques_in_another_unit(trace, plant):
    torque = 4 * np.sin(trace.time_s)[:, None] * np.ones(3)
    assert texts([replace(trace, torque_nm=torque)], plant, "refuse") == []
    milli = replace(trace, torque_nm=1e3 * torque)
    one(texts([milli], plant, "refuse"), "torque.a", "4e+03")


def test_accelerometer_in_g(trace, plant):
    rng = np.random.default_rng(4)
    lying = np.array([0.1, 0.0, 9.81]) + 0.1 * rng.normal(size=(trace.ticks, 3))
    assert texts([replace(trace, accelerometer_m_s2=lying)], plant, "refuse") == []
    in_g = replace(trace, accelerometer_m_s2=lying / 9.81)
    one(texts([in_g], plant, "refuse"), "accelerometer", "in g")


def test_gyroscope_in_degrees(trace, plant):
    turning = np.sin(trace.time_s)[:, None] * np.array([3.0, 1.0, 0.5])
    assert texts([replace(trace, gyroscope_rad_s=turning)], plant, "refuse") == []
    degrees = replace(trace, gyroscope_rad_s=np.degrees(turning))
    one(texts([degrees], plant, "refuse"), "gyroscope", "degrees per second")

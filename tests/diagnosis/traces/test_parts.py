"""Parts of recordings know what was before them."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.plant.servo import Servo
from diagnosis.traces import trace
from diagnosis.traces.trace import BEFORE_ROWS, Trace
from diagnosis.traces.windows import Run

HZ = 250
NOISE_RAD = 4e-5
BRAKE_S = 1.0
"""Joints that moved at a steady speed begin to brake at this time."""
SPEED_RAD_S, BRAKING_RAD_S2 = np.array([3.0, -2.0]), np.array([-60.0, 50.0])


def braking(seed=0):
    """Two joints that brake suddenly, and their true speeds (T, 2)."""
    time_s = np.arange(2 * HZ) / HZ
    since = np.clip(time_s - BRAKE_S, 0.0, np.abs(SPEED_RAD_S / BRAKING_RAD_S2).min())
    position = np.outer(time_s, SPEED_RAD_S) + np.outer(since**2 / 2, BRAKING_RAD_S2)
    late = np.maximum(time_s - BRAKE_S - since, 0.0)
    position += np.outer(late * since, BRAKING_RAD_S2)
    speed = SPEED_RAD_S + np.outer(since, BRAKING_RAD_S2)
    noise = NOISE_RAD * np.random.default_rng(seed).standard_normal(position.shape)
    command = position + 0.01 * np.arange(len(time_s))[:, None]
    servo = Servo.ideal(2)
    return Trace("t", time_s, position + noise, servo, command_rad=command), speed


FIRST = int((BRAKE_S - 0.008) * HZ)
"""A row just before they brake."""


def test_the_speed_in_the_midst_of_a_motion_is_known_from_both_sides():
    near, far = [], []
    for seed in range(10):
        whole, speed = braking(seed)
        part = whole.part(FIRST, FIRST + HZ // 2)
        for found, one in ((near, part), (far, replace(part, before=None))):
            found.append(Run.of(one).velocity_rad_s - speed[FIRST])
    near, far = (np.sqrt(np.mean(np.square(one))) for one in (near, far))
    assert near < 0.03
    assert far > 2 * near


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_how_many_rows_are_kept_before_a_part_does_not_matter(monkeypatch, factor):
    whole, _ = braking()
    usual = Run.of(whole.part(FIRST, FIRST + HZ // 2)).velocity_rad_s
    monkeypatch.setattr(trace, "BEFORE_ROWS", int(factor * BEFORE_ROWS))
    other = Run.of(whole.part(FIRST, FIRST + HZ // 2)).velocity_rad_s
    np.testing.assert_allclose(other, usual, atol=0.01)


def test_rows_before_a_part_lead_to_it():
    whole, _ = braking()
    part = whole.part(FIRST, FIRST + 20)
    assert part.ticks == 20
    assert part.before is not None
    assert part.before.ticks == BEFORE_ROWS
    led = part.led()
    own = slice(FIRST - BEFORE_ROWS, FIRST + 20)
    np.testing.assert_array_equal(led.time_s, whole.time_s[own])
    np.testing.assert_array_equal(led.command_rad, whole.command_rad[own])
    assert led.before is None


def test_a_part_at_the_start_has_only_what_was_before_the_whole():
    whole, _ = braking()
    assert whole.part(0, 20).before is None
    assert whole.part(0, 20).led().ticks == 20
    again = whole.part(FIRST, FIRST + 50).part(0, 20)
    assert again.before is not None
    assert again.before.time_s[-1] == whole.time_s[FIRST - 1]
    near = whole.part(3, 20)
    assert near.before is not None
    assert near.before.ticks == 3


def test_some_joints_of_a_part():
    whole, _ = braking()
    one = whole.part(FIRST, FIRST + 20).of([1])
    assert one.before is not None
    assert one.before.position_rad.shape == (BEFORE_ROWS, 1)
    assert one.led().position_rad.shape == (BEFORE_ROWS + 20, 1)


def test_late_commands_of_a_part_are_those_from_before_it():
    whole, _ = braking()
    run = Run.of(whole.part(FIRST, FIRST + 20))
    assert run.whole is not None
    earlier = np.searchsorted(run.whole.time_s, run.trace.time_s[0]) - 3
    np.testing.assert_array_equal(
        run.whole.command_rad[earlier], whole.command_rad[FIRST - 3]
    )
    assert Run.of(whole).whole is None


def test_the_acceleration_at_a_part_s_start_is_known_and_that_of_a_whole_is_not():
    """Swings have it to 1 %; at a recording's first row the motion counts as steady."""
    time_s = np.arange(2 * HZ) / HZ
    position = np.outer(np.sin(6 * time_s), [0.3, -0.2])
    noise = NOISE_RAD * np.random.default_rng(0).standard_normal(position.shape)
    swinging = Trace("t", time_s, position + noise, Servo.ideal(2))
    row = 210
    found = Run.of(swinging.part(row, row + HZ)).acceleration_rad_s2
    assert found == pytest.approx(-36 * position[row], abs=0.01 * 36 * 0.3)
    assert Run.of(swinging).acceleration_rad_s2 is None

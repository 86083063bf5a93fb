"""A mass on a rough surface: it sticks below breakaway and slides above it."""

import math

import pytest

from worlds.hidden.effects.dry_friction import DryFriction, SoftBristles
from worlds.hidden.effects.kind import StiffContact

INERTIA, STEP_S = 0.05, 0.00025
CONTACT = StiffContact(INERTIA, STEP_S)


def slide(friction, pull, seconds, speed=0.0, servo=0.0):
    angle = 0.0
    for step in range(round(seconds / STEP_S)):
        time_s = step * STEP_S
        torque = pull(time_s) + friction.torque(time_s, angle, speed, servo)
        speed += torque / INERTIA * STEP_S
        angle += speed * STEP_S
    return angle, speed


def rough(**values):
    return DryFriction.of(CONTACT, **values)


def test_below_breakaway_it_holds():
    angle, speed = slide(rough(coulomb_nm=0.2), lambda t: 0.19, 2.0)
    assert abs(angle) < 2e-4
    assert abs(speed) < 1e-9


def test_above_breakaway_it_slides_with_what_is_left():
    angle, speed = slide(rough(coulomb_nm=0.2), lambda t: 0.3, 1.0)
    assert speed == pytest.approx(0.1 / INERTIA, rel=5e-3)
    assert angle == pytest.approx(0.1 / INERTIA / 2, rel=5e-3)


def test_it_does_not_creep_under_a_load_that_swings():
    angle, _ = slide(rough(coulomb_nm=0.2), lambda t: 0.19 * math.sin(40 * t), 5.0)
    assert abs(angle) < 2e-4


def test_it_brings_a_coasting_mass_to_rest_after_its_stopping_distance():
    angle, speed = slide(rough(coulomb_nm=0.2), lambda t: 0.0, 2.0, speed=1.0)
    assert angle == pytest.approx(INERTIA / 2 / 0.2, rel=2e-3)
    assert abs(speed) < 1e-6


def test_stribeck_needs_more_to_break_away_than_to_slide_on():
    def friction():
        return rough(coulomb_nm=0.1, extra_nm=0.1, speed_rad_s=0.05)

    assert abs(slide(friction(), lambda t: 0.19, 1.0)[0]) < 2e-4
    angle, speed = slide(friction(), lambda t: 0.15, 1.0, speed=1.0)
    assert speed == pytest.approx(1.0 + 0.05 / INERTIA, rel=1e-2)
    assert angle > 1.0


def test_load_friction_follows_the_servo():
    assert abs(slide(rough(load_share=0.1), lambda t: 0.19, 1.0, servo=-2.0)[0]) < 2e-4
    assert slide(rough(load_share=0.1), lambda t: 0.21, 1.0, servo=-2.0)[0] > 0.05


def test_lugre_hysteresis_is_a_spring_at_first_and_dry_friction_after_long_sliding():
    bristles = SoftBristles(0.2, 4.0, STEP_S)
    small = [bristles.torque(0.0, 0.0, 0.004, 0.0) for _ in range(250)][-1]
    assert small == pytest.approx(-4.0 * 0.004 * 250 * STEP_S, rel=1e-2)
    large = [bristles.torque(0.0, 0.0, 1.0, 0.0) for _ in range(8000)][-1]
    assert large == pytest.approx(-0.2, rel=1e-6)

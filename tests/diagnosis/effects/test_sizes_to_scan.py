"""Sizes around a guess that are tried before a fit."""

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.effects import PlacedEffect, effect
from diagnosis.effects.effect import LIMITS, STIFFNESSES, STRETCHES
from diagnosis.effects.servos import WEAKER


def sizes(name, *values, limit=8.0):
    plant = arm(limit=limit)
    placed = PlacedEffect(name, "elbow", values)
    traces = [recorded(plant, duration_s=1.0)]
    return [one.values for one in effect(name).sizes_to_scan(plant, placed, traces)]


def firsts(*args, **kwargs):
    return [values[0] for values in sizes(*args, **kwargs)]


def test_a_motor_may_be_weak_only_where_jumps_ask_for_all_of_it():
    """Quiet motions take half a newton metre, and the servo has eight."""
    tried = firsts("torque_limit", 0.5)
    assert tried == pytest.approx([0.5 * k for k in LIMITS] + [8 * s for s in WEAKER])


@pytest.mark.parametrize(
    ("limit", "name"), [(np.inf, "torque_limit"), (8.0, "speed_limit")]
)
def test_what_has_no_limit_is_no_weaker(limit, name):
    tried = firsts(name, 0.5, limit=limit)
    assert tried == pytest.approx([0.5 * k for k in LIMITS])


def test_other_effects_are_stretched_from_where_they_are_not_there():
    assert firsts("backlash", 0.01) == pytest.approx([0.01 * k for k in STRETCHES])
    assert firsts("servo_gain", 0.8) == pytest.approx([1 - 0.2 * k for k in STRETCHES])
    spring = sizes("joint_elasticity", 100.0, 0.2)
    assert spring == [(pytest.approx(100 * k), 0.2) for k in STIFFNESSES]
    assert sizes("end_stop", 0.3, -1.0) == [(0.3, -1.0)]

"""What a motion lacks, on motions that lack one thing each."""

import numpy as np
import pytest
from joint_rigs import plant_of, ticks, trace_of

from diagnosis.audit import audit
from diagnosis.check import variety as module
from diagnosis.check.variety import lacking, why_alike
from diagnosis.effects import PlacedEffect

WHEEL = """<body name="wheel"><joint name="hinge" axis="0 0 1"/>
  <inertial pos="0 0 0" mass="1" diaginertia="1 1 .02"/></body>"""
PLANT = plant_of(WHEEL, kp=10.0, kd=0.5, limit=5.0)
TIME_S = ticks(12.0)


def triangle(speed, reach=0.6):
    """There and back at one speed."""
    way = speed * TIME_S / reach
    return reach * (2 * np.abs(way / 2 - np.floor(way / 2 + 0.5)))


def lacks(position):
    noise = 1e-5 * np.random.default_rng(1).standard_normal(len(TIME_S))
    trace = trace_of(PLANT, TIME_S, position + noise, command_rad=position)
    return set(lacking(PLANT, [trace], audit([trace], PLANT))["hinge"])


LIVELY = 0.5 * np.sin(2 * np.pi * (0.1 + 0.08 * TIME_S) * TIME_S)
CASES = {
    "all": (LIVELY, set()),
    "one speed": (triangle(0.25), {"speeds", "accelerations"}),
    "one way": (0.1 * TIME_S + 0.002 * TIME_S**3 / 3, {"reversals", "accelerations"}),
    "small": (0.05 * LIVELY, {"poses"}),
    "slow": (0.6 * np.sin(2 * np.pi * 0.12 * TIME_S), {"accelerations"}),
}


@pytest.mark.parametrize("case", CASES)
def test_what_a_motion_lacks(case):
    position, expected = CASES[case]
    assert lacks(position) == expected


def test_a_joint_at_rest_lacks_all():
    assert lacks(np.zeros_like(TIME_S)) == set(module.WORDS)


@pytest.mark.parametrize("factor", [0.5, 2.0])
@pytest.mark.parametrize("name", ["ONE_SPEED", "ONE_POSE_RAD"])
def test_a_factor_of_two_does_not_matter(monkeypatch, name, factor):
    monkeypatch.setattr(module, name, factor * getattr(module, name))
    for position, expected in CASES.values():
        assert lacks(position) == expected


def test_the_reason_is_what_one_of_two_effects_needs():
    viscous = PlacedEffect("viscous_friction", "elbow")
    dry = PlacedEffect("coulomb_friction", "elbow")
    poor = {"elbow": ("speeds",)}
    assert why_alike(dry, viscous, poor) == "elbow moved at one speed only"
    assert why_alike(dry, viscous, {"elbow": ("poses",)}) == ""
    assert why_alike(dry, viscous, {}) == ""

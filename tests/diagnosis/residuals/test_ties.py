from dataclasses import replace

import numpy as np
import pytest
from torque_arm import arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.ties import (
    groups_of,
    kinds_of,
    motors,
    number_of_values,
    tied,
    without_each,
)

EACH = tuple(
    PlacedEffect("coulomb_friction", joint, (value,))
    for joint, value in (("yaw", 1.0), ("shoulder", 2.0), ("elbow", 6.0))
)
SHARED = tied(arm(), EACH, "all")
LATE = PlacedEffect("command_latency", "commands", (0.01,))


def test_shared_values_count_once():
    assert number_of_values((*EACH, LATE)) == 4
    assert number_of_values((*SHARED, LATE)) == 2


def test_a_kind_at_half_of_the_joints_is_one():
    mass = PlacedEffect("payload_mass", "hand", (0.1,))
    assert kinds_of((*EACH, LATE, mass), 6) == [EACH, (LATE,), (mass,)]
    assert kinds_of((*EACH, LATE), 7) == [*((one,) for one in EACH), (LATE,)]
    assert kinds_of((*SHARED, LATE), 7) == [SHARED, (LATE,)]
    assert kinds_of((mass,), 1) == [(mass,)]


def test_shared_values_are_the_mean_at_first():
    assert [one.values for one in SHARED] == [(3.0,)] * 3
    assert tied(arm(), SHARED, "each") != SHARED
    assert not any(one.tied for one in tied(arm(), SHARED, "each"))


def test_effects_that_share_a_value_go_together():
    assert groups_of((*SHARED, LATE)) == [SHARED, (LATE,)]
    assert without_each((*SHARED, LATE)) == [(LATE,), SHARED]
    assert len(without_each(EACH)) == 3


def test_one_value_of_a_tie_changes_all():
    coordinates = Coordinates(arm(), (LATE, *SHARED))
    assert coordinates.columns == [[0], [1], [1], [1]]
    x = coordinates.of((LATE, *SHARED))
    moved = coordinates.model_at(x + np.array([0.0, 1.0]))
    assert len({one.values for one in moved[1:]}) == 1
    assert moved[1].values > SHARED[0].values
    assert moved[0] == LATE
    assert coordinates.columns_of(SHARED[:1]) == [1]


def test_what_the_motor_does_not_decide_is_not_shared():
    springs = tuple(PlacedEffect("joint_spring", one.place, (1.0, 0.0)) for one in EACH)
    assert tied(arm(), springs, "all") == springs


def test_joints_with_the_same_limits_have_the_same_motor():
    kinds = motors(arm())
    assert set(kinds) == set(arm().joints)
    spec = arm().spec.copy()
    spec.joint("elbow").armature = 0.5
    other = type(arm())("arm", spec, arm().joints, arm().servo)
    apart = motors(other)
    assert apart["elbow"] == "elbow"
    assert apart["yaw"] == apart["shoulder"] == "yaw"
    shared = tied(other, EACH, "motor")
    assert [one.values[0] for one in shared] == pytest.approx([1.5, 1.5, 6.0])
    assert [one.tied for one in shared] == ["shoulder", "shoulder", ""]


def test_a_tie_named_after_a_joint_leaves_that_joint_alone():
    """The first of the joints that share may since have a value of its own."""
    own = EACH[2]
    others = tuple(replace(one, tied="elbow") for one in SHARED[:2])
    for model in ((own, *others), (*others, own)):
        coordinates = Coordinates(arm(), model)
        assert len(coordinates.parameters) == 2
        assert len(groups_of(model)) == 2


@pytest.mark.parametrize("level", ["all", "motor", "each"])
def test_bodies_have_no_motor_to_share_a_value_by(level):
    """Two loads may have got one value, since they were as good as equal."""
    loads = [PlacedEffect("payload_mass", body, (0.1,), tied="lower")
             for body in ("lower", "upper")]  # fmt: skip
    assert not any(one.tied for one in tied(arm(), loads, level))

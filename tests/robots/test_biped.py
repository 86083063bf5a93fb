"""The NAO as a walk engine sees it."""

from dataclasses import replace

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from robots import biped
from robots.leg_geometry import LegGeometry
from robots.scale import NAO_SIZE

SLANT = np.sqrt(0.5)
LEG = ("HipYawPitch", "HipRoll", "HipPitch", "KneePitch", "AnklePitch", "AnkleRoll")


@pytest.fixture(scope="module")
def walker(nao):
    return biped(nao)


def with_joint(nao, name, **changes):
    """The NAO with one joint changed."""
    links = list(nao.links)
    links[nao.joints.index(name)] = replace(links[nao.joints.index(name)], **changes)
    return replace(nao, links=tuple(links))


def test_roles(nao, walker):
    for side, columns in (("L", walker.left_leg), ("R", walker.right_leg)):
        assert [nao.joints[k] for k in columns] == [side + name for name in LEG]
    for side, arm in (("L", walker.left_arm), ("R", walker.right_arm)):
        names = [side + "ShoulderPitch", side + "ShoulderRoll"]
        assert [nao.joints[k] for k in arm] == names


def test_geometry(walker):
    leg = walker.leg
    assert leg.hip_m == (0.0, 0.05, -0.085)
    np.testing.assert_allclose(leg.yaw_axis, [0, SLANT, -SLANT], atol=1e-9)
    assert (leg.thigh_m, leg.tibia_m, leg.ankle_height_m) == (0.1, 0.1029, 0.04511)


def test_limits_and_sensors(nao, walker):
    assert walker.joints == 20
    knee = nao.joints.index("RKneePitch")
    assert tuple(walker.joint_range_rad[knee]) == (-0.0923279, 2.11255)
    assert walker.max_speed_rad_s[knee] == 6.40239
    assert walker.foot_sensor_xy_m.shape == (8, 2)
    assert tuple(walker.foot_sensor_xy_m[0]) == (0.07025, 0.0299)
    assert tuple(walker.foot_sensor_xy_m[7]) == (-0.02965, -0.0299)


def test_a_robot_without_arms(nao):
    walker = biped(replace(nao, links=nao.links[:12]))
    assert walker.left_arm is None
    assert walker.right_arm is None
    assert walker.joints == 12


def test_a_leg_that_lacks_a_joint(nao):
    shin = nao.joints.index("RAnklePitch")
    left, right = nao.feet
    shorter = replace(nao, feet=(left, replace(right, joint=shin)))
    with pytest.raises(BadValueError, match=r"right leg has 5 joints.*RAnklePitch"):
        biped(shorter)


def test_axes_that_meet_need_no_chain(walker):
    assert walker.chains is None
    assert walker.scale == NAO_SIZE


@pytest.mark.parametrize("name", ["LHipRoll", "LHipPitch", "LAnkleRoll"])
def test_axes_that_do_not_meet_make_chains(nao, name):
    apart = with_joint(nao, name, origin_m=np.array([0.0, 0.001, 0.0]))
    left, right = biped(apart).chains
    assert left.origins_m[:, 1].sum() == pytest.approx(0.051)
    assert right.origins_m[:, 1].sum() == pytest.approx(-0.05)


def test_a_knee_that_does_not_bend(nao):
    twisted = with_joint(nao, "LKneePitch", axis=np.array([0.0, 0.0, 1.0]))
    with pytest.raises(BadValueError, match="knee's axis"):
        biped(twisted)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"thigh_m": 0.0}, "thigh_m"),
        ({"tibia_m": float("nan")}, "tibia_m"),
        ({"ankle_height_m": -0.01}, "ankle_height_m"),
        ({"hip_m": (0.0, float("inf"), 0.0)}, "hip_m"),
        ({"yaw_axis": (0.0, 0.0, 0.9)}, "yaw_axis"),
        ({"yaw_axis": (0.0, 1.0, 0.0)}, "yaw_axis"),
    ],
)
def test_legs_that_cannot_be(changes, name):
    leg = LegGeometry((0.0, 0.05, -0.085), (0.0, 0.0, 1.0), 0.1, 0.1, 0.05)
    with pytest.raises(BadValueError, match=name):
        replace(leg, **changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"right_leg": (0, 1, 2, 3, 4, 5)}, "must differ"),
        ({"left_arm": (12, 20)}, "must differ and be 0 to 19"),
        ({"max_speed_rad_s": np.zeros(20)}, "max_speed_rad_s must be positive"),
        ({"joint_range_rad": np.zeros((20, 2))}, "joint_range_rad must rise"),
    ],
)
def test_bipeds_that_cannot_be(walker, changes, message):
    with pytest.raises(BadValueError, match=message):
        replace(walker, **changes)

"""URDFs of other robots as descriptions."""

import math
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from made_up_urdf import ANKLE_M, HIP_Y_M, SHIN_M, THIGH_M, two_legged

import robots
from groundwalk.errors import BadModelError, GroundwalkError, UnknownNameError
from robots import biped
from robots.from_urdf.adaptation import Adaptation
from robots.from_urdf.adapter import adapted
from robots.scale import NAO_CENTRE_M, NAO_HIP_M, NAO_KG, Scale

HUMANOIDS = ("g1", "icub", "romeo", "simple_humanoid", "talos")


@pytest.fixture
def robot(tmp_path):
    """Function: the description of a made-up URDF, or of a TOML beside it."""

    def make(toml="", **options):
        (tmp_path / "made.urdf").write_text(two_legged(**options))
        name = "made.urdf"
        if toml:
            (tmp_path / "made.toml").write_text(f'urdf = "made.urdf"\n{toml}')
            name = "made.toml"
        robots.get.cache_clear()
        return robots.get(str(tmp_path / name))

    return make


def role_names(description, leg):
    return [description.joints[k] for k in leg]


@pytest.mark.parametrize("order", list(permutations(("yaw", "roll", "pitch"))))
def test_roles_follow_from_the_axes(robot, order):
    description = robot(order=order, flipped=("roll", "knee"))
    expected = ["yaw", "roll", "pitch", "knee", "ankle_pitch", "ankle_roll"]
    for side, leg in zip("ab", description.legs, strict=True):
        assert role_names(description, leg) == [f"{side}_{role}" for role in expected]


@pytest.mark.parametrize("facing", [0.0, np.pi / 2, np.pi, -np.pi / 2])
def test_every_facing_gives_the_same_robot(robot, facing):
    """Leg a is the left one only because of where the knees go."""
    description = robot(facing_rad=facing)
    reference = robot()
    for one, other in zip(description.links, reference.links, strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(one.origin_m, other.origin_m, atol=1e-12)
        np.testing.assert_allclose(one.axis, other.axis, atol=1e-12)
    np.testing.assert_allclose(
        np.sort(description.feet[0].outline_m, axis=0),
        np.sort(reference.feet[0].outline_m, axis=0),
        atol=1e-9,
    )


def test_knees_that_bend_forward_turn_the_robot_round(robot):
    description = robot(knee_range=(-2.0, 0.0))
    assert role_names(description, description.legs[0])[0] == "b_yaw"


def test_knees_that_bend_both_ways_say_nothing(robot):
    with pytest.raises(BadModelError, match="bend both ways"):
        robot(knee_range=(-1.0, 1.0))
    assert robot('forward = "x"', knee_range=(-1.0, 1.0)).legs is not None


def test_soles_and_sensors(robot):
    """The box is 200 x 80 x 40 mm, its centre 30 mm ahead of the ankle."""
    left, right = robot().feet
    assert left.sole_height_m == pytest.approx(-ANKLE_M)
    corners = [[0.13, 0.04], [0.13, -0.04], [-0.07, 0.04], [-0.07, -0.04]]
    np.testing.assert_allclose(left.sensors_m, corners, atol=1e-12)
    np.testing.assert_allclose(right.sensors_m, corners, atol=1e-12)


def test_a_sole_can_be_given(robot):
    with pytest.raises(BadModelError, match="give its sole"):
        robot(sole=False)
    toml = "[sole]\nheight_m = -0.05\nx_m = [-0.1, 0.1]\ny_m = [-0.02, 0.06]\n"
    left, right = robot(toml, sole=False).feet
    assert left.sole_height_m == -0.05
    assert (left.outline_m[:, 1].min(), left.outline_m[:, 1].max()) == (-0.02, 0.06)
    assert (right.outline_m[:, 1].min(), right.outline_m[:, 1].max()) == (-0.06, 0.02)


def test_masses_scale_and_geometry(robot):
    """5 + 2 x (6 x 0.5 + 1.2) kg; the hips 0.61 m above the soles."""
    description = robot()
    body = biped(description)
    assert description.mass_kg == pytest.approx(13.4)
    leg_m = (THIGH_M, SHIN_M, ANKLE_M)
    assert (body.leg.thigh_m, body.leg.tibia_m) == pytest.approx(leg_m[:2])
    assert body.leg.ankle_height_m == pytest.approx(ANKLE_M)
    assert body.leg.hip_m == pytest.approx((0.0, HIP_Y_M, 0.0))
    assert body.scale.length == pytest.approx(sum(leg_m) / NAO_HIP_M)
    assert body.scale.weight == pytest.approx(13.4 / NAO_KG)
    centre = 5 * 0.2 + 2 * (1.2 * 0.3 - 0.5 * (THIGH_M + 2 * (THIGH_M + SHIN_M)))
    height_m = centre / 13.4 + sum(leg_m)
    assert body.scale.time == pytest.approx(np.sqrt(height_m / NAO_CENTRE_M))


def test_arms_hang(robot):
    """At zero they point forward: a quarter turn about y lets them hang."""
    description = robot()
    assert description.hanging_rad == pytest.approx((np.pi / 2, np.pi / 2))
    body = biped(description)
    assert role_names(description, body.left_arm) == ["a_shoulder"]
    assert biped(robot(arms=False)).left_arm is None


def test_wrists_are_held_and_can_be_moved(robot):
    assert "a_wrist" not in robot().joints
    moving = robot('moving = ["a_wrist"]')
    assert "a_wrist" in moving.joints
    assert moving.mass_kg == pytest.approx(robot().mass_kg)


def test_overrides(robot):
    toml = """
[range_rad]
a_knee = [0.1, 1.0]
[effort_nm]
a_knee = 7.0
[speed_rad_s]
a_knee = 3.0
"""
    description = robot(toml)
    knee = description.links[description.joints.index("a_knee")]
    assert knee.range_rad == (0.1, 1.0)
    assert (knee.motor.stall_torque_nm, knee.motor.no_load_speed_rad_s) == (7.0, 3.0)


@pytest.mark.parametrize(
    ("toml", "message"),
    [
        ('moving = ["a_elbow"]', "did you mean"),
        ("colour = 3", "unknown key"),
        ('forward = "up"', "unknown direction"),
        ('left_leg = ["a_yaw"]', "names 1 joints"),
        ('held = ["a_knee"]', "has 5 joints"),
        ("[effort_nm]\na_knee = 0.0", "must be positive"),
        ("[sole]\nheight_m = 0.1\nx_m = [0, 1]\ny_m = [0, 1]", "height_m < 0"),
        ("[sole]\nwidth = 0.1", "no robot"),
    ],
)
def test_what_cannot_be_told(robot, toml, message):
    with pytest.raises(GroundwalkError, match=message):
        robot(toml)


def test_names_and_files_that_are_not_there(tmp_path):
    with pytest.raises(BadModelError, match="no such file"):
        robots.get(str(tmp_path / "none.urdf"))
    with pytest.raises(UnknownNameError, match="did you mean 'talos'"):
        robots.get("talo")


@pytest.mark.parametrize("name", HUMANOIDS)
def test_humanoids_of_example_robot_data(name):
    """Sizes of grown-up and child-sized robots, feet below hips, shapes to look at."""
    description = robots.get(name)
    body = biped(description)
    assert body.leg.hip_m[1] > 0.05
    assert isinstance(description.scale, Scale)
    assert 1.8 < description.scale.length < 3.5
    for foot in description.feet:
        assert foot.outline_m[:, 0].max() > -foot.outline_m[:, 0].min() * 0.8
        assert -0.12 < foot.sole_height_m < -0.03
    assert all(joint.link.shapes for joint in description.links[:6])


@pytest.mark.parametrize(
    ("name", "sole_m", "length_m"),
    [("g1", 0.035, 0.17), ("talos", 0.107, 0.21), ("icub", 0.041, 0.157)],
)
def test_soles_of_meshes_and_spheres(name, sole_m, length_m):
    """By hand: G1's four spheres; the other two state a sole frame, 107 and 41 mm."""
    foot = robots.get(name).feet[0]
    assert foot.sole_height_m == pytest.approx(-sole_m, abs=1e-3)
    assert np.ptp(foot.outline_m[:, 0]) == pytest.approx(length_m, abs=2e-3)


def test_meshes_are_found():
    description = robots.get("g1")
    meshes = [mesh for joint in description.links for mesh in joint.link.meshes]
    assert len(meshes) > 20
    assert all(mesh.path.is_file() for mesh in meshes)


def test_no_ball_hovers_beside_the_robot():
    """This robot's trunk is fixed above its pelvis, and nothing hangs on it."""
    legs = Adaptation(urdf="alexander_v1.lowerBodyOnly")
    shapes = adapted("legs", legs, Path()).root.shapes
    balls = [one for one in shapes if one.start_m == one.end_m]
    ends = [
        end for one in shapes if one not in balls for end in (one.start_m, one.end_m)
    ]
    assert balls
    for ball in balls:
        assert min(math.dist(ball.start_m, end) for end in ends) <= ball.radius_m

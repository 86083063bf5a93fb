"""The NAO's description against published numbers (facts sheet, section 3)."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from groundwalk.errors import BadValueError
from robots.description import Motor

LEG = ("HipYawPitch", "HipRoll", "HipPitch", "KneePitch", "AnklePitch", "AnkleRoll")
ARM = ("ShoulderPitch", "ShoulderRoll", "ElbowYaw", "ElbowRoll")
STANDING = (-0.0302, 0.0596, -0.0294)  # hip, knee, ankle pitch at hip height 0.248 m
CROUCHED = (-0.3746, 0.8446, -0.4699)  # at 0.23 m, the feet 10 mm back
LOW = (-0.5699, 1.2405, -0.6707)  # at 0.21 m, likewise


def joint_of(nao, name):
    return nao.links[nao.joints.index(name)]


def mass_of(nao, side, names):
    return sum(joint_of(nao, side + name).link.inertial.mass_kg for name in names)


def test_joints_are_the_twenty_that_move(nao):
    expected = [side + name for side in "LR" for name in LEG]
    expected += [side + name for side in "LR" for name in ARM]
    assert list(nao.joints) == expected
    assert nao.joint_range_rad.shape == (20, 2)
    assert nao.no_load_speed_rad_s.shape == (20,)


def test_total_masses(nao):
    assert nao.mass_kg == pytest.approx(5.305, abs=5e-4)
    for side in "LR":
        assert mass_of(nao, side, LEG) == pytest.approx(1.207, abs=5e-4)
        assert mass_of(nao, side, ARM) == pytest.approx(0.579, abs=5e-4)


@pytest.mark.parametrize(
    ("joint", "mass_kg", "com_mm", "inertia"),  # inertia: 1e-6 kg m^2, about the com
    [
        (
            "LKneePitch",
            0.30142,
            (4.53, 2.25, -49.36),
            (446.171, 388.084, 185.516, 3.706, -30.901, 6.020),
        ),
        (
            "LAnkleRoll",
            0.17184,
            (25.42, 3.30, -32.39),
            (87.291, 353.024, 412.846, 8.719, -2.106, 0.373),
        ),
        (
            "LShoulderPitch",
            0.09304,
            (-1.65, -26.63, 0.14),
            (18.303, 13.901, 20.186, 2.060, 0.0019, -0.367),
        ),
    ],
)
def test_links(nao, joint, mass_kg, com_mm, inertia):
    own = joint_of(nao, joint).link.inertial
    assert own.mass_kg == mass_kg
    np.testing.assert_allclose(own.com_m, np.array(com_mm) / 1e3, atol=1e-9)
    components = own.inertia_kg_m2[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(components, np.array(inertia) * 1e-6, atol=1e-9)
    np.testing.assert_array_equal(own.inertia_kg_m2, own.inertia_kg_m2.T)


def test_two_right_links_are_no_mirror_images(nao):
    pelvis = joint_of(nao, "RHipYawPitch").link.inertial.inertia_kg_m2
    bicep = joint_of(nao, "RShoulderRoll").link.inertial.inertia_kg_m2
    assert pelvis[0, 0] == pytest.approx(31.88e-6, abs=5e-9)
    np.testing.assert_allclose(
        [*np.diag(bicep), bicep[0, 1]],
        np.array([103.40, 270.77, 254.53, 54.88]) * 1e-6,
        atol=5e-9,
    )


@pytest.mark.parametrize(
    ("name", "origin_m", "axis", "range_rad"),
    [
        ("LHipYawPitch", (0, 0.05, -0.085), (0, 1, -1), (-1.14529, 0.740718)),
        ("RHipYawPitch", (0, -0.05, -0.085), (0, 1, 1), (-1.14529, 0.740718)),
        ("RHipRoll", (0, 0, 0), (1, 0, 0), (-0.79046, 0.379435)),
        ("LKneePitch", (0, 0, -0.1), (0, 1, 0), (-0.0923279, 2.11255)),
        ("RAnklePitch", (0, 0, -0.1029), (0, 1, 0), (-1.1863, 0.932006)),
        ("LShoulderPitch", (0, 0.098, 0.1), (0, 1, 0), (-2.08567, 2.08567)),
        ("LElbowYaw", (0.105, 0.015, 0), (1, 0, 0), (-2.08567, 2.08567)),
        ("RElbowRoll", (0, 0, 0), (0, 0, 1), (0.0349066, 1.54462)),
    ],
)
def test_joints(nao, name, origin_m, axis, range_rad):
    joint = joint_of(nao, name)
    np.testing.assert_allclose(joint.origin_m, origin_m, atol=1e-12)
    np.testing.assert_allclose(joint.axis, axis / np.linalg.norm(axis), atol=1e-12)
    assert joint.range_rad == range_rad


@pytest.mark.parametrize(
    ("name", "gear", "speed_rad_s"),
    [("LKneePitch", 130.85, 6.40239), ("RHipRoll", 201.3, 4.16174)],
)
def test_leg_motors(nao, name, gear, speed_rad_s):
    """The maker's leg motor: 59.5 mN m at stall, 8000 rpm, behind the joint's gear."""
    motor = joint_of(nao, name).motor
    assert motor.stall_torque_nm == pytest.approx(59.5e-3 * gear, rel=1e-3)
    assert motor.no_load_speed_rad_s == pytest.approx(speed_rad_s, rel=1e-9)
    assert motor.no_load_speed_rad_s == pytest.approx(
        8000 * 2 * np.pi / 60 / gear, rel=1e-3
    )
    assert motor.rotor_kg_m2 == pytest.approx(4e-7 * gear**2, rel=1e-9)


def test_damping_is_back_emf(nao):
    for joint in nao.links:
        motor = joint.motor
        assert motor.kd_nm_s_rad == pytest.approx(
            motor.stall_torque_nm / motor.no_load_speed_rad_s, rel=1e-12
        )


def test_coupled_joints_have_half_a_motor_each(nao):
    (pair,) = nao.coupled
    assert [nao.joints[joint] for joint in pair] == ["LHipYawPitch", "RHipYawPitch"]
    whole = joint_of(nao, "LHipRoll").motor  # the same kind of motor, not shared
    for joint in pair:
        half = nao.links[joint].motor
        assert half.no_load_speed_rad_s == whole.no_load_speed_rad_s
        for name in ("stall_torque_nm", "kp_nm_rad", "kd_nm_s_rad", "rotor_kg_m2"):
            assert 2 * getattr(half, name) == pytest.approx(getattr(whole, name))


def test_no_motor_is_negative():
    motor = Motor(1.0, 2.0, 3.0, 4.0, 5.0)
    for bad in (-1e-9, float("nan"), float("inf")):
        with pytest.raises(BadValueError, match="kd_nm_s_rad"):
            replace(motor, kd_nm_s_rad=bad)


def test_sensors_sit_where_they_were_measured(nao):
    published_mm = {
        "left": [[70.25, 29.9], [70.25, -23.1], [-30.25, 29.9], [-29.65, -19.1]],
        "right": [[70.25, 23.1], [70.25, -29.9], [-30.25, 19.1], [-29.65, -29.9]],
    }
    for foot, places in zip(nao.feet, published_mm.values(), strict=True):
        np.testing.assert_allclose(foot.sensors_m, np.array(places) / 1e3, atol=1e-12)
    assert nao.imu.gyroscope_m == (-0.008, 0.006, 0.029)
    assert nao.imu.accelerometer_m == (-0.008, 0.00606, 0.027)


def test_soles_reach_as_far_as_measured(nao):
    for foot, outer in zip(nao.feet, (1, -1), strict=True):
        low, high = foot.outline_m.min(axis=0), foot.outline_m.max(axis=0)
        assert (low[0], high[0]) == pytest.approx((-0.0507, 0.0994), abs=1e-12)
        across = sorted([-0.0388 * outer, 0.05 * outer])
        np.testing.assert_allclose([low[1], high[1]], across, atol=1e-12)
        assert foot.sole_height_m == -0.04511


@pytest.mark.parametrize(
    ("pitches", "height_mm", "ahead_mm"),
    [(STANDING, 276.7, None), (CROUCHED, 262.5, 14.1), (LOW, 247.0, None)],
)
def test_centre_of_mass(nao, model, pitches, height_mm, ahead_mm):
    """Its height above the sole, and how far it is ahead of the ankle.

    The facts sheet does not say how the arms hang: that moves it by a millimetre.
    """
    data = mujoco.MjData(model)
    pose = dict(zip(("HipPitch", "KneePitch", "AnklePitch"), pitches, strict=True))
    for side in "LR":
        for name, angle in (pose | {"ShoulderPitch": np.pi / 2}).items():
            data.joint(side + name).qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    x, y, z = data.subtree_com[model.body("torso").id]
    foot = data.body("LFoot").xpos
    assert 1e3 * (z - foot[2] + 0.04511) == pytest.approx(height_mm, abs=0.7)
    assert abs(y) < 1e-3
    if ahead_mm is not None:
        assert 1e3 * (x - foot[0]) == pytest.approx(ahead_mm, abs=0.2)

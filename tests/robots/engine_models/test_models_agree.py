"""MuJoCo's and PyBullet's model of one robot, held against each other."""

from dataclasses import replace

import mujoco
import numpy as np
import pybullet
import pytest
from scipy.spatial.transform import Rotation

POSES = 1000
STATIC_POSES = 50


@pytest.fixture(scope="module")
def fixed_body(nao, load_urdf):
    return load_urdf(nao)


def mujoco_feet(model, nao, poses):
    """Places (n, 2, 3) and rotations (n, 2, 3, 3) of both feet in MuJoCo."""
    data = mujoco.MjData(model)
    bodies = [model.body(nao.links[foot.joint].link.name).id for foot in nao.feet]
    places, turns = [], []
    for pose in poses:
        data.qpos[:] = pose
        mujoco.mj_kinematics(model, data)
        places.append(data.xpos[bodies])
        turns.append(data.xmat[bodies].reshape(-1, 3, 3))
    return np.array(places), np.array(turns)


def bullet_feet(client, body, nao, poses):
    """The same in PyBullet."""
    feet = [foot.joint for foot in nao.feet]
    places, turns = [], []
    for pose in poses:
        for joint, angle in enumerate(pose.tolist()):
            pybullet.resetJointState(body, joint, angle, physicsClientId=client)
        states = pybullet.getLinkStates(
            body, feet, computeForwardKinematics=1, physicsClientId=client
        )
        places.append([state[4] for state in states])
        turns.append(Rotation.from_quat([state[5] for state in states]).as_matrix())
    return np.array(places), np.array(turns)


def mujoco_inertial(model, link):
    """Mass, centre of mass and inertia tensor of a link, in its joint's frame."""
    body = model.body(link).id
    turn = Rotation.from_quat(model.body_iquat[body], scalar_first=True).as_matrix()
    tensor = turn @ np.diag(model.body_inertia[body]) @ turn.T
    return model.body_mass[body], model.body_ipos[body], tensor


def bullet_inertial(client, body, index):
    info = pybullet.getDynamicsInfo(body, index, physicsClientId=client)
    turn = Rotation.from_quat(info[4]).as_matrix()
    return info[0], np.array(info[3]), turn @ np.diag(info[2]) @ turn.T


def test_joints_come_in_the_same_order(model, bullet, fixed_body, nao):
    count = pybullet.getNumJoints(fixed_body, physicsClientId=bullet)
    infos = [
        pybullet.getJointInfo(fixed_body, k, physicsClientId=bullet)
        for k in range(count)
    ]
    assert tuple(info[1].decode() for info in infos) == nao.joints
    assert tuple(info[12].decode() for info in infos) == tuple(
        joint.link.name for joint in nao.links
    )
    hinges = [model.joint(k).name for k in range(model.njnt)]
    assert tuple(hinges) == ("root", *nao.joints)
    assert tuple(model.actuator(k).name for k in range(model.nu)) == nao.joints


def test_joint_limits_are_equal_to_the_last_bit(fixed_model, bullet, fixed_body, nao):
    for k, joint in enumerate(nao.links):
        info = pybullet.getJointInfo(fixed_body, k, physicsClientId=bullet)
        assert (info[8], info[9]) == joint.range_rad
        assert tuple(fixed_model.joint(joint.name).range) == joint.range_rad
        assert info[10] == joint.motor.stall_torque_nm
        assert info[11] == joint.motor.no_load_speed_rad_s
    assert fixed_model.jnt_limited.all()


def test_masses_and_inertias(model, bullet, load_urdf, nao):
    floating = load_urdf(nao, fixed=False)
    links = [nao.root.name, *(joint.link.name for joint in nao.links)]
    for index, link in enumerate(links, start=-1):
        mass, centre, tensor = bullet_inertial(bullet, floating, index)
        own_mass, own_centre, own_tensor = mujoco_inertial(model, link)
        assert mass == pytest.approx(own_mass, rel=1e-6)
        np.testing.assert_allclose(centre, own_centre, rtol=1e-6, atol=1e-12)
        difference = np.linalg.norm(tensor - own_tensor)
        assert difference <= 1e-6 * np.linalg.norm(own_tensor), link


def test_inertias_differ_without_the_rotors(model, bullet, load_urdf, nao):
    """The comparison above sees a rotor of 4e-7 kg m^2 behind its gear."""
    bare = tuple(
        replace(joint, motor=replace(joint.motor, rotor_kg_m2=0.0))
        for joint in nao.links
    )
    body = load_urdf(replace(nao, links=bare))
    for index, joint in enumerate(nao.links):
        tensor = bullet_inertial(bullet, body, index)[2]
        own = mujoco_inertial(model, joint.link.name)[2]
        assert np.linalg.norm(tensor - own) > 1e-2 * np.linalg.norm(own)


def test_feet_are_where_a_third_library_says(
    fixed_model, bullet, fixed_body, nao, random_poses, link_frames
):
    poses = random_poses(POSES, seed=1)
    turns, places = link_frames(nao, poses)
    feet = [foot.joint for foot in nao.feet]
    expected_m = np.stack([places[joint] for joint in feet], axis=1)
    expected_turn = np.stack([turns[joint] for joint in feet], axis=1)
    for engine in (
        mujoco_feet(fixed_model, nao, poses),
        bullet_feet(bullet, fixed_body, nao, poses),
    ):
        np.testing.assert_allclose(engine[0], expected_m, rtol=0, atol=1e-6)
        np.testing.assert_allclose(engine[1], expected_turn, rtol=0, atol=1e-5)


def test_a_leg_longer_by_a_hundredth_of_a_millimetre_shows(
    bullet, load_urdf, nao, random_poses, link_frames
):
    knee = nao.joints.index("LKneePitch")
    links = list(nao.links)
    links[knee] = replace(
        links[knee], origin_m=links[knee].origin_m - np.array([0, 0, 1e-5])
    )
    body = load_urdf(replace(nao, links=tuple(links)))
    poses = random_poses(20, seed=2)
    _, places = link_frames(nao, poses)
    left, right = (places[foot.joint] for foot in nao.feet)
    measured_m, _ = bullet_feet(bullet, body, nao, poses)
    assert np.abs(measured_m[:, 0] - left).max(axis=1).min() > 5e-6
    assert np.abs(measured_m[:, 1] - right).max() < 1e-6


def test_static_torques(fixed_model, bullet, fixed_body, nao, random_poses):
    data, still = mujoco.MjData(fixed_model), [0.0] * len(nao.joints)
    largest_nm = 0.0
    for pose in random_poses(STATIC_POSES, seed=3):
        data.qpos[:], data.qvel[:] = pose, 0
        mujoco.mj_forward(fixed_model, data)
        torque_nm = pybullet.calculateInverseDynamics(
            fixed_body, pose.tolist(), still, still, physicsClientId=bullet
        )
        np.testing.assert_allclose(torque_nm, data.qfrc_bias, rtol=0, atol=1e-3)
        largest_nm = max(largest_nm, np.abs(data.qfrc_bias).max())
    assert largest_nm > 0.5

from pathlib import Path

import mujoco
import numpy as np
import pytest

import robots
from diagnosis.plant.load import load_plant
from diagnosis.traces.read import read_traces
from groundwalk.errors import (
    BadModelError,
    BadRecordingError,
    UnknownNameError,
)
from robots.from_urdf.mesh_files import example_robots
from worlds.recordings.metadata import ServoGains

DATA = Path(__file__).parents[4] / "shared" / "data"
ARM = """
<mujoco model="arm">
  <option integrator="Euler"/>
  <worldbody>
    <body name="upper" pos="0 0 .5">
      <joint name="shoulder" axis="0 1 0" damping="0.2" range="-90 90"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass="1"/>
      <body name="fore" pos="0 0 -.3">
        <joint name="elbow" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".5"/>
        <body name="hand" pos="0 0 -.2">
          <joint name="slider" type="slide" axis="0 0 1"/>
          <geom type="sphere" size=".03" mass=".1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position joint="shoulder" kp="30" kv="2" forcerange="-8 8"/>
    <position joint="elbow" kp="3" gear="2" forcerange="-1 1"/>
    <motor joint="slider"/>
  </actuator>
  <equality><joint joint1="elbow" joint2="slider" active="false"/></equality>
  <sensor><jointpos joint="slider"/><actuatorfrc actuator="shoulder_servo"/></sensor>
  <keyframe><key qpos="0 0 0.1" ctrl="0 0 0"/></keyframe>
</mujoco>
""".replace(
    '<position joint="shoulder"', '<position name="shoulder_servo" joint="shoulder"'
)
URDF = """
<robot name="one">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0 0 -.1"/><mass value="2"/>
      <inertia ixx=".02" iyy=".02" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>
    <collision><geometry><mesh filename="package://nowhere/arm.stl"/></geometry>
    </collision>
  </link>
  <link name="frame"><inertial><mass value="0"/>
    <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="12" velocity="3"/></joint>
  <joint name="tip" type="fixed"><parent link="arm"/><child link="frame"/></joint>
</robot>
"""


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    return path


def torque_of(plant, joint, command, position, velocity):
    """(v,) what a joint's actuator and damping do together, by MuJoCo."""
    data = mujoco.MjData(plant.model)
    column = plant.joints.index(joint)
    data.qpos[plant.qpos[column]] = position
    data.qvel[plant.dofs[column]] = velocity
    data.ctrl[plant.actuators[column]] = command
    mujoco.mj_forward(plant.model, data)
    dof = plant.dofs[column]
    return data.qfrc_actuator[dof] + data.qfrc_damper[dof]


def test_position_actuators_become_the_servo(arm):
    plant = load_plant(arm, "fixed")
    assert plant.name == "arm"
    assert plant.joints == ("shoulder", "elbow", "slider")
    # a gear of 2 multiplies stiffness by 4 and the limit by 2
    np.testing.assert_allclose(plant.servo.kp_nm_rad, [30, 12, 0])
    np.testing.assert_allclose(plant.servo.kd_nm_s_rad, [2, 0, 0])
    np.testing.assert_allclose(plant.servo.max_torque_nm, [8, 2, np.inf])
    assert [plant.model.actuator(i).name for i in range(3)] == list(plant.joints)
    assert plant.model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST


def test_the_model_has_the_servo_s_law(arm):
    plant = load_plant(arm, "fixed")
    # kp (c - q) - kd v, and the joint's own damping of 0.2 beside the limit
    law = 30 * (0.1 - 0.02) - 2 * 0.5
    assert torque_of(plant, "shoulder", 0.1, 0.02, 0.5) == pytest.approx(law - 0.1)
    assert torque_of(plant, "shoulder", 1.0, 0.0, 0.5) == pytest.approx(8 - 0.1)
    assert torque_of(plant, "slider", 1.0, 0.0, 0.5) == 0


def test_gains_go_before_the_model(arm):
    gains = {"elbow": ServoGains(5.0, 0.4, 1.5)}
    plant = load_plant(arm, "fixed", servo=gains)
    np.testing.assert_allclose(plant.servo.kp_nm_rad, [30, 5, 0])
    np.testing.assert_allclose(plant.servo.kd_nm_s_rad, [2, 0.4, 0])
    np.testing.assert_allclose(plant.servo.max_torque_nm, [8, 1.5, np.inf])
    with pytest.raises(UnknownNameError, match="did you mean 'elbow'"):
        load_plant(arm, "fixed", servo={"elbwo": ServoGains(5.0, 0.4, 1.5)})


def test_other_joints_are_welded(arm):
    plant = load_plant(arm, "fixed", ["elbow"])
    assert plant.joints == ("elbow",)
    assert plant.model.nv == 1
    # forearm and hand are one body; the upper arm does not move
    assert plant.bodies == ("fore",)
    assert plant.model.body("fore").mass[0] == pytest.approx(0.6)


def test_unknown_joint_is_named_with_its_nearest(arm):
    with pytest.raises(BadRecordingError, match=r"'sholder'.*did you mean 'shoulder'"):
        load_plant(arm, "fixed", ["sholder", "elbow"])


def test_floating_base_gets_root_and_ground(arm):
    with pytest.raises(BadModelError, match="upper is to float, but it has"):
        load_plant(arm, "floating")
    base = '<worldbody><body name="base"><geom size=".1"/>'
    text = ARM.replace("<worldbody>", base).replace(
        "</worldbody>", "</body></worldbody>"
    )
    arm.write_text(text)
    floating = load_plant(arm, "floating").model
    assert floating.joint("root").type[0] == mujoco.mjtJoint.mjJNT_FREE
    assert floating.nv == 9
    assert floating.geom("ground").type[0] == mujoco.mjtGeom.mjGEOM_PLANE
    contact = mujoco.mjtDisableBit.mjDSBL_CONTACT
    assert not floating.opt.disableflags & contact
    assert load_plant(arm, "fixed").model.opt.disableflags & contact


def test_urdf_needs_no_meshes(tmp_path):
    path = tmp_path / "one.urdf"
    path.write_text(URDF)
    plant = load_plant(path, "fixed")
    assert plant.joints == ("hinge",)
    assert plant.bodies == ("arm",)
    assert plant.model.body("arm").mass[0] == pytest.approx(2)
    np.testing.assert_allclose(plant.servo.max_torque_nm, [12])
    np.testing.assert_allclose(plant.model.jnt_range, [[-1, 2]])


def test_no_model_is_refused(tmp_path):
    for name, text in (
        ("a.urdf", "<mujoco/>"),
        ("b.urdf", "no xml"),
        ("c.xml", "<mujoco><worldbody><bdy/></worldbody></mujoco>"),
    ):
        (tmp_path / name).write_text(text)
        with pytest.raises(BadModelError, match=name):
            load_plant(tmp_path / name, "fixed")
    with pytest.raises(BadModelError, match="no such file"):
        load_plant(tmp_path / "absent.xml", "fixed")


def test_unknown_robot_has_its_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'so101'"):
        load_plant("so1o1", "fixed")


def test_nao_has_the_description_s_motors(nao):
    plant = load_plant("nao", "fixed")
    assert set(plant.joints) == set(nao.joints)
    assert plant.model.nv == 20
    motor = nao.links[nao.joints.index("LKneePitch")].motor
    column = plant.joints.index("LKneePitch")
    assert plant.servo.kp_nm_rad[column] == motor.kp_nm_rad
    assert plant.servo.kd_nm_s_rad[column] == 0
    assert plant.servo.back_emf_nm_s_rad[column] == motor.kd_nm_s_rad
    # saturated, and slowed down by its back-EMF: the torque-speed line
    full = torque_of(plant, "LKneePitch", 1.0, 0.0, 2.0)
    line = motor.stall_torque_nm * (1 - 2.0 / motor.no_load_speed_rad_s)
    assert full == pytest.approx(line)


def test_nao_damping_of_gains_is_back_emf():
    gains = {"LKneePitch": ServoGains(40.0, 0.7, 5.0)}
    plant = load_plant("nao", "fixed", servo=gains)
    column = plant.joints.index("LKneePitch")
    assert plant.servo.back_emf_nm_s_rad[column] == 0.7
    assert plant.servo.kd_nm_s_rad[column] == 0


def test_nao_on_the_ground_carries_its_weight():
    plant = load_plant("nao", "floating")
    assert plant.feet == ("LFoot", "RFoot")
    model = plant.model
    data = mujoco.MjData(model)
    # feet just below the ground
    lowest = min(geom_z(model, data, name) for name in ("sole_left_0", "sole_right_0"))
    data.qpos[2] -= lowest + 1e-4
    for _ in range(int(0.5 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    force = np.zeros(6)
    total = 0.0
    for k in range(data.ncon):
        mujoco.mj_contactForce(model, data, k, force)
        total += force[0]
    assert total == pytest.approx(robots.get("nao").mass_kg * 9.81, rel=0.2)


def geom_z(model, data, name):
    mujoco.mj_forward(model, data)
    geom = model.geom(name)
    return data.geom_xpos[geom.id, 2] - geom.size[0]


def test_some_joints_of_nao_without_their_coupled_one():
    plant = load_plant("nao", "fixed", ["LHipYawPitch", "LKneePitch"])
    assert plant.model.nv == 2
    assert plant.model.neq == 0


def test_feet_are_what_reaches_lowest():
    feet = load_plant("a1", "floating").feet
    assert sorted(feet) == ["FL_calf", "FR_calf", "RL_calf", "RR_calf"]
    assert {foot[1] for foot in feet[:2]} == {"L"}
    assert load_plant("a1", "fixed").feet == ()


@pytest.mark.slow
def test_every_example_robot_loads():
    assert len(example_robots()) > 50
    for name in example_robots():
        plant = load_plant(name, "fixed")
        assert np.isfinite(plant.model.body_inertia).all()
        assert plant.model.nu == len(plant.joints)


@pytest.mark.parametrize(
    ("pattern", "source", "joints", "servo"),
    [
        ("so101/*.parquet", "so101", 5, ServoGains(15.0, 1.0, 3.0)),
        ("go2/*.parquet", "go2", 12, ServoGains(20.0, 1.5, 45.0)),
        ("emps/*.parquet", DATA / "emps" / "emps.xml", 1, None),
    ],
)
def test_real_recordings_fit_their_models(pattern, source, joints, servo):
    paths = sorted(DATA.glob(pattern))
    if not paths:
        pytest.skip(f"no recordings of {pattern} in ../shared/data")
    plant, traces = read_traces(paths, source, servo)
    assert len(plant.joints) == joints == plant.model.nv == plant.model.nu
    assert len(traces) == len(paths)
    assert all(np.isfinite(trace.position_rad).all() for trace in traces)
    if servo is None:
        np.testing.assert_allclose(plant.servo.kp_nm_rad, [1370700])


def test_a_known_motor_brings_its_back_emf_and_its_rotor(arm):
    motor = ServoGains(5.0, 0.0, 1.5, back_emf=0.3, armature=0.02)
    plant = load_plant(arm, "fixed", servo={"elbow": motor})
    elbow = plant.joints.index("elbow")
    assert plant.servo.back_emf_nm_s_rad[elbow] == 0.3
    assert plant.servo.kd_nm_s_rad[elbow] == 0.0
    dof = plant.dofs[elbow]
    assert plant.model.dof_armature[dof] == 0.02
    assert plant.model.dof_damping[dof] == 0.3
    others = [plant.dofs[plant.joints.index(name)] for name in ("shoulder", "slider")]
    assert not plant.model.dof_armature[others].any()


def test_a_rotor_of_the_model_stays(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(
        ARM.replace('<joint name="elbow"', '<joint name="elbow" armature="1"')
    )
    motor = ServoGains(5.0, 0.0, 1.5, armature=0.02)
    plant = load_plant(path, "fixed", servo=motor)
    rotors = plant.model.dof_armature[[plant.dofs[i] for i in range(3)]]
    assert sorted(rotors) == [0.02, 0.02, 1.0]

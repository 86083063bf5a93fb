"""The PyBullet world: its processes, its robot, and how it walks beside the sim."""

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from groundwalk.errors import GroundwalkError
from robots import biped
from walk_engine import Velocity, WalkEngine, gaits
from worlds import TICK_S, End, WorldOptions
from worlds.real.robot import BulletRobot

PATIENCE_S = 120
WALK_S = 4.5


@pytest.fixture(scope="module", autouse=True)
def processes_of_their_own():
    """Not those that all other tests have: see `quick_processes`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("worlds.real.world.multiprocessing", multiprocessing)
        yield


@pytest.fixture
def robot(nao, flat):
    robot = BulletRobot(nao, flat, WorldOptions())
    yield robot
    robot.close()


def soon(function, *arguments):
    """Call in a thread: what hangs shall fail, not hang the tests."""
    outcome = []

    def call():
        try:
            outcome.append(function(*arguments))
        except Exception as error:
            outcome.append(error)

    thread = threading.Thread(target=call, daemon=True)
    thread.start()
    thread.join(PATIENCE_S)
    assert outcome, "no answer"
    return outcome[0]


@pytest.mark.parametrize("moment", ["reset", "step"])
def test_a_dead_process_is_an_error(make_world, crouch, moment):
    world = make_world("real", n=2, threads=2)
    pose = np.tile(crouch, (2, 1))
    world.reset(pose)
    world.step(pose)
    processes = list(world.processes)
    assert len(processes) == 2
    os.kill(processes[1].pid, signal.SIGKILL)
    processes[1].join(PATIENCE_S)
    error = soon(getattr(world, moment), pose)
    assert isinstance(error, GroundwalkError)
    assert "\n" not in str(error)
    assert "process" in str(error)
    assert not any(process.is_alive() for process in processes)


def test_a_process_that_dies_at_work_is_an_error(make_world, crouch):
    """Stopped first, so that the message is out and the answer is waited for."""
    world = make_world("real", n=1)
    world.reset(crouch[None])
    (process,) = world.processes
    os.kill(process.pid, signal.SIGSTOP)
    threading.Timer(0.2, os.kill, (process.pid, signal.SIGKILL)).start()
    assert isinstance(soon(world.step, crouch[None]), GroundwalkError)


def test_processes_end_with_the_world(make_world):
    world = make_world("real", n=3, threads=2)
    processes = list(world.processes)
    world.close()
    assert [process.exitcode for process in processes] == [0, 0]
    world.close()  # does no harm


def test_no_more_processes_than_robots(make_world):
    assert len(make_world("real", n=1, threads=8).processes) == 1


@pytest.mark.slow
def test_a_script_without_main_guard_ends(tmp_path):
    """Its processes run it again instead of their work; that must not hang."""
    script = tmp_path / "script.py"
    script.write_text(
        textwrap.dedent(
            """
            import numpy as np
            import robots, terrain, worlds

            world = worlds.make(
                "real",
                robots.get("nao"),
                [terrain.make("lumps", 1)],
                [np.random.SeedSequence(0)],
            )
            world.reset(np.zeros((1, 20)))
            """
        )
    )
    run = subprocess.run(
        [sys.executable, str(script)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert run.returncode == 1
    assert "GroundwalkError" in run.stderr


def test_processes_say_nothing(make_world, crouch, capfd):
    """PyBullet greets whoever imports it; standard output is for results."""
    world = make_world("real")
    world.reset(crouch[None])
    world.step(crouch[None])
    world.close()
    assert capfd.readouterr() == ("", "")


def test_pose_is_that_of_the_torso_frame(robot, nao, crouch):
    """Bullet's own base is the centre of mass, with principal axes."""
    state = robot.reset(crouch, 0.5)
    np.testing.assert_allclose(
        np.hstack(state[3:5]), [0, 0, 0.5, 1, 0, 0, 0], atol=1e-12
    )
    np.testing.assert_allclose(np.hstack(state[5:7]), 0, atol=1e-12)
    place, _ = robot.body.bullet.getBasePositionAndOrientation(robot.body.number)
    np.testing.assert_allclose(
        np.array(place) - [0, 0, 0.5], nao.root.inertial.com_m, atol=1e-12
    )


def test_velocity_is_that_of_the_torso_frame(robot, crouch):
    """Flung into the air, its path and its turning say how fast it is."""
    robot.reset(crouch, 0.9)
    robot.body.bullet.resetBaseVelocity(robot.body.number, [0.3, -0.2, 2], [2, 3, 4])
    robot.step([(crouch, 100)])
    states = [robot.step([(crouch, 1)]) for _ in range(3)]
    poses = np.array([np.hstack(state[3:5]) for state in states])
    turns = Rotation.from_quat(poses[:, 3:], scalar_first=True)
    span_s = 2 * 0.002
    linear, angular = states[1][5:7]
    np.testing.assert_allclose(linear, (poses[2] - poses[0])[:3] / span_s, atol=0.03)
    spin = (turns[0].inv() * turns[2]).as_rotvec() / span_s  # in the torso frame
    np.testing.assert_allclose(angular, spin, atol=0.05)
    assert np.abs(turns[1].apply(angular) - angular).max() > 0.5


def test_limbs_pass_through_each_other(robot, nao, crouch):
    """As in the sim, only soles touch, and only the ground."""
    pose = crouch.copy()
    for side, roll in (("L", -0.35), ("R", 0.35)):
        pose[nao.joints.index(f"{side}HipRoll")] = roll
    robot.reset(pose, 0.6)
    robot.step([(pose, 5)])
    assert robot.body.bullet.getContactPoints(bodyA=robot.body.number) == ()


def test_a_robot_that_blew_up_starts_again_as_new(nao, crouch, lumpy):
    def roll(robot):
        robot.reset(crouch, 0.316)
        return np.array([np.hstack(robot.step([(crouch, 5)])[3:5]) for _ in range(10)])

    fresh, used = (BulletRobot(nao, lumpy[0], WorldOptions()) for _ in range(2))
    try:
        expected = roll(fresh)
        used.reset(crouch, 0.316)
        used.body.bullet.resetBaseVelocity(used.body.number, [1e300, 0, 0])
        assert [used.step([(crouch, 5)]) for _ in range(2)] == [None, None]
        np.testing.assert_array_equal(roll(used), expected)
    finally:
        fresh.close()
        used.close()


@pytest.mark.slow
def test_the_same_gait_is_about_as_fast_in_both_worlds(make_world, nao):
    """On flat ground, with perfect sensors and without latency: at most 15 % apart."""
    speeds_m_s = []
    for name in ("sim", "real"):
        world = make_world(name)
        engine = WalkEngine(biped(nao), [gaits.get("start")])
        observation = world.reset(engine.start_pose())
        for _ in range(round(WALK_S / TICK_S)):
            observation = world.step(
                engine.step(
                    Velocity.forward(),
                    observation.gyroscope_rad_s,
                    observation.foot_force_n,
                )
            )
        assert world.ended == [End.NONE]
        speeds_m_s.append(world.truth().base_position_m[0, 0] / WALK_S)
    sim, real = speeds_m_s
    assert min(sim, real) > 0.14
    assert abs(sim - real) < 0.15 * max(sim, real)

import numpy as np
import pytest

import robots
from experiments.motions import (
    MOTIONS,
    STANDING_MOTIONS,
    Excitation,
    standing_commands,
    walking_feed,
)
from groundwalk.errors import BadValueError, UnknownNameError
from worlds.hidden.engine import BodySense

TIME_S = np.arange(1001) * 0.01
RANGE = np.array([[-1.0, 1.0], [0.0, 0.3], [-2.0, 2.0]])
SPEED = np.array([2.0, 2.0, 1.0])


def plan(**changes):
    values = {
        "centre_rad": RANGE.mean(axis=1),
        "range_rad": RANGE,
        "speed_rad_s": SPEED,
        "moves": np.ones(3, bool),
    }
    return Excitation(**(values | changes))


def rng(seed=1):
    return np.random.default_rng(seed)


@pytest.mark.parametrize("motion", MOTIONS)
def test_commands_stay_within_range_and_begin_at_the_centre(motion):
    command = plan().commands(motion, TIME_S, rng())
    assert (command >= RANGE[:, 0]).all()
    assert (command <= RANGE[:, 1]).all()
    assert command[0] == pytest.approx(RANGE.mean(axis=1), abs=1e-6)
    assert (np.ptp(command, axis=0) > 0.1).all()


@pytest.mark.parametrize("motion", ["multisine", "chirp", "ramps"])
def test_what_is_smooth_keeps_the_speed_limits_and_steps_do_not(motion):
    def speed(name):
        return np.abs(np.diff(plan().commands(name, TIME_S, rng()), axis=0)) / 0.01

    assert (speed(motion) <= SPEED).all()
    assert (speed("steps").max(axis=0) > SPEED).all()


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_joint_that_is_held_stays(motion):
    held = plan(moves=np.array([True, False, True])).commands(motion, TIME_S, rng())
    assert np.ptp(held[:, 1]) == 0
    assert np.ptp(held[:, 0]) > 0.1


@pytest.mark.parametrize("motion", MOTIONS)
def test_joints_of_one_motor_get_one_command(motion):
    same = plan(centre_rad=np.array([0.0, 0.15, 0.0]), together=((0, 2),)).commands(
        motion, TIME_S, rng()
    )
    assert np.array_equal(same[:, 0], same[:, 2])


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_seed_gives_one_motion_and_another_another(motion):
    one, same, other = (plan().commands(motion, TIME_S, rng(s)) for s in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_ramps_turn_back_and_pause():
    speed = np.diff(plan().commands("ramps", TIME_S, rng()), axis=0)
    assert (speed > 1e-9).any()
    assert (speed < -1e-9).any()
    assert (np.abs(speed) < 1e-12).sum() > 20


def test_a_chirp_gets_faster():
    wave = plan().commands("chirp", TIME_S, rng())[:, 0]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(wave))) != 0)
    assert (turns > 500).sum() > 2 * (turns < 500).sum()


def test_unknown_motions_and_impossible_centres_are_refused():
    with pytest.raises(UnknownNameError, match="chirp"):
        plan().commands("chrip", TIME_S, rng())
    with pytest.raises(BadValueError, match="range"):
        plan(centre_rad=np.array([0.0, 5.0, 0.0]))


@pytest.mark.parametrize("motion", STANDING_MOTIONS)
def test_on_its_feet_a_robot_keeps_its_soles_level(motion):
    robot = robots.get("nao")
    command = standing_commands(robot, motion, TIME_S, rng())
    low, high = robot.joint_range_rad.T
    assert (command >= low).all()
    assert (command <= high).all()
    for side in "LR":
        columns = [
            robot.joints.index(side + n)
            for n in ("HipPitch", "KneePitch", "AnklePitch")
        ]
        assert np.allclose(command[:, columns].sum(axis=1), 0.0, atol=0.02)
    knee = np.ptp(command[:, robot.joints.index("LKneePitch")])
    roll = np.ptp(command[:, robot.joints.index("LHipRoll")])
    assert knee > 0.2
    assert (roll > 0.05) == (motion == "sway")


def test_a_walk_rests_first_and_answers_to_what_it_feels():
    pose, feed = walking_feed(robots.get("nao"), rng(), rest_rows=20)
    none = np.zeros(3)
    sense = BodySense(
        none, none, np.full(8, 6.0), none, np.array([1.0, 0, 0, 0]), none, none
    )
    commands = np.array([feed(row, sense) for row in range(100)])
    assert np.abs(commands[:20] - pose).max() < 0.02
    assert np.abs(commands[40:] - pose).max() > 0.1

"""Physics that blows up ends one rollout, and touches no other."""

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from worlds import End


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e9, 1e300])
def test_a_senseless_command_ends_that_robot_alone(
    world, poses, settled, roll, same_bits, bad
):
    commands = np.tile(poses, (6, 1, 1))
    commands[3:, 1, 7] = bad
    rollout = roll(world, poses, commands)
    assert world.ended == [End.NONE, End.DIVERGED, End.NONE]
    assert all(np.isfinite(array).all() for array in rollout.values())
    start = {name: array[:7] for name, array in settled.items()}
    same_bits(rollout, start, [0, 2], [0, 2])
    assert rollout["time_s"][-1, 1] == pytest.approx(0.03)


def test_an_explosion_ends_that_robot_alone(world, poses, settled, roll, same_bits):
    """An elbow that starts 500,000 rad beyond its stop is flung back."""
    pose = poses.copy()
    pose[1, -1] = -5e5
    rollout = roll(world, pose, [poses] * 6)
    assert world.ended == [End.NONE, End.DIVERGED, End.NONE]
    assert all(np.isfinite(array).all() for array in rollout.values())
    start = {name: array[:7] for name, array in settled.items()}
    same_bits(rollout, start, [0, 2], [0, 2])
    # and the next rollout knows nothing of it
    same_bits(roll(world, poses, [poses] * 6), start)
    assert world.ended == [End.NONE] * 3


@pytest.mark.parametrize("bad", [np.nan, -np.inf, 1e300])
def test_no_robot_starts_from_a_pose_that_is_none(world, poses, bad):
    pose = poses.copy()
    pose[2, 4] = bad
    with pytest.raises(BadValueError, match="pose"):
        world.reset(pose)


def test_a_state_that_is_no_number_ends_that_robot_alone(
    make_world, poses, roll, same_bits
):
    """NaN written into the engine's own memory, in the middle of a rollout."""
    world = make_world("sim", n=3)
    undisturbed = roll(world, poses, [poses] * 10)
    world.reset(poses)
    for tick in range(10):
        if tick == 5:
            world.qvel[1, 9] = np.nan
        observation = world.step(poses)
    assert world.ended == [End.NONE, End.DIVERGED, End.NONE]
    truth = world.truth()
    for name, rows in (vars(observation) | vars(truth)).items():
        assert np.isfinite(rows).all()
        np.testing.assert_array_equal(rows[[0, 2]], undisturbed[name][-1, [0, 2]])
        np.testing.assert_array_equal(rows[1], undisturbed[name][5, 1])


def test_a_process_reports_a_blow_up_as_such(make_world, poses, roll, monkeypatch):
    """A pose that Bullet makes NaN of, past the check of `reset`."""
    world = make_world("real", n=3)
    undisturbed = roll(world, poses, [poses])
    monkeypatch.setattr("worlds.rollouts.MOST_RAD", np.inf)
    broken = poses.copy()
    broken[1, -1] = 1e300
    world.reset(broken)
    observation = world.step(poses)
    assert world.ended == [End.NONE, End.DIVERGED, End.NONE]
    assert np.isfinite(observation.position_rad).all()
    np.testing.assert_array_equal(
        observation.position_rad[[0, 2]], undisturbed["position_rad"][1, [0, 2]]
    )


def test_blow_ups_leave_no_traces(world, poses, tmp_path, monkeypatch, capfd):
    """MuJoCo would write a file where it runs, and lines between those of a report."""
    monkeypatch.chdir(tmp_path)
    pose = poses.copy()
    pose[1, -1] = -5e5
    world.reset(pose)
    world.step(poses)
    assert world.ended[1] is End.DIVERGED
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")

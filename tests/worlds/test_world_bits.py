"""Same seed, same bits, in both worlds: whatever was before, beside or underneath."""

import numpy as np
import pytest

from worlds import End, SensorNoise

LATENCY_S = 0.036


@pytest.fixture(scope="module")
def noisy(world_name, make_world, lumpy):
    """Three robots, each on its own lumps, with all that a world can add."""
    return make_world(world_name, lumpy, noise=SensorNoise(), latency_s=LATENCY_S)


@pytest.fixture(scope="module")
def shaken(noisy, crouch, shake, roll):
    return roll(noisy, np.tile(crouch, (3, 1)), shake(40, 3))


def test_reset_repeats_the_rollout(
    noisy, crouch, topple, shake, shaken, roll, same_bits
):
    """Also after a fall, and with noise and latency on lumpy ground."""
    falling = np.tile(topple, (3, 1))
    roll(noisy, falling, [falling] * 60)
    assert noisy.ended == [End.FALL] * 3
    assert not noisy.active.any()
    same_bits(roll(noisy, np.tile(crouch, (3, 1)), shake(40, 3)), shaken)
    assert noisy.ended == [End.NONE] * 3
    assert noisy.active.all()
    assert not np.array_equal(shaken["position_rad"][-1], shaken["position_rad"][-2])


def test_a_robot_does_not_feel_its_neighbours(
    world_name, make_world, crouch, shake, shaken, lumpy, roll, same_bits
):
    alone = make_world(world_name, lumpy[:1], noise=SensorNoise(), latency_s=LATENCY_S)
    same_bits(roll(alone, crouch[None], shake(40, 3)[:, :1]), shaken, 0, 0)


def test_threads_make_no_difference(
    world_name, make_world, crouch, shake, shaken, lumpy, roll, same_bits
):
    two = make_world(
        world_name, lumpy, noise=SensorNoise(), latency_s=LATENCY_S, threads=2
    )
    same_bits(roll(two, np.tile(crouch, (3, 1)), shake(40, 3)), shaken)


def test_numpys_global_generator_is_left_alone(
    noisy, crouch, shake, shaken, roll, same_bits
):
    np.random.seed(4711)
    before = np.random.get_state(legacy=False)
    again = roll(noisy, np.tile(crouch, (3, 1)), shake(40, 3))
    after = np.random.get_state(legacy=False)
    same_bits(again, shaken)
    np.testing.assert_equal(after, before)


def test_falling_neighbours_change_nothing(
    world, crouch, topple, settled, poses, roll, same_bits
):
    pose = poses.copy()
    pose[1] = topple
    same_bits(
        roll(world, pose, [pose] * (len(settled["time_s"]) - 1)),
        settled,
        [0, 2],
        [0, 2],
    )

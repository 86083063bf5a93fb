"""When a rollout ends, decided on made-up truths."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import terrain
from terrain import Heightfield
from worlds import End, Truth
from worlds.rollouts import EndRule

START_M = 0.31


def truth(position=(0, 0, START_M), turn=None, velocity=(0, 0, 0), n=1):
    turn = Rotation.identity() if turn is None else turn
    return Truth(
        base_position_m=np.tile(np.array(position, float), (n, 1)),
        base_orientation=np.tile(turn.as_quat(scalar_first=True), (n, 1)),
        base_linear_velocity_m_s=np.tile(np.array(velocity, float), (n, 1)),
        base_angular_velocity_rad_s=np.zeros((n, 3)),
    )


@pytest.fixture(scope="module")
def rule(flat):
    return EndRule([flat], truth())


def verdict(rule, now, sound=True):
    """The one reason to end that the rule finds for the first robot."""
    masks = rule(now, np.full(len(now.base_position_m), sound))
    found = [end for end, mask in masks.items() if mask[0]]
    assert len(found) <= 1
    return found[0] if found else End.NONE


def tilted(degrees, heading, yaw_degrees):
    """Turned about the vertical, then tilted towards a heading."""
    axis = [np.cos(heading), np.sin(heading), 0]
    tilt = Rotation.from_rotvec(np.radians(degrees) * np.array(axis))
    return tilt * Rotation.from_euler("z", yaw_degrees, degrees=True)


@pytest.mark.parametrize("yaw_degrees", [0, 77, 180])
@pytest.mark.parametrize("heading", np.linspace(0, 2 * np.pi, 7)[:-1])
def test_tilt_of_sixty_degrees(rule, heading, yaw_degrees):
    for degrees, end in ((0, End.NONE), (59.9, End.NONE), (60.1, End.FALL)):
        turn = tilted(degrees, heading, yaw_degrees)
        assert verdict(rule, truth(turn=turn)) is end
    assert verdict(rule, truth(turn=tilted(179, heading, yaw_degrees))) is End.FALL


def test_half_of_the_start_height(rule):
    assert verdict(rule, truth((0.5, 0, 0.501 * START_M))) is End.NONE
    assert verdict(rule, truth((0.5, 0, 0.499 * START_M))) is End.FALL


def test_height_counts_from_the_ground_below():
    slope = terrain.make("slope", 0, angle_rad=0.3)
    rule = EndRule([slope], truth())
    ground_m = float(slope.height_at(3.0, 0.0))
    assert ground_m > 0.5
    assert verdict(rule, truth((3, 0, ground_m + START_M))) is End.NONE
    assert verdict(rule, truth((3, 0, ground_m + 0.4 * START_M))) is End.FALL
    assert verdict(rule, truth((0, 0, ground_m))) is End.NONE


def test_start_height_counts_from_the_ground_too():
    raised = Heightfield(np.full((9, 9), 1.0), (-1.0, -1.0), 0.25)
    rule = EndRule([raised], truth((0, 0, 1 + START_M)))
    assert verdict(rule, truth((0, 0, 1 + 0.6 * START_M))) is End.NONE
    assert verdict(rule, truth((0, 0, 1 + 0.4 * START_M))) is End.FALL


def test_beyond_the_edge_of_the_ground(rule, flat):
    (low_x, high_x), (low_y, high_y) = flat.x_range_m, flat.y_range_m
    inside, outside = 0.001, -0.001
    for margin, end in ((inside, End.NONE), (outside, End.LEFT_GROUND)):
        for x, y in (
            (low_x + margin, 0),
            (high_x - margin, 0),
            (0, low_y + margin),
            (0, high_y - margin),
        ):
            assert verdict(rule, truth((x, y, START_M))) is end


def test_who_falls_off_the_edge_has_fallen(rule):
    assert verdict(rule, truth((100, 0, -1))) is End.FALL


@pytest.mark.parametrize("axis", range(3))
def test_speeds_that_no_robot_has(rule, axis):
    for speed, end in ((49, End.NONE), (-49, End.NONE), (51, End.DIVERGED)):
        velocity = np.zeros(3)
        velocity[axis] = speed
        assert verdict(rule, truth(velocity=velocity)) is end
        assert verdict(rule, truth(velocity=-velocity)) is end


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_unsound_rows_have_diverged_whatever_they_hold(rule, bad):
    broken = Truth(*(np.full((1, width), bad) for width in (3, 4, 3, 3)))
    assert verdict(rule, broken, sound=False) is End.DIVERGED
    assert verdict(rule, truth((0, 0, 0)), sound=False) is End.DIVERGED


def test_each_robot_has_its_own_ground(flat):
    raised = Heightfield(np.full((9, 9), 0.5), (-1.0, -1.0), 0.25)
    start = truth(n=4)
    start.base_position_m[1, 2] += 0.5
    start.base_position_m[3, 2] += 0.5
    rule = EndRule([flat, raised, flat, raised], start)
    masks = rule(truth((0, 0, 0.45), n=4), np.ones(4, bool))
    np.testing.assert_array_equal(masks[End.FALL], [False, True, False, True])
    assert not masks[End.DIVERGED].any()
    assert not masks[End.LEFT_GROUND].any()

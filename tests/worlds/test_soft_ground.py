import numpy as np
import pytest

from groundwalk.errors import BadValueError
from robots.sole import contact_points
from worlds import WorldOptions
from worlds.soft_ground import FootSpring

SETTLE_TICKS = 150


def depth_m(nao, world, pose_rad, link_frames):
    """How deep the points of both soles are in the ground, on average, at rest."""
    world.reset(pose_rad)
    for _ in range(SETTLE_TICKS):
        observation = world.step(pose_rad)
    truth = world.truth()
    assert world.active.all()
    _, x, y, z = truth.base_orientation[0]
    turns, places = link_frames(nao, observation.position_rad)
    depths = []
    for foot in nao.feet:
        points = contact_points(foot)
        sole = np.c_[points, np.full(len(points), foot.sole_height_m)]
        at = places[foot.joint][0] + sole @ turns[foot.joint][0].T
        w = truth.base_orientation[0, 0]
        up = [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
        depths.append(-(truth.base_position_m[0, 2] + at @ up))
    return float(np.mean(depths))


@pytest.mark.parametrize("world_name", ["sim", "real"])
@pytest.mark.parametrize("sinkage_m", [0.003, 0.01])
def test_both_worlds_sink_as_deep_as_said(
    nao, crouch, make_world, link_frames, world_name, sinkage_m
):
    # on two feet the robot sinks half as deep as on one
    world = make_world(world_name, sinkage_m=sinkage_m)
    depth = depth_m(nao, world, crouch[None], link_frames)
    assert depth == pytest.approx(sinkage_m / 2, rel=0.03)


@pytest.mark.parametrize("world_name", ["sim", "real"])
def test_hard_ground_hardly_gives(nao, crouch, make_world, link_frames, world_name):
    world = make_world(world_name)
    assert abs(depth_m(nao, world, crouch[None], link_frames)) < 0.0015


def test_the_spring_of_a_foot_carries_the_weight(nao):
    spring = FootSpring.sinking(nao, 0.01)
    assert spring.stiffness_n_m * 0.01 == pytest.approx(nao.mass_kg * 9.81)
    # a tenth of critical: B^2 = 0.04 K m
    squared = 0.04 * spring.stiffness_n_m * nao.mass_kg
    assert spring.damping_n_s_m**2 == pytest.approx(squared)


def test_ground_that_pushes_up_is_refused():
    with pytest.raises(BadValueError, match="sinkage_m"):
        WorldOptions(sinkage_m=-0.01)

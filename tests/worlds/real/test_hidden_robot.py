"""The real world with hidden physics: rollouts of many robots in closed loop."""

from dataclasses import replace

import numpy as np
import pytest

import robots
import terrain
import worlds
from experiments.walking.trials import TrialRules, walk_trials
from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import gaits
from worlds import WorldOptions
from worlds.hidden.effects import Hidden

NOTHING = "viscous_friction@LKneePitch:coefficient=0"


def walked_m(*hidden, robots_n=2, threads=1):
    """(robots_n,) how far the first robots of a crowd come in 2 s."""
    options = real_options(*hidden, threads=threads)
    seeds = np.random.SeedSequence(1).spawn(robots_n)
    grounds = [terrain.make("flat", 0)] * robots_n
    world = worlds.make("real", robots.get("nao"), grounds, seeds, options)
    try:
        vectors = np.tile(gaits.get("walk2014").to_vector(), (robots_n, 1))
        rules = TrialRules(limit_s=2.0, start_spread_rad=0.01)
        return walk_trials(world, vectors, rules, seeds).distance_m
    finally:
        world.close()


@pytest.fixture(scope="module")
def nothing_m():
    """Way of three robots, in two processes, with nothing hidden."""
    return walked_m(NOTHING, robots_n=3, threads=2)


def real_options(*hidden, **changes):
    effects = tuple(Hidden.parse(text) for text in hidden)
    return replace(worlds.kind("real").options, hidden=effects, **changes)


@pytest.mark.slow
def test_with_nothing_hidden_it_walks_as_the_real_world_does(nothing_m):
    np.testing.assert_allclose(nothing_m[:2], walked_m(), rtol=0.1)


@pytest.mark.slow
def test_what_is_hidden_tells(nothing_m):
    late = walked_m("speed_limit@LKneePitch:speed=1", "speed_limit@RKneePitch:speed=1")
    assert (np.abs(late - nothing_m[:2]) > 0.05).all()


@pytest.mark.slow
def test_bits_do_not_depend_on_how_many_robots_and_processes_there_are(nothing_m):
    assert walked_m(NOTHING, robots_n=1)[0] == nothing_m[0]


@pytest.mark.slow
def test_a_second_rollout_is_the_first_one_again():
    options = real_options(NOTHING, noise=None, threads=1)
    nao, seed = robots.get("nao"), np.random.SeedSequence(1)
    world = worlds.make("real", nao, [terrain.make("flat", 0)], [seed], options)
    try:
        pose = np.clip(np.zeros((1, len(nao.joints))), *nao.joint_range_rad.T)
        first, second = (standing(world, pose) for _ in range(2))
    finally:
        world.close()
    np.testing.assert_allclose(first, second, atol=1e-6)


def standing(world, pose):
    world.reset(pose)
    for _ in range(20):
        seen = world.step(pose)
    return seen.position_rad


def test_offsets_and_biases_are_in_what_is_seen():
    offset = "encoder_offset@LElbowRoll:offset=0.1"
    options = real_options(offset, "gyro_bias:x=0.5,y=0,z=0", noise=None, threads=1)
    nao, seed = robots.get("nao"), np.random.SeedSequence(1)
    world = worlds.make("real", nao, [terrain.make("flat", 0)], [seed], options)
    try:
        pose = np.clip(np.zeros((1, len(nao.joints))), *nao.joint_range_rad.T)
        seen = world.reset(pose)
    finally:
        world.close()
    elbow = nao.joints.index("LElbowRoll")
    assert seen.position_rad[0, elbow] == pytest.approx(pose[0, elbow] + 0.1)
    assert seen.gyroscope_rad_s[0] == pytest.approx([0.5, 0, 0])


def test_no_world_starts_with_what_the_robot_or_the_engine_lacks():
    nao, seed = robots.get("nao"), np.random.SeedSequence(1)
    for text, error in (
        ("viscous_friction@LKnee:coefficient=0", UnknownNameError),
        ("payload_mass@nose:mass=1", UnknownNameError),
        ("armature@LKneePitch:inertia=0.1", BadValueError),
    ):
        with pytest.raises(error):
            worlds.make(
                "real", nao, [terrain.make("flat", 0)], [seed], real_options(text)
            )


def test_hidden_physics_is_refused_where_it_would_do_nothing():
    effect = Hidden.parse(NOTHING)
    nao, flat, options = robots.get("nao"), terrain.make("flat", 0), WorldOptions()
    seeds, options = [np.random.SeedSequence(1)], replace(options, hidden=(effect,))
    with pytest.raises(BadValueError, match="no hidden physics"):
        worlds.make("sim", nao, [flat], seeds, options)
    with pytest.raises(BadValueError, match="only one"):
        WorldOptions(hidden=(effect,), sinkage_m=0.01)
    with pytest.raises(BadValueError, match="ground"):
        WorldOptions(hidden=(Hidden("uneven_ground", "world", {"height": 0.01}),))


def test_hidden_physics_as_text_and_back():
    text = "stribeck_friction@LKneePitch:coulomb_torque=0.1,extra_torque=0.05,speed=0.2"
    assert Hidden.parse(text).to_text() == text

"""Robots in both worlds, and rollouts of them as arrays."""

from dataclasses import fields

import numpy as np
import pytest

import terrain
import worlds
from worlds import WorldOptions
from worlds.rerun_files.log import write_rrd

SETTLE_TICKS = 150


@pytest.fixture(scope="session")
def flat():
    return terrain.make("flat", seed=0)


@pytest.fixture(scope="session")
def lumpy():
    """Three lumpy grounds, smaller than usual because that loads faster."""
    return [
        terrain.make("lumps", seed, x_range_m=(-0.6, 1.0), y_range_m=(-0.6, 0.6))
        for seed in (1, 2, 3)
    ]


@pytest.fixture(scope="module")
def make_world(nao, flat):
    """Function: a world by name, on flat ground unless told otherwise.

    One thread or process; perfect sensors, no latency. Closed when the module is done.
    """
    made = []

    def make(name, grounds=None, n=1, seed=0, description=nao, **options):
        grounds = [flat] * n if grounds is None else grounds
        seeds = [np.random.SeedSequence([seed, i]) for i in range(len(grounds))]
        chosen = WorldOptions(**{"threads": 1, **options})
        made.append(worlds.make(name, description, grounds, seeds, chosen))
        return made[-1]

    yield make
    for world in made:
        world.close()


@pytest.fixture(scope="session")
def shake(crouch):
    """Function: commands (ticks, n, joints) that shake a crouch, each robot its own."""

    def commands(ticks, n, amplitude_rad=0.08):
        generator = np.random.default_rng(20)
        phase = generator.uniform(0, 2 * np.pi, (n, len(crouch)))
        time = 0.25 * np.arange(ticks)[:, None, None]
        return crouch + amplitude_rad * (np.sin(time + phase) - np.sin(phase))

    return commands


@pytest.fixture(scope="session")
def roll():
    """Function: a rollout as a dict of arrays (ticks + 1, n, ...), truth included."""

    def rollout(world, pose_rad, commands_rad):
        steps = [(world.reset(pose_rad), world.truth())]
        steps += ((world.step(command), world.truth()) for command in commands_rad)
        return {
            field.name: np.stack([getattr(step[k], field.name) for step in steps])
            for k in (0, 1)
            for field in fields(steps[0][k])
        }

    return rollout


@pytest.fixture(scope="session")
def same_bits():
    """Function: check that two rollouts, or some robots of them, are equal."""

    def check(first, second, robots=slice(None), others=slice(None)):
        assert first.keys() == second.keys()
        for name in first:
            np.testing.assert_array_equal(
                first[name][:, robots], second[name][:, others], err_msg=name
            )

    return check


@pytest.fixture(scope="module", params=["sim", "real"])
def world_name(request):
    return request.param


@pytest.fixture(scope="module")
def world(world_name, make_world):
    """Three robots on flat ground with perfect sensors, used again and again."""
    return make_world(world_name, n=3)


@pytest.fixture(scope="module")
def poses(nao, crouch):
    """Three poses: crouched, leaning left, leaning forward."""
    columns = {joint: k for k, joint in enumerate(nao.joints)}
    left, forward = crouch.copy(), crouch.copy()
    for side in "LR":
        left[columns[side + "HipRoll"]] -= 0.12
        left[columns[side + "AnkleRoll"]] += 0.12
        forward[columns[side + "HipPitch"]] += 0.06
        forward[columns[side + "AnklePitch"]] -= 0.06
    return np.stack([crouch, left, forward])


@pytest.fixture(scope="module")
def settled(world, poses, roll):
    return roll(world, poses, [poses] * SETTLE_TICKS)


@pytest.fixture(scope="module")
def topple(nao, crouch):
    """A pose with straight legs so far ahead that the robot falls on its back."""
    pose = crouch.copy()
    for side in "LR":
        for joint, angle in (("Hip", -0.8), ("Knee", 0.0), ("Ankle", 0.8)):
            pose[nao.joints.index(f"{side}{joint}Pitch")] = angle
    return pose


@pytest.fixture(scope="module")
def file(walk, tmp_path_factory):
    """A Rerun file that holds nothing but the scene `walk` of the module that asks."""
    path = tmp_path_factory.mktemp("rerun") / "walk.rrd"
    write_rrd(path, [walk])
    return path

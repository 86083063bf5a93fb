import numpy as np
import pytest

import robots
import terrain
import worlds
from sgat.walks.walk_senses import HISTORY_TICKS, WalkSenses
from sgat.walks.wrapped_worlds import GroundedWorld
from walk_engine import Velocity, WalkEngine, gaits
from worlds import TICK_S, WorldOptions

# no coupled ones: the motor of a pair takes the mean of two commands
JOINTS = [3, 4, 9, 10]
SEEDS = np.random.SeedSequence(9).spawn(2)


class Shift:
    """Adds the same to every action, and keeps what it was given."""

    def __init__(self, shift_rad=0.0):
        self.shift_rad = shift_rad
        self.seeds, self.states, self.actions = [], [], []

    def reset(self, seeds):
        self.seeds.append(list(seeds))

    def __call__(self, state, action):
        self.states.append(state)
        self.actions.append(action)
        return action + self.shift_rad


def sim(n=2, **options):
    seeds = np.random.SeedSequence(1).spawn(n)
    options = WorldOptions(threads=1, **options)
    ground = terrain.make("flat", 0)
    return worlds.make("sim", robots.get("nao"), [ground] * n, seeds, options)


def grounded(transformer, **options):
    return GroundedWorld(sim(**options), WalkSenses(JOINTS), transformer, SEEDS)


def steps(ticks=40):
    """A start pose (2, joints), and commands (ticks, 2, joints) of a walk."""
    gait = [gaits.get("start"), gaits.get("walk2014")]
    world = sim()
    engine = WalkEngine(robots.biped(world.description), gait, TICK_S)
    pose = engine.start_pose()
    now, commands = world.reset(pose), []
    for _ in range(ticks):
        commands.append(
            engine.step(Velocity.forward(), now.gyroscope_rad_s, now.foot_force_n)
        )
        now = world.step(commands[-1])
    return pose, np.array(commands)


def joints(world, pose, commands):
    """(ticks + 1, n, joints) positions of a walk."""
    seen = [world.reset(pose), *(world.step(command) for command in commands)]
    return np.array([now.position_rad for now in seen])


@pytest.fixture(scope="module")
def walk():
    return steps()


def test_to_change_nothing_is_to_change_nothing(walk):
    bare = joints(sim(), *walk)
    assert joints(grounded(Shift()), *walk) == pytest.approx(bare, abs=1e-12)
    moved = joints(grounded(Shift(1e-6)), *walk)
    assert moved != pytest.approx(bare, abs=1e-9)


def test_shifted_actions_shift_their_joints_alone(walk):
    """Of robots that hang in the air, where a servo gets to where it is told to."""
    pose = walk[0]
    still = np.tile(pose, (60, 1, 1))
    world = grounded(Shift(-0.03), fixed_base=True)
    moved = joints(world, pose, still) - joints(sim(fixed_base=True), pose, still)
    others = [k for k in range(moved.shape[2]) if k not in JOINTS]
    assert moved[-1][:, JOINTS] == pytest.approx(-0.03, rel=0.1)
    assert moved[-1][:, others] == pytest.approx(0, abs=0.003)


def test_a_shift_is_the_bare_world_with_shifted_commands(walk):
    pose, commands = walk
    shifted = commands.copy()
    shifted[..., JOINTS] += 0.02
    moved = joints(grounded(Shift(0.02)), pose, commands)
    assert moved == pytest.approx(joints(sim(), pose, shifted), abs=1e-11)


def test_a_transformer_starts_anew_at_every_reset(walk):
    transformer = Shift()
    world = grounded(transformer)
    assert transformer.seeds == []
    for count in (1, 2):
        joints(world, walk[0], walk[1][:3])
        assert transformer.seeds == [SEEDS] * count


def test_the_history_holds_what_the_gait_asked_for(walk):
    """And the rest of the state what the joints then did."""
    pose, commands = walk
    transformer = Shift(0.05)
    seen = joints(grounded(transformer), pose, commands)[..., JOINTS]
    past_ticks, j = HISTORY_TICKS - 1, len(JOINTS)
    assert len(transformer.states) == len(commands)
    for tick in range(past_ticks, len(commands)):
        state, action = transformer.states[tick], transformer.actions[tick]
        asked = commands[tick - past_ticks : tick, :, JOINTS].swapaxes(0, 1)
        past = state[:, -past_ticks * j :].reshape(2, past_ticks, j)
        assert (past == asked - seen[tick][:, None]).all()
        assert (np.abs(past - (asked + 0.05 - seen[tick][:, None])) > 0.04).all()
        assert (state[:, :j] == seen[tick]).all()
        assert (action == commands[tick, :, JOINTS].T - seen[tick]).all()


def test_a_second_walk_is_like_the_first(walk):
    pose, commands = walk
    transformer = Shift(0.01)
    world = grounded(transformer)
    first = joints(world, pose, commands)
    assert (joints(world, pose, commands) == first).all()
    half = len(commands)
    pairs = zip(transformer.states[:half], transformer.states[half:], strict=True)
    assert all((one == other).all() for one, other in pairs)

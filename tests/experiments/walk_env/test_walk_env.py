"""The walking environment against Gymnasium's checkers and against plain trials."""

import contextlib
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils import seeding
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_for_learners

import robots
import terrain
import worlds
from experiments.grounded_walks.models import action_envelope
from experiments.walk_env import IDS, register_envs
from experiments.walk_env.env import WalkEnv, episode_seeds
from experiments.walking.trials import TrialRules, reward_cm_s, walk_trials
from groundwalk.errors import BadValueError, UnknownNameError
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.catalogue import write_transformer
from sgat.transitions import Transitions
from walk_engine import gaits
from walk_engine.gait import to_unit

SIM, REAL, GROUNDED = IDS
SHORT = {"limit_s": 0.3}
FALLS = {"limit_s": 3.0, "gait": gaits.get("start").replace(com_offset=0.035)}
SEED = 5


def options_of(name):
    noisy = {"transformer": action_envelope(0.01)}
    return SHORT | (noisy if name == GROUNDED else {})


# each reset of the real world starts a process, and the checks reset a lot
@pytest.mark.parametrize(
    ("name", "action"),
    [(name, "residual") for name in IDS] + [(SIM, "gait"), (GROUNDED, "gait")],
)
def test_the_environments_pass_the_checks(name, action):
    register_envs()
    register_envs()  # twice does no harm
    env = gym.make(name, action=action, **options_of(name)).unwrapped
    with contextlib.closing(env):
        check_env(env)
        if name != REAL:
            check_for_learners(env)


def walked(env, action, seed=SEED):
    """Rewards, and what is known at the end."""
    with contextlib.closing(env):
        env.reset(seed=seed)
        rewards, over = [], False
        while not over:
            _, reward, terminated, truncated, info = env.step(action)
            rewards.append(reward)
            over = terminated or truncated
    return rewards, terminated, info


def plain(name, gait, limit_s):
    """The same walk without an environment."""
    kind, description = worlds.kind(name), robots.get("nao")
    generator, _ = seeding.np_random(SEED)
    of_ground, of_noise, of_pose = episode_seeds(generator)
    ground = terrain.make(kind.terrain, int(of_ground.generate_state(1)[0]))
    world = worlds.make(name, description, [ground], [of_noise])
    rules = TrialRules(limit_s, start_spread_rad=0.01)
    with contextlib.closing(world):
        return walk_trials(world, [gait], rules, [of_pose])


@pytest.mark.parametrize("name", ["sim", "real"])
def test_without_a_residual_it_walks_as_a_trial_does(name):
    limit_s = 0.5
    trials = plain(name, gaits.get("start"), limit_s)
    rewards, terminated, info = walked(WalkEnv(name, limit_s=limit_s), np.zeros(20))
    assert info["distance_m"] == trials.distance_m[0]
    assert (len(rewards), terminated) == (50, False)
    worth = reward_cm_s(trials, limit_s)[0]
    assert sum(rewards) == pytest.approx(worth)
    vector = to_unit(gaits.get("start").to_vector())
    env = WalkEnv(name, limit_s=limit_s, action="gait")
    rewards, terminated, info = walked(env, 2 * vector - 1)
    assert info["distance_m"] == pytest.approx(trials.distance_m[0], abs=1e-6)
    assert (rewards, terminated) == ([pytest.approx(worth, abs=1e-4)], True)


def test_a_residual_changes_the_walk_and_a_seed_repeats_it():
    bent = np.full(20, 0.3)
    first = walked(WalkEnv(**SHORT), bent)
    assert first == walked(WalkEnv(**SHORT), bent)
    assert first != walked(WalkEnv(**SHORT), np.zeros(20))
    assert first != walked(WalkEnv(**SHORT), bent, seed=SEED + 1)


def test_a_fall_terminates_and_costs_its_penalty():
    rewards, terminated, info = walked(WalkEnv(**FALLS), np.full(20, -1.0))
    assert terminated
    assert info["ended"] == "fall"
    assert len(rewards) < 300
    worth = 100 * info["distance_m"] / FALLS["limit_s"] - 15
    assert sum(rewards) == pytest.approx(worth)


def test_every_episode_has_ground_noise_and_pose_of_its_own():
    env = WalkEnv("sim", terrain="lumps:start_radius_m=0.05", **SHORT)
    first, _ = env.reset(seed=1)
    second, _ = env.reset()
    again, _ = env.reset(seed=1)
    assert (first == again).all()
    assert (first != second).any()


def test_a_ground_of_ones_own_is_walked_on():
    x = np.linspace(-1, 2, 61)
    uphill = terrain.Heightfield(np.tile(0.3 * x, (61, 1)), (-1.0, -1.5), 0.05)
    rewards, _, _ = walked(WalkEnv(terrain=uphill, limit_s=1.0), np.zeros(20))
    flat, _, _ = walked(WalkEnv(limit_s=1.0), np.zeros(20))
    assert sum(rewards) < sum(flat)


def test_the_world_takes_options():
    late = worlds.WorldOptions(latency_s=0.02)
    first = walked(WalkEnv(**SHORT), np.zeros(20))
    assert first != walked(WalkEnv(options=late, **SHORT), np.zeros(20))


def test_the_transformer_is_felt_and_not_shared():
    noise = action_envelope(0.05)
    first = walked(WalkEnv("grounded", transformer=noise, **SHORT), np.zeros(20))
    assert first == walked(
        WalkEnv("grounded", transformer=noise, **SHORT), np.zeros(20)
    )
    assert first != walked(WalkEnv(**SHORT), np.zeros(20))
    noise.reset(np.random.SeedSequence(1).spawn(3))  # another's business


def test_a_saved_transformer_is_read_from_its_folder(tmp_path):
    joints, rng = 12, np.random.default_rng(1)
    state, action = rng.normal(size=(80, 77)), rng.normal(size=(80, joints))
    reached = state[:, : joints + 5] + 0.1
    seen = Transitions(state, action, reached, np.repeat(np.arange(4), 20))
    tiny, seed = {"hidden": (4,), "epochs": 1}, np.random.SeedSequence(1)
    transformer = ActionTransformer(
        ForwardModel(ForwardConfig(**tiny)).fit(seen, seed),
        InverseModel(NetworkConfig(**tiny)).fit(seen, seed),
        np.full(joints, -1.0),
        np.full(joints, 1.0),
        WhiteNoise(joints + 5),
    )
    write_transformer(tmp_path, transformer)
    kept = walked(WalkEnv("grounded", transformer=str(tmp_path), **SHORT), np.zeros(20))
    given = WalkEnv("grounded", transformer=transformer, **SHORT)
    assert kept == walked(given, np.zeros(20))


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"world": "moon"}, UnknownNameError, "world 'moon'"),
        ({"action": "torque"}, UnknownNameError, "kind of action"),
        ({"world": "grounded"}, BadValueError, "needs a transformer"),
        ({"transformer": "somewhere"}, BadValueError, "and no other"),
        ({"residual_rad": 0.0}, BadValueError, "residual_rad is 0.0"),
        ({"terrain": "lumps:height=1"}, UnknownNameError, "height"),
        ({"gait": "moonwalk"}, UnknownNameError, "moonwalk"),
    ],
)
def test_what_cannot_be_is_refused(options, error, words):
    with pytest.raises(error, match=words):
        WalkEnv(**options)


def test_a_step_needs_a_reset():
    with pytest.raises(ResetNeeded):
        WalkEnv().step(np.zeros(20))


def test_the_sim_needs_no_torch_and_names_need_no_environment():
    code = """
import sys
from experiments.walk_env import register_envs
register_envs()
assert "experiments.walk_env.env" not in sys.modules
import gymnasium
gymnasium.make("Groundwalk/Nao-Sim-v0")
assert "torch" not in sys.modules
"""
    root = Path(__file__).resolve().parents[3]
    subprocess.run([sys.executable, "-c", code], cwd=root, check=True)

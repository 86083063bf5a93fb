"""TRPO policies for Gymnasium environments: training, files, and trials."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from experiments.transfer.gym_studies.environments import Environment
from groundwalk.arrays import FloatArray
from groundwalk.files import write_bytes

if TYPE_CHECKING:
    from sb3_contrib import TRPO

MakeEnvironment: TypeAlias = Callable[[], Environment]

ENVIRONMENTS = 8
"""Number of environments side by side in a training; one call gives all actions."""


TrpoSettings = Mapping[str, Any]
"""Parameters of TRPO by the names in `SB3_NAMES`, and the `batch`: the steps between
two updates in all environments together. Environments and `value_batch` divide it. The
network is 64 x 64 tanh, observations are not scaled."""

SB3_NAMES = {
    "gamma": "gamma",
    "gae_lambda": "gae_lambda",
    "max_kl": "target_kl",
    "cg_steps": "cg_max_steps",
    "cg_damping": "cg_damping",
    "value_epochs": "n_critic_updates",
    "value_rate": "learning_rate",
    "value_batch": "batch_size",
}
"""Names of sb3-contrib's TRPO. In order: discount factor per step, decay of the
generalised advantage estimate, largest mean KL divergence of an update (the trust
region), largest number of conjugate-gradient steps, number added to the diagonal of the
Fisher matrix, and of the value function passes through a batch, learning rate and size
of minibatches."""


def train(
    make: MakeEnvironment,
    trpo: TrpoSettings,
    timesteps: int,
    seed: int,
    start: Path | None = None,
) -> "TRPO":
    """Train a policy for at least a given number of steps.

    The steps of all environments together are rounded up to whole batches. `start` is
    the file of the policy to start from; None for random weights. Stable-Baselines
    seeds and uses the global generators of torch and NumPy: call this in a process of
    its own.
    """
    from sb3_contrib import TRPO
    from stable_baselines3.common.vec_env import DummyVecEnv

    envs = DummyVecEnv([make] * ENVIRONMENTS)
    if start is None:
        settings = {name: trpo[own] for own, name in SB3_NAMES.items()}
        settings["n_steps"] = trpo["batch"] // ENVIRONMENTS
        model = TRPO("MlpPolicy", envs, seed=seed, device="cpu", **settings)
    else:
        model = TRPO.load(start, envs, device="cpu")
        model.set_random_seed(seed)
    return model.learn(timesteps)


def save(model: "TRPO", path: Path) -> None:
    """Write a policy into a file, which appears complete or not at all."""
    content = io.BytesIO()
    model.save(content)
    write_bytes(path, content.getvalue())


def load(path: Path) -> "TRPO":
    """Read a policy that `save` wrote; a file can run code, so use your own only."""
    from sb3_contrib import TRPO

    return TRPO.load(path, device="cpu")


def evaluate(
    model: "TRPO",
    make: MakeEnvironment,
    episodes: int,
    seed: int,
    deterministic: bool,
) -> tuple[FloatArray, int]:
    """Try a policy in episodes that run side by side.

    The seed is that of the environments and of the policy's random actions; if
    `deterministic`, the policy takes its mean action instead.

    Returns:
      (episodes,) undiscounted sums of rewards, and the number of steps of all episodes.
    """
    from stable_baselines3.common.utils import set_random_seed

    set_random_seed(seed)
    envs = [make() for _ in range(episodes)]
    seen = np.array([env.reset(seed=seed + k)[0] for k, env in enumerate(envs)])
    returns, steps = np.zeros(episodes), 0
    active = np.arange(episodes)
    while len(active):
        actions, _ = model.predict(seen[active], deterministic=deterministic)
        ended = np.zeros(len(active), bool)
        for row, k in enumerate(active):
            seen[k], reward, terminated, truncated, _ = envs[k].step(actions[row])
            returns[k] += float(reward)
            ended[row] = terminated or truncated
        steps += len(active)
        active = active[~ended]
    return returns, steps

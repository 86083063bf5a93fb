"""TRPO policies for Gymnasium environments: trained, kept, and tried out."""

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from experiments.transfer.gym_studies.environments import Environment
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from groundwalk.files import write_bytes
from sgat.gym.collect import Policy

if TYPE_CHECKING:
    from gymnasium import Space
    from sb3_contrib import TRPO

MakeEnvironment: TypeAlias = Callable[[], Environment]

ENVIRONMENTS = 8
"""Side by side in one training: the policy answers all of them in one call."""


@dataclass(frozen=True)
class TrpoConfig:
    """TRPO's parameters; the network is 64 x 64 tanh, observations are not scaled.

    Attributes:
      batch: steps between two updates, of all environments together.
      gamma: discount.
      gae_lambda: of the advantages.
      max_kl: trust region.
      cg_steps: of the conjugate gradients.
      cg_damping: of the Fisher matrix.
      value_epochs: passes of the value function through a batch.
      value_rate: its learning rate.
      value_batch: its minibatch.
    """

    batch: int
    gamma: float
    gae_lambda: float
    max_kl: float
    cg_steps: int
    cg_damping: float
    value_epochs: int
    value_rate: float
    value_batch: int

    def __post_init__(self) -> None:
        """Refuse batches that do not divide."""
        if self.batch % ENVIRONMENTS or self.batch % self.value_batch:
            raise BadValueError(
                f"batch is {self.batch}; {ENVIRONMENTS} environments and minibatches "
                f"of {self.value_batch} must divide it"
            )

    def to_keywords(self) -> dict[str, Any]:
        """As the library calls them."""
        return {
            "n_steps": self.batch // ENVIRONMENTS,
            "gamma": self.gamma,
            "gae_lambda": self.gae_lambda,
            "target_kl": self.max_kl,
            "cg_max_steps": self.cg_steps,
            "cg_damping": self.cg_damping,
            "n_critic_updates": self.value_epochs,
            "learning_rate": self.value_rate,
            "batch_size": self.value_batch,
        }


def train(
    make: MakeEnvironment,
    config: TrpoConfig,
    timesteps: int,
    seed: int,
    start: Path | None = None,
) -> "TRPO":
    """A policy after at least so many steps of training.

    Stable-Baselines draws from torch's and NumPy's global generators, and seeds them:
    call this in a process of its own.

    Args:
      make: a new environment.
      config: of TRPO.
      timesteps: of all environments together, rounded up to whole batches.
      seed: of everything.
      start: file of the policy to go on from; None for random weights.
    """
    from sb3_contrib import TRPO
    from stable_baselines3.common.vec_env import DummyVecEnv

    envs = DummyVecEnv([make] * ENVIRONMENTS)
    if start is None:
        model = TRPO("MlpPolicy", envs, seed=seed, device="cpu", **config.to_keywords())
    else:
        model = TRPO.load(start, envs, device="cpu")
        model.set_random_seed(seed)
    return model.learn(timesteps)


def save(model: "TRPO", path: Path) -> None:
    """Write a policy, the file at once."""
    content = io.BytesIO()
    model.save(content)
    write_bytes(path, content.getvalue())


def load(path: Path) -> "TRPO":
    """Read what `save` has written. Runs what the file says: only for own files."""
    from sb3_contrib import TRPO

    return TRPO.load(path, device="cpu")


@dataclass(frozen=True, eq=False)
class Trials:
    """What came of some episodes.

    Attributes:
      returns: (episodes,) undiscounted.
      steps: of all episodes together.
    """

    returns: FloatArray
    steps: int


def evaluate(
    model: "TRPO",
    make: MakeEnvironment,
    episodes: int,
    seed: int,
    deterministic: bool,
) -> Trials:
    """Episodes of a policy, all side by side.

    Args:
      model: the policy.
      make: a new environment.
      episodes: how many.
      seed: of the environments' luck and of the policy's.
      deterministic: whether the policy takes its mean action instead of a random one.
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
    return Trials(returns, steps)


def exploring(
    model: "TRPO",
    space: "Space[FloatArray]",
    exploration: float,
    rng: np.random.Generator,
) -> Policy:
    """The random policy, with a share of its actions drawn evenly from the space."""
    space.seed(int(rng.integers(2**31)))

    def act(observation: FloatArray) -> FloatArray:
        if rng.random() < exploration:
            return np.asarray(space.sample(), float)
        return np.asarray(model.predict(observation)[0], float)

    return act

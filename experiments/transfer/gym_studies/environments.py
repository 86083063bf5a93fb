"""Domains of the Gymnasium studies: a sim, and noisy, heavier real worlds."""

from dataclasses import dataclass
from typing import TypeAlias

import gymnasium as gym
import numpy as np

from groundwalk.arrays import FloatArray
from robots.engine_models.mjcf import quiet_mujoco, scale_mass
from sgat.gym import GroundedEnv
from sgat.noise import ActionNoise
from sgat.transformers.catalogue import Transformer

Environment: TypeAlias = gym.Env[FloatArray, FloatArray]

NOISY_SIM, NOISY_REAL = "noisy-sim", "noisy-real"
"""Ways in which a real world differs from the sim: noise on actions; noise and mass."""


@dataclass(frozen=True)
class Domain:
    """An environment of Gymnasium, which is the sim, and how its real world differs.

    Attributes:
      name: name of the domain on the command line.
      title: heading of its page.
      environment: id of the environment in Gymnasium.
      mass_factor: mass and inertia of the real world's heavier bodies (all if none are
        named) over the sim's.
      control_cost: cost in the reward per squared action.
      settings: real worlds of the SGAT paper, `NOISY_SIM` or `NOISY_REAL`.
    """

    name: str
    title: str
    environment: str
    mass_factor: float
    heavy_bodies: tuple[str, ...] = ()
    control_cost: float = 0.0
    settings: tuple[str, ...] = (NOISY_REAL,)

    def sim(self, transformer: Transformer | None = None) -> Environment:
        """The sim, behind an action transformer if one is given.

        The reward charges for the policy's own action, as in the SGAT paper.
        """
        return self._behind(transformer, self._plain())

    def real(self, setting: str, noise: float) -> Environment:
        """A world that plays the role of the real one, `NOISY_SIM` or `NOISY_REAL`.

        The standard deviation of the Gaussian noise on actions is a fraction of half of
        the action's range; the noisy action is clipped to the range.
        """
        env = self._plain()
        if setting == NOISY_REAL:
            inside = env.unwrapped
            model, data = getattr(inside, "model"), getattr(inside, "data")  # noqa: B009
            scale_mass(model, data, self.mass_factor, self.heavy_bodies)
        low, high = self.bounds()
        spread = noise * float((high - low).max()) / 2
        return self._behind(ActionNoise(spread, low, high), env)

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(a,) least and (a,) largest action, in the environment's unit."""
        space = self._plain().action_space
        assert isinstance(space, gym.spaces.Box)
        return space.low.astype(float), space.high.astype(float)

    def _plain(self) -> Environment:
        quiet_mujoco()  # no warnings about attributes that MuJoCo 4 deprecates
        return gym.make(self.environment, disable_env_checker=True)

    def _behind(self, transformer: Transformer | None, env: Environment) -> Environment:
        if transformer is None:
            return env

        def charged(reward: float, asked: FloatArray, given: FloatArray) -> float:
            more = np.square(given, dtype=float).sum() - np.square(asked).sum()
            return reward + self.control_cost * float(more)

        return GroundedEnv(env, transformer, charged if self.control_cost else None)


INVERTED_PENDULUM = Domain(
    "inverted-pendulum",
    "Inverted pendulum: from the sim to a noisy world with a heavier pole",
    "InvertedPendulum-v5",
    10.0,
    ("pole",),
)
"""The SGAT paper's real pendulum: its pole weighs ten times as much (50.186 kg)."""

HALF_CHEETAH = Domain(
    "half-cheetah",
    "Half cheetah: from the sim to noisy worlds, one of them heavier",
    "HalfCheetah-v5",
    20 / 14,
    control_cost=0.1,
    settings=(NOISY_SIM, NOISY_REAL),
)
"""The SGAT paper's real cheetah weighs 43 % more: 20 instead of 14 kg."""

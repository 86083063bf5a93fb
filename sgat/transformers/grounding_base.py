"""Base class of groundings: methods that learn a transformer from two worlds' data."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.models.config import ForwardConfig
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import child_of
from sgat.transformers.catalogue import KeptTransformer
from sgat.transitions import Transitions

T = TypeVar("T")

OF_ENSEMBLE, OF_SIM_MODEL, OF_DIRECT = 2, 3, 4
"""Numbers by which `child_of` derives the seeds of trainings that only some groundings
need: an ensemble, a forward model of the sim, a direct transformer. Some studies use 0
and 1 for the inverse and the forward model."""


@dataclass(frozen=True, eq=False)
class GroundingData:
    """Data that groundings learn from, and the models that several of them share.

    Attributes:
      real: transitions of the real world.
      sim: transitions of the deterministic sim.
      low: (a,) least action.
      high: (a,) largest action.
      inverse_seed: seed of the inverse model's training.
      forward_seed: seed of the training of a forward model that is a single network.
      seed: parent of the seeds of all other trainings.
      network: forward models' settings but for distributions and number of networks.
      uneven: transitions of a sim whose ground and sensors are as random as the real
        world's, for groundings with `uneven_sim`.
      sim_columns: how many of a state's first columns matter in the sim; all if None.
      direct_columns: how many of a next state's first columns an action moves
        directly, such as joint positions; all if None.
    """

    real: Transitions
    sim: Transitions
    low: FloatArray
    high: FloatArray
    inverse_seed: np.random.SeedSequence
    forward_seed: np.random.SeedSequence
    seed: np.random.SeedSequence
    network: ForwardConfig = field(default_factory=ForwardConfig)
    uneven: Transitions | None = None
    sim_columns: int | None = None
    direct_columns: int | None = None
    _fitted: dict[Hashable, Any] = field(default_factory=dict, init=False)

    def once(self, key: Hashable, fit: Callable[[], T]) -> T:
        """The result of `fit`, which is called only at the first use of a key."""
        if key not in self._fitted:
            self._fitted[key] = fit()
        fitted: T = self._fitted[key]
        return fitted

    def inverse(self) -> InverseModel:
        """The inverse model of the sim; fitted at the first call."""
        sim = replace(self.sim, state=self.sim.state[:, : self.sim_columns])
        return self.once("inverse", lambda: InverseModel().fit(sim, self.inverse_seed))

    def forward(self, config: ForwardConfig) -> ForwardModel:
        """A forward model of the real world; fitted at the first call with a config."""
        seed = self.forward_seed
        if config.members > 1:
            seed = child_of(self.seed, OF_ENSEMBLE)
        return self.once(config, lambda: ForwardModel(config).fit(self.real, seed))


class Grounding(ABC):
    """A named way to make an action transformer.

    Attributes:
      name: name on command lines and in result files, for example "sgat-full".
      title: name in tables and on pages, for example "SGAT, uneven sim".
      means: lines of Markdown for result pages that explain how it differs from the
        SGAT paper's methods; empty for the paper's own.
      uneven_sim: whether the sim behind the transformer has uneven ground and noisy
        sensors; if so, it learns from `GroundingData.uneven`.
    """

    name: str
    title: str
    means: tuple[str, ...] = ()
    uneven_sim: bool = False

    @property
    def is_random(self) -> bool:
        """Whether rollouts of a policy in the grounded sim depend on the seed."""
        return True

    @abstractmethod
    def transformer(self, data: GroundingData) -> KeptTransformer:
        """A new transformer; models that `data` already holds are not fitted again."""

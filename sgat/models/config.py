"""Settings of networks: shape, training, and the distribution that one predicts."""

from dataclasses import dataclass
from typing import Literal, get_args

from groundwalk.errors import BadValueError, UnknownNameError
from sgat.models.heads import FullHead, GaussianHead, Head, LowRankHead, MixtureHead


@dataclass(frozen=True)
class NetworkConfig:
    """Settings of a network's shape and training.

    Attributes:
      hidden: width of each hidden layer; two of 64 in the SGAT paper.
      epochs: largest number of passes through the data at each learning rate.
      batch: transitions in one step of the optimiser.
      learning_rate: first rate of AdamW; a tenth of it refines the result.
      weight_decay: that of AdamW, decoupled from the gradient.
      patience: epochs without a better held-out loss after which training stops.
      validation_share: share of the episodes that is held out to decide when to stop.

    Example:
      >>> NetworkConfig(hidden=(32,)).epochs
      200
    """

    hidden: tuple[int, ...] = (64, 64)
    epochs: int = 200
    batch: int = 256
    learning_rate: float = 2e-3
    weight_decay: float = 1e-4
    patience: int = 10
    validation_share: float = 0.2

    def __post_init__(self) -> None:
        """Refuse settings with which nothing can be trained."""
        object.__setattr__(self, "hidden", tuple(self.hidden))
        if not self.hidden or min(self.hidden) < 1:
            raise BadValueError(f"hidden is {self.hidden}; give each layer's width")
        self._check_counts("epochs", "batch", "patience")
        if not 0 < self.learning_rate < 1:
            raise BadValueError(
                f"learning_rate is {self.learning_rate}; it must be between 0 and 1"
            )
        if not 0 <= self.weight_decay < 1:
            raise BadValueError(
                f"weight_decay is {self.weight_decay}; it must be 0 or below 1"
            )
        if not 0 < self.validation_share < 1:
            raise BadValueError(
                f"validation_share is {self.validation_share}; it must be between 0 "
                "and 1"
            )

    def _check_counts(self, *names: str) -> None:
        for name in names:
            value = getattr(self, name)
            if value < 1:
                raise BadValueError(f"{name} is {value}; it must be at least 1")

    def shape(self, dimensions: int) -> tuple[int, int]:
        """Raw outputs for targets of some dimensions, and the number of networks."""
        return dimensions, 1


HeadName = Literal["gaussian", "mixture", "low-rank", "full"]
"""Families of distributions that a forward model can predict; see `ForwardConfig`."""


@dataclass(frozen=True)
class ForwardConfig(NetworkConfig):
    """Network and distribution of a forward model.

    Attributes:
      head: "gaussian": normal, with independent dimensions, as in the SGAT paper;
        "full" or "low-rank": normal with a covariance; "mixture": several normal
        distributions, for dynamics with more than one outcome.
      components: number of components of a mixture.
      rank: number of columns of U, for "low-rank" with the covariance U U^T + D.
      beta: exponent of the beta-NLL loss of the head "gaussian". 0 is the plain
        likelihood; with 0.5 the mean is learned as well where the spread is large
        (Seitzer et al. 2022).
      members: number of networks in the ensemble, each fitted to its own bootstrap
        sample of the episodes. A robot keeps one network for a whole episode
        (TS-infinity of Chua et al. 2018).

    Example:
      >>> ForwardConfig(head="full").head
      'full'
    """

    head: HeadName = "gaussian"
    components: int = 3
    rank: int = 2
    beta: float = 0.0
    members: int = 1

    def __post_init__(self) -> None:
        """Refuse values that describe no distribution."""
        super().__post_init__()
        if self.head not in get_args(HeadName):
            raise UnknownNameError("head", self.head, get_args(HeadName))
        self._check_counts("components", "rank", "members")
        if not 0 <= self.beta <= 1 or (self.beta and self.head != "gaussian"):
            raise BadValueError(
                f"beta is {self.beta}; it must be between 0 and 1, and 0 for every "
                "head but the Gaussian one"
            )

    def shape(self, dimensions: int) -> tuple[int, int]:
        """Raw outputs for targets of some dimensions, and the number of networks."""
        return self.make_head(dimensions).width, self.members

    def make_head(self, dimensions: int) -> Head:
        """The family of distributions over next states with this number of columns."""
        match self.head:
            case "gaussian":
                return GaussianHead(dimensions, self.beta)
            case "full":
                return FullHead(dimensions)
            case "low-rank":
                return LowRankHead(dimensions, self.rank)
            case "mixture":
                return MixtureHead(dimensions, self.components)

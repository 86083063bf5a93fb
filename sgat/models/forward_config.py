"""Which network and which distribution a forward model is."""

from dataclasses import dataclass
from typing import Literal, get_args

from groundwalk.errors import BadValueError, UnknownNameError
from sgat.models.heads import FullHead, GaussianHead, Head, LowRankHead
from sgat.models.mixture_head import MixtureHead
from sgat.models.network_config import NetworkConfig

HeadName = Literal["gaussian", "mixture", "low-rank", "full"]


@dataclass(frozen=True)
class ForwardConfig(NetworkConfig):
    """A network and the distribution that it describes.

    Attributes:
      head: "gaussian": independent dimensions, the paper's; "full" or "low-rank":
        with a covariance; "mixture": more than one outcome, the paper's footnote.
      components: of a mixture.
      rank: of the low-rank part of a covariance.
      beta: of the beta-NLL for the Gaussian head; 0 is the plain likelihood, 0.5 keeps
        the mean learning where the spread is large (Seitzer et al. 2022).
      members: networks in the ensemble, each with its own bootstrapped episodes. A
        robot keeps one for an episode: what is not known of the world does not
        change from tick to tick (TSinf of Chua et al. 2018).
    """

    head: HeadName = "gaussian"
    components: int = 3
    rank: int = 2
    beta: float = 0.0
    members: int = 1

    def __post_init__(self) -> None:
        """Refuse what is no distribution."""
        super().__post_init__()
        if self.head not in get_args(HeadName):
            raise UnknownNameError("head", self.head, get_args(HeadName))
        for name in ("components", "rank", "members"):
            if getattr(self, name) < 1:
                raise BadValueError(
                    f"{name} is {getattr(self, name)}; it must be at least 1"
                )
        if not 0 <= self.beta <= 1 or (self.beta and self.head != "gaussian"):
            raise BadValueError(
                f"beta is {self.beta}; it must be between 0 and 1, and 0 for every "
                "head but the Gaussian one"
            )

    def make_head(self, dimensions: int) -> Head:
        """The distribution over so many numbers."""
        match self.head:
            case "gaussian":
                return GaussianHead(dimensions, self.beta)
            case "full":
                return FullHead(dimensions)
            case "low-rank":
                return LowRankHead(dimensions, self.rank)
            case "mixture":
                return MixtureHead(dimensions, self.components)

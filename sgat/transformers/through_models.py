"""GAT, SGAT and their variants: groundings through a forward and an inverse model."""

from dataclasses import dataclass, replace
from typing import Literal

from sgat.models.config import HeadName
from sgat.noise import BlockNoise, NoiseLaw, WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.catalogue import add_grounding
from sgat.transformers.grounding_base import Grounding, GroundingData

BLOCK_TICKS = 50
"""Length of a block of residuals [ticks of 10 ms]: two to three steps of a walk. Blocks
keep the correlation over time: a bump pushes all joints one way for several ticks."""

MEMBERS = 4
"""Number of networks in an ensemble, so that a search cannot exploit one's errors."""


@dataclass(frozen=True)
class ThroughModels(Grounding):
    """Grounding by g(s, a) = f_inv(s, f_real(s, a)): a forward and an inverse model.

    With the `noise` "none", f_real predicts the mean, as in GAT; with "white" a sample,
    as in SGAT; with "blocks" a sample made of consecutive residuals of real data. It
    has `members` networks, which predict distributions of the family `head`.
    """

    name: str
    title: str
    noise: Literal["none", "white", "blocks"] = "white"
    head: HeadName = "gaussian"
    members: int = 1
    means: tuple[str, ...] = ()

    @property
    def is_random(self) -> bool:
        """Whether f_real predicts samples, so that rollouts depend on the seed."""
        return self.noise != "none"

    def transformer(self, data: GroundingData) -> ActionTransformer:
        """A new transformer; models that `data` already holds are not fitted again."""
        beta = data.network.beta if self.head == "gaussian" else 0.0
        forward = data.forward(
            replace(data.network, head=self.head, members=self.members, beta=beta)
        )
        law: NoiseLaw | None = None
        if self.noise == "white":
            law = WhiteNoise(forward.outcomes)
        elif self.noise == "blocks":
            residuals = forward.residuals(data.real)
            law = BlockNoise(residuals, data.real.episode, BLOCK_TICKS)
        models, bounds = (forward, data.inverse()), (data.low, data.high)
        return ActionTransformer(
            *models, *bounds, law, inverse_columns=data.sim_columns
        )


for _one in (
    ThroughModels("gat", "GAT", "none"),
    ThroughModels("sgat", "SGAT"),
    ThroughModels("sgat-full", "SGAT, full covariance", head="full"),
    ThroughModels("sgat-low-rank", "SGAT, low-rank covariance", head="low-rank"),
    ThroughModels("sgat-mixture", "SGAT, mixture", head="mixture"),
    ThroughModels(
        "sgat-ensemble",
        "SGAT, ensemble",
        "blocks",
        members=MEMBERS,
        means=(
            "SGAT, ensemble: four networks, of which each walk uses one; the noise is",
            "made of blocks of half a second of the real walks' residuals, instead of",
            "white noise.",
        ),
    ),
):
    add_grounding(_one)

"""Settings of a network's shape and training."""

from dataclasses import dataclass

from groundwalk.errors import BadValueError


@dataclass(frozen=True)
class NetworkConfig:
    """Settings of a network's shape and training.

    Attributes:
      hidden: width of each hidden layer; two of 64 in the SGAT paper.
      epochs: largest number of passes through the data at each learning rate.
      batch: transitions in one step of the optimiser.
      learning_rate: first learning rate of AdamW; a tenth of it refines the result.
      weight_decay: weight decay of AdamW, which is decoupled from the gradient.
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
        for name in ("epochs", "batch", "patience"):
            if getattr(self, name) < 1:
                raise BadValueError(
                    f"{name} is {getattr(self, name)}; it must be at least 1"
                )
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

    def shape(self, dimensions: int) -> tuple[int, int]:
        """Raw outputs for targets of some dimensions, and the number of networks."""
        return dimensions, 1

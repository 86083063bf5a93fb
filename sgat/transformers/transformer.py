"""What an action transformer must be able to do."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Protocol, Self

import numpy as np

from groundwalk.arrays import FloatArray


class Transformer(Protocol):
    """Stands between a policy and n robots of a world, and changes their actions.

    Example:
      >>> transformer = grounding("sgat").transformer(data)
      >>> transformer.reset(seeds)
      >>> changed = transformer(state, action)
    """

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with its own seed."""

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) actions that the world is given, in the unit of the policy's.

        Args:
          state: (n, s) states of the robots.
          action: (n, a) actions that the policy asks for.
        """


class KeptTransformer(Transformer, Protocol):
    """A transformer that can be written into a folder and read back.

    Attributes:
      kind: what the folder's header calls this class.

    Example:
      See `write_transformer`.
    """

    kind: ClassVar[str]

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(a,) least and (a,) largest action, in the action's units."""

    def save(self, folder: Path) -> dict[str, Any]:
        """Write the models into a folder.

        Returns:
          Plain values that `load` needs besides the models; they go into the header.
        """

    @classmethod
    def load(
        cls, folder: Path, header: Mapping[str, Any], low: FloatArray, high: FloatArray
    ) -> Self:
        """Read back what `save` has written, with the least and largest action (a,)."""

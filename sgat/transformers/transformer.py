"""Interfaces of action transformers: plain ones, and those that have files."""

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
        """(n, a) actions for the world, from states (n, s) and asked actions (n, a)."""


class KeptTransformer(Transformer, Protocol):
    """A transformer that can be written into a folder and read back.

    Attributes:
      kind: name of this class in the folder's header, by which the reader finds it.
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
        """Read what `save` wrote; the least and largest action are (a,) each."""

"""The action transformer of GAT and SGAT: a forward and an inverse model in a row."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import NoiseLaw, NoiseStream, WhiteNoise
from sgat.transformers.catalogue import file_kind

FORWARD, INVERSE = "forward.pt", "inverse.pt"
"""Names of the two models' files in a transformer's folder."""


@file_kind
class ActionTransformer:
    """g(s, a) = f_inv(s, f_real(s, a)) for n robots in one call.

    g gives the action that makes the sim do what the real world would do: f_real
    predicts the real next state, f_inv finds the sim's action that leads there. Without
    noise, f_real predicts the mean: GAT (Hanna and Stone 2017). With noise it predicts
    a sample: SGAT (Desai et al. 2020). The result is clipped to the action's bounds,
    because the models have learned nothing about actions beyond them.

    Example:
      >>> noise = WhiteNoise(forward.outcomes)
      >>> g = ActionTransformer(forward, inverse, low, high, noise)
      >>> g.reset(seeds)
      >>> transformed = g(state, action)
    """

    kind: ClassVar[str] = "through models"

    def __init__(
        self,
        forward: ForwardModel,
        inverse: InverseModel,
        low: FloatArray,
        high: FloatArray,
        noise: NoiseLaw | None = None,
        smoothing: float = 1.0,
        inverse_columns: int | None = None,
    ) -> None:
        """Join a model of the real world and an inverse model of the sim, both fitted.

        Args:
          forward: f_real.
          inverse: f_inv.
          low: (a,) least action.
          high: (a,) largest action.
          noise: None for GAT; for SGAT, of as many dimensions as a next state.
          smoothing: share of the transformed action in the result, from 0 to 1; the
            remainder is the policy's action.
          inverse_columns: how many of a state's first columns the inverse model sees;
            all if None.
        """
        if not 0 <= smoothing <= 1:
            raise BadValueError(f"smoothing is {smoothing}; it must be from 0 to 1")
        if noise is not None and noise.dimensions != forward.outcomes:
            raise BadValueError(
                f"the noise has {noise.dimensions} dimensions; it must have "
                f"{forward.outcomes}"
            )
        self.forward = forward
        self.inverse = inverse
        self.noise = noise
        self.smoothing = smoothing
        self.inverse_columns = inverse_columns
        self.bounds = np.asarray(low, float), np.asarray(high, float)
        self._stream: NoiseStream | None = None

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with its own seed."""
        if self.noise is not None:
            self._stream = NoiseStream(self.noise, seeds)

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) actions for the sim, from states (n, s) and a policy's actions (n, a).

        With noise, each call draws the noise of one tick.
        """
        if self.noise is None:
            wanted = self.forward.predict(state, action)
        elif self._stream is None or self._stream.n != len(state):
            n = len(state)
            raise BadValueError(f"reset with {n} seeds before {n} robots act")
        else:
            wanted = self.forward.sample(state, action, self._stream)
        found = self.inverse.predict(state[:, : self.inverse_columns], wanted)
        found = action + self.smoothing * (found - action)
        return np.clip(found, *self.bounds)

    def save(self, folder: Path) -> dict[str, Any]:
        """Write both models into a folder, and return what `load` needs besides."""
        noise = self.noise
        if not (noise is None or isinstance(noise, WhiteNoise)):
            kind = type(noise).__name__
            raise BadValueError(f"the noise is {kind}; only white noise can be written")
        self.forward.save(folder / FORWARD)
        self.inverse.save(folder / INVERSE)
        return {
            "noise_dimensions": noise and noise.dimensions,
            "smoothing": self.smoothing,
            "inverse_columns": self.inverse_columns,
        }

    @classmethod
    def load(
        cls, folder: Path, header: Mapping[str, Any], low: FloatArray, high: FloatArray
    ) -> Self:
        """Read what `save` wrote; `header` is what it returned, bounds are (a,)."""
        white = header["noise_dimensions"]
        return cls(
            ForwardModel.load(folder / FORWARD),
            InverseModel.load(folder / INVERSE),
            low,
            high,
            None if white is None else WhiteNoise(white),
            header["smoothing"],
            header["inverse_columns"],
        )

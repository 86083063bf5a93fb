"""How much of what SGAT asks of its sim the sim really does."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.action_transformer import ActionTransformer

_CALM = 8.0
"""Answers beyond so many standard deviations are falls and impacts, not answers."""


class RealisedShare:
    """Stands in an SGAT transformer's place, and compares wish and answer.

    The sample of a next state differs from the mean by what the real world's noise
    does: d. The sim's answer to the transformed action differs from the mean by e.
    If the sim did what it is asked, e would be d plus what the model does not know,
    and the regression of e on d through the origin would have the slope 1. Least
    squares and a sim that reacts slowly make it smaller; noise enlarged by one over the
    slope makes up for it.
    """

    def __init__(self, transformer: ActionTransformer) -> None:
        """Begin with nothing compared."""
        self._transformer = transformer
        self._asked: list[FloatArray] = []
        self._answered: list[FloatArray] = []

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode; see `Transformer.reset`."""
        self._transformer.reset(seeds)
        self._last: tuple[FloatArray, FloatArray, FloatArray] | None = None

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """The transformer's answer, once the sim's to the last one is compared."""
        if self._last is not None:
            last_state, mean, wish = self._last
            alive = (state != last_state).any(axis=1)
            self._asked.append((wish - mean)[alive])
            self._answered.append((state[:, : mean.shape[1]] - mean)[alive])
        found = self._transformer(state, action)
        wished = self._transformer.wish
        if wished is not None:
            expected = self._transformer.forward.predict(state, action)
            self._last = state, expected, wished
        return found

    def share(self) -> FloatArray:
        """(p,) slope of the answers on the wishes; 1 if the sim does as it is asked.

        Raises:
          BadValueError: nothing was compared: there was no noise, or no second tick.
        """
        if not self._asked:
            raise BadValueError("nothing was asked of the sim: there is no noise")
        asked, answered = np.concatenate(self._asked), np.concatenate(self._answered)
        spread = np.median(np.abs(answered), axis=0) / 0.6745
        calm = (np.abs(answered) <= _CALM * spread).all(axis=1)
        asked, answered = asked[calm], answered[calm]
        return np.asarray((asked * answered).sum(axis=0) / (asked**2).sum(axis=0))

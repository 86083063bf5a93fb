"""What errors of a model change in a residual, corrected without copies."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Changes:
    """(k, N) changes of a residual by k errors of one standard deviation each.

    They are `seen` + `steps`' `missed`. Simulated changes take most of a diagnosis'
    memory: corrections are kept apart, so that many corrected ones share them.

    Attributes:
      seen: (k, N) changes that were simulated.
      steps: (m, k) steps on the way of a fit from there.
      missed: (m, N) what is to be added to the changes for each unit of a step.
    """

    seen: FloatArray
    steps: FloatArray
    missed: FloatArray

    @classmethod
    def of(cls, seen: FloatArray) -> "Changes":
        """(k, N) changes without corrections; they are not copied."""
        k, entries = seen.shape
        return cls(seen, np.zeros((0, k)), np.zeros((0, entries)))

    def __len__(self) -> int:
        """The number k of errors."""
        return len(self.seen)

    def corrected(self, steps: FloatArray, missed: FloatArray) -> "Changes":
        """The changes with further corrections, see the attributes."""
        every = np.vstack([self.steps, steps]), np.vstack([self.missed, missed])
        return Changes(self.seen, *every)

    def part(self, entries: slice) -> "Changes":
        """The changes of some of the residual's entries."""
        return Changes(self.seen[:, entries], self.steps, self.missed[:, entries])

    def on(self, residuals: FloatArray) -> FloatArray:
        """(..., k) products of residuals (..., N) with each change."""
        missed = (residuals @ self.missed.T) @ self.steps
        return np.asarray(residuals @ self.seen.T + missed)

    def by(self, sizes: FloatArray) -> FloatArray:
        """(..., N) changes by errors of several sizes (..., k) together."""
        missed = (sizes @ self.steps.T) @ self.missed
        return np.asarray(sizes @ self.seen + missed)

    def products(self) -> FloatArray:
        """(k, k) products of the changes with each other."""
        more = (self.seen @ self.missed.T) @ self.steps
        both = self.steps.T @ (self.missed @ self.missed.T) @ self.steps
        return np.asarray(self.seen @ self.seen.T + more + more.T + both)

    def whole(self) -> FloatArray:
        """(k, N) all of them, as a copy."""
        return np.asarray(self.seen + self.steps.T @ self.missed)

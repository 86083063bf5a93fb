"""Removes from residuals what errors within a model's tolerance can explain.

No model is exact: masses are known to some percent, gains and friction to some more. A
change of the residual (signature) that a model has within these tolerances is no
evidence of missing physics. Residuals are whitened with the covariance of sensor noise
and tolerances together (generalised least squares, Aitken 1936): their energy is then
minus the log-likelihood with all tolerances marginalised, to first order.
"""

from collections.abc import Collection, Sequence

import numpy as np
from scipy.linalg import block_diag

from groundwalk.arrays import BoolArray, FloatArray

NEGLIGIBLE = 1e-6
"""Smallest eigenvalue of the signatures' products [noise^2], as a share of 1, that is
whitened; what is smaller is far below the noise."""


class Tolerance:
    """The space of changes of a residual that tolerances allow, as orthogonal axes.

    Residuals may be those of a model with likely errors already in it.

    Attributes:
      changes: (k, N) changes of the residual [noise] by one standard deviation each.
    """

    def __init__(
        self,
        signatures: FloatArray,
        names: Sequence[str] = (),
        sizes: FloatArray | None = None,
        spread: FloatArray | None = None,
    ) -> None:
        """Use (k, N) changes of the residual [noise] by one standard deviation each.

        `names` says of each what is uncertain, such as "payload_mass@forearm"; `sizes`
        (k,) are the errors, in standard deviations, that residuals have in them;
        `spread` (k, k) is the errors' covariance, None if they are independent.
        """
        self.changes, self._names = signatures, tuple(names)
        self._sizes = np.zeros(len(signatures)) if sizes is None else sizes
        self._spread = spread
        root = signatures if spread is None else _root(spread).T @ signatures
        power, turn = np.linalg.eigh(root @ root.T)
        kept = power > NEGLIGIBLE
        self._power, turn = power[kept], turn[:, kept]
        unit = (turn / np.sqrt(self._power)).T @ root
        # (I + S'S)^(-1/2) = I - A'A, with A the axes below
        share = 1 - 1 / np.sqrt(1 + self._power)
        self._axes = np.sqrt(share)[:, None] * unit

    def part(self, entries: BoolArray) -> "Tolerance":
        """Tolerances for some of a residual's entries, those where (N,) is true."""
        some = self.changes[:, entries]
        return Tolerance(some, self._names, self._sizes, self._spread)

    def beside(self, known: Collection[str]) -> "Tolerance":
        """The tolerances of all but what is `known`, by its name, to be fitted."""
        kept = [i for i, name in enumerate(self._names) if name not in known]
        names = [self._names[i] for i in kept]
        spread = None if self._spread is None else self._spread[np.ix_(kept, kept)]
        return Tolerance(self.changes[kept], names, self._sizes[kept], spread)

    @property
    def taken(self) -> float:
        """Number of the N entries' squares that whitening takes out of noise."""
        return float(np.sum(self._power / (1 + self._power)))

    def and_of(self, other: "Tolerance") -> "Tolerance":
        """These tolerances and others of the same residual."""
        every = np.vstack([self.changes, other.changes])
        sizes = np.concatenate([self._sizes, other._sizes])
        spread = None
        if self._spread is not None or other._spread is not None:
            spread = block_diag(self._covariance(), other._covariance())
        return Tolerance(every, (*self._names, *other._names), sizes, spread)

    def _covariance(self) -> FloatArray:
        """(k, k) covariance of the errors, in standard deviations."""
        independent = np.eye(len(self.changes))
        return independent if self._spread is None else self._spread

    def taken_back(self, known: Collection[str]) -> FloatArray:
        """(N,) what the errors that residuals have in them change in these.

        That is to be taken from a residual, to first order that of no such errors.
        Those that are `known`, by their name, are not in it.
        """
        own = np.array([name not in known for name in self._names], bool)
        sizes = self._sizes if not self._names else self._sizes * own
        return np.asarray(sizes @ self.changes)

    def without(self, residuals: FloatArray) -> FloatArray:
        """(n, N) residuals, whitened."""
        return np.asarray(residuals - (residuals @ self._axes.T) @ self._axes)


def _root(spread: FloatArray) -> FloatArray:
    """(k, k) matrix R with R R' = spread, which may be singular to rounding."""
    power, axes = np.linalg.eigh(spread)
    return np.asarray(axes * np.sqrt(np.maximum(power, 0.0)))


def without_each(
    parts: Sequence[tuple[int, Tolerance]], residual: FloatArray
) -> FloatArray:
    """(n, rows, c) residuals, whitened in successive parts.

    Each part is its number of rows, and what is tolerated in them.
    """
    cleaned, first = [], 0
    for rows, tolerance in parts:
        part = residual[:, first : first + rows]
        flat = tolerance.without(part.reshape(len(part), -1))
        cleaned.append(flat.reshape(part.shape))
        first += rows
    return np.concatenate(cleaned, axis=1)

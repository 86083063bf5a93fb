"""Removes from residuals what errors within a model's tolerance can explain.

No model is exact: masses are known to some percent, gains and friction to some more. A
change of the residual (signature) that a model has within these tolerances is no
evidence of missing physics. Residuals are whitened with the covariance of sensor noise
and tolerances together (generalised least squares, Aitken 1936): their energy is then
minus the log-likelihood with all tolerances marginalised, to first order.
"""

from collections.abc import Collection, Sequence
from copy import copy

import numpy as np
from scipy.linalg import block_diag

from diagnosis.residuals.changes import Changes
from groundwalk.arrays import FloatArray


class Tolerance:
    """The space of changes of a residual that tolerances allow.

    Residuals may be those of a model with likely errors already in it.
    """

    def __init__(
        self,
        signatures: Changes,
        names: Sequence[str] = (),
        sizes: FloatArray | None = None,
        spread: FloatArray | None = None,
    ) -> None:
        """Use (k, N) changes of the residual [noise] by one standard deviation each.

        `names` says of each what is uncertain, such as "payload_mass@forearm"; `sizes`
        (k,) are the errors, in standard deviations, that residuals have in them;
        `spread` (k, k) is the errors' covariance, None if they are independent.
        """
        self._changes, self._names = signatures, tuple(names)
        self._sizes = np.zeros(len(signatures)) if sizes is None else sizes
        self._spread = np.eye(len(signatures)) if spread is None else spread
        self._products = signatures.products()
        self._prepare()

    def _prepare(self) -> None:
        """Find how residuals are whitened."""
        root = _root(self._spread)
        power, turn = np.linalg.eigh(root.T @ self._products @ root)
        self._power = np.maximum(power, 0.0)
        # (I + S'S)^(-1/2) = I - (S'V)(S'V)', with S the changes and V the mix
        far = np.sqrt(1 + self._power)
        self._mix = root @ turn / np.sqrt(far * (1 + far))

    def part(self, entries: slice) -> "Tolerance":
        """Tolerances for some of a residual's entries."""
        some = self._changes.part(entries)
        return Tolerance(some, self._names, self._sizes, self._spread)

    def beside(self, known: Collection[str]) -> "Tolerance":
        """The tolerances of all but what is `known`, by its name, to be fitted."""
        own = np.array([name not in known for name in self._names], bool)
        if own.all():
            return self
        some = copy(self)
        some._sizes = np.where(own, self._sizes, 0.0)
        some._spread = np.where(own & own[:, None], self._spread, 0.0)
        some._prepare()
        return some

    @property
    def taken(self) -> float:
        """Number of the N entries' squares that whitening takes out of noise."""
        return float(np.sum(self._power / (1 + self._power)))

    def and_of(self, other: "Tolerance") -> "Tolerance":
        """These tolerances and others of the same residual."""
        if not len(other._changes):
            return self
        both = self._changes.whole(), other._changes.whole()
        sizes = np.concatenate([self._sizes, other._sizes])
        spread = block_diag(self._spread, other._spread)
        every = Changes.of(np.vstack(both))
        return Tolerance(every, (*self._names, *other._names), sizes, spread)

    def taken_back(self, known: Collection[str]) -> FloatArray:
        """(N,) what the errors that residuals have in them change in these.

        That is to be taken from a residual, to first order that of no such errors.
        Those that are `known`, by their name, are not in it.
        """
        own = np.array([name not in known for name in self._names], bool)
        sizes = self._sizes if not self._names else self._sizes * own
        return self._changes.by(sizes)

    def without(self, residuals: FloatArray) -> FloatArray:
        """(n, N) residuals, whitened."""
        known = self._changes.on(residuals) @ self._mix
        return np.asarray(residuals - self._changes.by(known @ self._mix.T))


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

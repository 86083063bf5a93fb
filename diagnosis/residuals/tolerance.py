"""Removes from residuals what errors within a model's tolerance can explain.

No model is exact: masses are known to some percent, gains and friction to some more. A
change of the residual (signature) that a model has within these tolerances is no
evidence of missing physics. Residuals are whitened with the covariance of sensor noise
and tolerances together (generalised least squares, Aitken 1936): their energy is then
minus the log-likelihood with all tolerances marginalised, to first order.
"""

from collections.abc import Collection, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from groundwalk.arrays import BoolArray, FloatArray

NEGLIGIBLE = 1e-6
"""Smallest eigenvalue of the signatures' products [noise^2], as a share of 1, that is
whitened; what is smaller is far below the noise."""

LARGEST_SCALE = 20.0
"""Largest factor by which a model may be outside its tolerances; the smallest is its
inverse. Beyond both nothing changes any more: signatures vanish or are all removed."""


class Tolerance:
    """The space of changes of a residual that tolerances allow, as orthogonal axes."""

    def __init__(self, signatures: FloatArray, names: Sequence[str] = ()) -> None:
        """Use (k, N) changes of the residual [noise] by one standard deviation each.

        `names` says of each what is uncertain, such as "payload_mass@forearm".
        """
        self._signatures, self._names = signatures, tuple(names)
        power, turn = np.linalg.eigh(signatures @ signatures.T)
        kept = power > NEGLIGIBLE
        self._power, turn = power[kept], turn[:, kept]
        self._unit = (turn / np.sqrt(self._power)).T @ signatures
        # (I + S'S)^(-1/2) = I - A'A, with A the axes below
        share = 1 - 1 / np.sqrt(1 + self._power)
        self._axes = np.sqrt(share)[:, None] * self._unit

    def part(self, entries: BoolArray) -> "Tolerance":
        """Tolerances for some of a residual's entries, those where (N,) is true."""
        return Tolerance(self._signatures[:, entries], self._names)

    def beside(self, known: Collection[str]) -> "Tolerance":
        """The tolerances of all but what is `known`, by its name, to be fitted."""
        kept = [i for i, name in enumerate(self._names) if name not in known]
        names = [self._names[i] for i in kept]
        return Tolerance(self._signatures[kept], names)

    @property
    def taken(self) -> float:
        """Number of the N entries' squares that whitening takes out of noise."""
        return float(np.sum(self._power / (1 + self._power)))

    def and_of(self, other: "Tolerance") -> "Tolerance":
        """These tolerances and others of the same residual."""
        every = np.vstack([self._signatures, other._signatures])
        return Tolerance(every, (*self._names, *other._names))

    def scaled(self, factor: float) -> "Tolerance":
        """The tolerances, all so many times as large."""
        return Tolerance(factor * self._signatures, self._names)

    def likely_scale(self, residual: FloatArray) -> float:
        """The factor for all tolerances that makes an (N,) residual most likely.

        The residual is that of a model, not whitened. A robot as exact as its model has
        a factor near 0, so that what is fitted need not be as wide as tolerances allow
        (empirical Bayes: the marginal likelihood is maximised).
        """
        seen = (self._unit @ residual) ** 2
        if not len(seen):
            return 1.0

        def surprise(log_factor: float) -> float:
            variance = 1 + np.exp(2 * log_factor) * self._power
            return float(np.sum(np.log(variance) + seen / variance))

        most = np.log(LARGEST_SCALE)
        found = minimize_scalar(surprise, bounds=(-most, most), method="bounded")
        return float(np.exp(found.x))

    def without(self, residuals: FloatArray) -> FloatArray:
        """(n, N) residuals, whitened."""
        return np.asarray(residuals - (residuals @ self._axes.T) @ self._axes)

"""A point that a fit of small mismatch visits, and what is known of the way there."""

from dataclasses import dataclass, replace

import numpy as np

from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from groundwalk.arrays import FloatArray

NEAR = 1.0
"""Distance from where changes were simulated, in standard deviations, up to which they
still count: no error is out of proportion over so little."""

NEAR_X = 0.1
"""Distance of a model's values from where changes were simulated, in scaled
coordinates, in which they are of order one, up to which these changes still count."""


@dataclass(frozen=True, eq=False)
class FitPoint:
    """Where a fit is: errors, values of the model, and what is left there.

    On the way changes are corrected by what they missed on steps (Broyden 1965, "A
    class of methods for solving nonlinear simultaneous equations"). The corrections are
    kept apart from the changes that were simulated, which take much memory.

    Attributes:
      errors: small mismatch, with what it changes by simulations.
      x: (p,) scaled coordinates of the model's values that are fitted as well.
      slopes: (p, N) simulated derivatives of the residual by these.
      seen_x: (p,) those at which the derivatives were simulated.
      left: (N,) residual.
      steps: (m, k + p) steps since the simulations, of errors first.
      missed: (m, N) what is to be added to the changes for each unit of a step.
    """

    errors: Nuisance
    x: FloatArray
    slopes: FloatArray
    seen_x: FloatArray
    left: FloatArray
    steps: FloatArray
    missed: FloatArray

    @classmethod
    def of(cls, errors: Nuisance, x: FloatArray, left: FloatArray) -> "FitPoint":
        """A point whose changes by the (p,) values are not known."""
        slopes = np.zeros((len(x), len(left)))
        return cls(errors, x, slopes, x, left, *cls._none(errors, slopes))

    @staticmethod
    def _none(errors: Nuisance, slopes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """No steps, and nothing missed."""
        p, n = slopes.shape
        return np.zeros((0, len(errors.units) + p)), np.zeros((0, n))

    def simulated(
        self, errors: Nuisance, slopes: FloatArray, seen_x: FloatArray
    ) -> "FitPoint":
        """The point with changes that were simulated there."""
        own = dict(zip(("steps", "missed"), self._none(errors, slopes), strict=True))
        return replace(self, errors=errors, slopes=slopes, seen_x=seen_x, **own)

    @property
    def goal(self) -> float:
        """What a fit makes small: the sum of squares of residual and errors."""
        sizes = self.errors.sizes
        return float(self.left @ self.left + sizes @ sizes)

    @property
    def corrected(self) -> Nuisance:
        """The errors, with what they change corrected by what was missed."""
        if not len(self.steps):
            return self.errors
        steps = self.steps[:, : len(self.errors.units)]
        changes = self.errors.changes.corrected(steps, self.missed)
        return replace(self.errors, changes=changes)

    def products(self, scale: float) -> tuple[FloatArray, FloatArray]:
        """Products of what errors and values change, and of these with the residual.

        (k + p, k + p) and (k + p,), of errors first; of values that change by `scale`.
        """
        changes, slopes, missed = self.errors.changes, self.slopes, self.missed
        both = changes.on(slopes).T
        each = np.block([[changes.products(), both], [both.T, slopes @ slopes.T]])
        more = np.vstack([changes.on(missed).T, slopes @ missed.T]) @ self.steps
        each += more + more.T + self.steps.T @ (missed @ missed.T) @ self.steps
        left = np.concatenate([changes.on(self.left), slopes @ self.left])
        left += (missed @ self.left) @ self.steps
        unit = np.ones(len(left))
        unit[len(changes) :] = scale
        return each * unit * unit[:, None], left * unit

    def errors_of_x(self) -> FloatArray:
        """(p,) standard errors of the values, the errors being uncertain as well."""
        known, _ = self.products(1.0)
        k = len(self.errors.sizes)
        known[range(k), range(k)] += 1.0
        spread = np.linalg.pinv(known, hermitian=True)
        return np.asarray(np.sqrt(np.diag(spread)[k:]))

    @property
    def is_near(self) -> bool:
        """Whether changes were simulated near this point."""
        far = np.abs(self.x - self.seen_x)
        seen_at = self.errors.seen_at
        if seen_at is None or far.max(initial=0.0) >= NEAR_X:
            return False
        far = np.abs(self.errors.sizes - seen_at[0])
        return bool(far.max(initial=0.0) < NEAR)

    def followed(self, other: "FitPoint") -> "FitPoint":
        """Another point, with changes that suit how the residual changed to there.

        They are the nearest matrix that does.
        """
        k = len(self.errors.units)
        moved = other.errors.sizes - self.errors.sizes
        step = np.concatenate([moved, other.x - self.x])
        expected = self.errors.changes.by(step[:k]) + step[k:] @ self.slopes
        expected += (self.steps @ step) @ self.missed
        missed = (other.left - self.left - expected) / (step @ step)
        return replace(
            other,
            steps=np.vstack([self.steps, step]),
            missed=np.vstack([self.missed, missed]),
        )

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

    Attributes:
      errors: small mismatch, with what it changes.
      x: (p,) scaled coordinates of the model's values that are fitted as well.
      slopes: (p, N) derivatives of the residual by these.
      seen_x: (p,) those at which the derivatives were simulated.
      left: (N,) residual.
    """

    errors: Nuisance
    x: FloatArray
    slopes: FloatArray
    seen_x: FloatArray
    left: FloatArray

    @property
    def goal(self) -> float:
        """What a fit makes small: the sum of squares of residual and errors."""
        sizes = self.errors.sizes
        return float(self.left @ self.left + sizes @ sizes)

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

        They are the nearest matrix that does: Broyden 1965, "A class of methods for
        solving nonlinear simultaneous equations".
        """
        step = other.errors.sizes - self.errors.sizes
        step_x = other.x - self.x
        missed = other.left - self.left
        missed -= step @ self.errors.changes + step_x @ self.slopes
        missed /= step @ step + step_x @ step_x
        changes = self.errors.changes + np.outer(step, missed)
        errors = replace(other.errors, changes=changes)
        return replace(
            other, errors=errors, slopes=self.slopes + np.outer(step_x, missed)
        )

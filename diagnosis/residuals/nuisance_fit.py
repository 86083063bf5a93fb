"""Fits the small mismatch of a robot model beside effects that it is to have."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.residuals.channels import MORE_THAN_NOISE
from diagnosis.residuals.nuisance import Nuisance
from diagnosis.residuals.replays import Model
from groundwalk.arrays import FloatArray

NUDGE = 0.5
"""Step of finite differences, in standard deviations."""

NEAR = 1.0
"""Distance from where changes were simulated, in standard deviations, up to which they
still count: no error is out of proportion over so little."""

MOST_STEPS = 6
"""Most steps of a fit before changes are simulated again."""

OFTEN, ONCE_MORE = 6, 2
"""Most times that changes are simulated in a fit: of a robot that may be healthy, and
elsewhere, where small mismatch that is fitted too well would stand for what is
missing."""

SHARES = (1.0, 0.5, 0.25)
"""Shares of a linear step that are tried, of which the best is taken."""

ENOUGH, ENOUGH_NATS = 1e-3, 1.0
"""Share of the energy, and energy [nats], by which a step must lower it; otherwise the
fit ends."""


@dataclass(frozen=True, eq=False)
class NuisanceFit:
    """Fits of small mismatch to a residual, beside a model.

    Attributes:
      ask: computes the (n, N) residuals of n models.
      model: what is fitted beside. At its places it replaces small mismatch.
    """

    ask: Callable[[list[Model]], FloatArray]
    model: Model

    def fitted(self, start: Nuisance, most_seen: int = ONCE_MORE) -> Nuisance:
        """The likeliest errors; what each changes is simulated `most_seen` times.

        Their values minimise the energy of the residual and of the errors themselves
        (maximum a posteriori) by Gauss-Newton steps, from those of `start`. What each
        changes is simulated there, and again if they move far, and followed from step
        to step in between (Broyden 1965, "A class of methods for solving nonlinear
        simultaneous equations"). Where they leave more than twice the noise more is
        missing than small mismatch, which would only stand for it: there they stay at
        none.
        """
        begun, left = self._begun(start)
        if not self._was_seen(begun):
            begun = self._linear(begun, left)
        now, left = self._descended(begun, left)
        for _ in range(most_seen - 1):
            far_off = _mean_square(left) >= MORE_THAN_NOISE**2
            if _is_near(now) or (far_off and most_seen == ONCE_MORE):
                break
            now, left = self._descended(self._linear(now, left), left)
        if _mean_square(left) < MORE_THAN_NOISE**2:
            return now
        assert begun.seen_at is not None
        none = begun.at(np.zeros(len(begun.units)))
        return self.seen(none) if begun.seen_at[0].any() else none

    def moved(self, start: Nuisance) -> Nuisance:
        """The likeliest errors by what they changed where another fit ended."""
        now, left = self._begun(start)
        if now.seen_at is None:
            now = self._linear(now, left)
        return self._descended(now, left)[0]

    def seen(self, errors: Nuisance) -> Nuisance:
        """Given errors, with what they change in these residuals."""
        return self._linear(errors, self._left(errors))

    def _begun(self, start: Nuisance) -> tuple[Nuisance, FloatArray]:
        """Errors only where the model has no effects, and their residual (N,)."""
        now = start.at(np.where(start.free_of(self._keys), start.sizes, 0.0))
        return now, self._left(now)

    def _descended(
        self, now: Nuisance, left: FloatArray
    ) -> tuple[Nuisance, FloatArray]:
        """The errors after steps as long as these help, and their residual (N,)."""
        for _ in range(MOST_STEPS):
            before = _goal(left, now.sizes)
            sizes, rest = self._step(now, left)
            least = max(ENOUGH * before, 2 * ENOUGH_NATS)
            if _goal(rest, sizes) > before - least:
                break
            now, left = now.followed(sizes, rest - left), rest
        return now, left

    def _step(self, now: Nuisance, left: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The best (k,) sizes on the way to the likeliest ones, and the residual."""
        wanted = now.likeliest(left, now.free_of(self._keys))
        steps = [now.sizes + share * (wanted - now.sizes) for share in SHARES]
        others = self.ask([self._beside(now.at(one)) for one in steps])
        every = [(now.sizes, left), *zip(steps, others, strict=True)]
        return min(every, key=lambda one: _goal(one[1], one[0]))

    def _linear(self, now: Nuisance, left: FloatArray) -> Nuisance:
        """The errors, with what one standard deviation of each would change.

        `left` (N,) is the residual beside them.
        """
        tried, sizes = list[Model](), np.empty(len(now.units))
        for i, unit in enumerate(now.units):
            taken = unit.key in self._keys
            sizes[i] = 1.0 if taken else NUDGE
            more = sizes[i] * (np.arange(len(now.units)) == i)
            own = now if taken else now.at(now.sizes + more)
            tried.append((*self._beside(own), *([unit] if taken else ())))
        changes = (self.ask(tried) - left) / sizes[:, None] if tried else now.changes
        return replace(now, changes=changes, seen_at=(now.sizes, self._keys))

    def _left(self, errors: Nuisance) -> FloatArray:
        """(N,) residual of the model beside errors."""
        return np.asarray(self.ask([self._beside(errors)])[0])

    def _beside(self, errors: Nuisance) -> Model:
        """The model, and effects that stand for errors where it has none."""
        return (*errors.beside(self._keys), *self.model)

    def _was_seen(self, errors: Nuisance) -> bool:
        """Whether changes were simulated beside a model with such effects."""
        return errors.seen_at is not None and errors.seen_at[1] == self._keys

    @property
    def _keys(self) -> frozenset[str]:
        return frozenset(one.key for one in self.model)


def _is_near(errors: Nuisance) -> bool:
    """Whether changes were simulated near these errors."""
    if errors.seen_at is None:
        return False
    far = np.abs(errors.sizes - errors.seen_at[0])
    return bool(far.max(initial=0.0) < NEAR)


def _mean_square(left: FloatArray) -> float:
    """Mean square of the entries of a residual (N,) that count; others are 0."""
    return float(left @ left) / max(int(np.count_nonzero(left)), 1)


def _goal(left: FloatArray, sizes: FloatArray) -> float:
    return float(left @ left + sizes @ sizes)

"""Fits the small mismatch of a robot model beside effects that it is to have."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.effects.library import keys_within
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.channels import MORE_THAN_NOISE
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.replays import Model
from diagnosis.residuals.small_mismatch.fit_point import FitPoint
from diagnosis.residuals.small_mismatch.likely_sizes import likeliest
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from groundwalk.arrays import BoolArray, FloatArray

NUDGE = 0.5
"""Step of finite differences, in standard deviations."""

NUDGE_X = 0.02
"""Step of finite differences of a model's values, in scaled coordinates, in which they
are of order one."""

WIDE = 1.0
"""Step of differences to both sides, in standard deviations: over a wider one what
friction and play do at random changes less of a difference."""

AT_ONCE = 8
"""Errors and values whose changes are simulated at once, for memory."""

STILL, MOST_ROUNDS = 0.5, 8
"""Share of its standard error by which a value may move in the last round of a fit, and
most rounds of it; three to six suffice mostly."""

FLAT = 100.0
"""Standard deviation of values of a model before anything is measured, in scaled
coordinates: so large that it says nothing."""

MOST_STEPS = 6
"""Most steps of a fit before changes are simulated again."""

MOST_SEEN = 6
"""Most times that changes are simulated in a fit; two to four suffice mostly."""

CLOSER = 0.5
"""Largest share of the mean square that a round may leave, as long as more than twice
the noise is left: what falls slower does not end at the noise in a few rounds."""

SETTLED = 0.95
"""Largest share of the mean square that a round may leave where errors and values are
to predict a robot that no model is exact of: what falls by less has settled."""

TRIED = ((1.0, 0.0), (0.5, 0.0), (0.25, 0.0), (1.0, 0.1), (1.0, 1.0))
"""Shares and dampings of the steps that are tried, of which the best is taken. Damped
steps (Marquardt 1963, "An algorithm for least-squares estimation of nonlinear
parameters") move least what the data tell least, where a linear step would go far."""

LAST_TRIED = ((1.0, 10.0), (1.0, 100.0), (1.0, 1000.0))
"""Shares and dampings of steps that are tried where none of `TRIED` helps: dry friction
and backlash can bend the way so much that far less than a quarter of a step is right.
"""

ENOUGH, ENOUGH_NATS = 1e-3, 1.0
"""Share of the energy, and energy [nats], by which a step must lower it; otherwise the
fit ends."""


@dataclass(frozen=True, eq=False)
class NuisanceFit:
    """Fits of small mismatch to a residual, beside a model.

    Attributes:
      ask: computes the (n, N) residuals of n models.
      correct: measures the integration error of a model, to be taken out of what `ask`
        computes after that.
      model: what is fitted beside. At its places it replaces small mismatch.
    """

    ask: Callable[[list[Model]], FloatArray]
    correct: Callable[[Model], object]
    model: Model

    def fitted(self, start: Nuisance) -> Nuisance:
        """The likeliest errors.

        They minimise the energy of the residual and of the errors themselves (maximum
        a posteriori) by Gauss-Newton steps, from those of `start`. What each changes is
        simulated, again if they move far, and followed from step to step in between.
        Their own integration error is taken out: a little dry friction changes it by
        more than noise.

        Where they leave more than twice the noise, the values of the model are fitted
        as well, but not returned: slightly wrong ones may have pulled at all errors.
        If that does not help, more is missing than small mismatch, which would only
        stand for it: there they stay at none.
        """
        begun = self._begun(start)
        none = self._begun(start.at(np.zeros(len(start.units))))
        if none.goal < begun.goal:  # what stood for something else leads astray
            begun = none
        if not (self._was_seen(begun.errors) and begun.is_near):
            begun = self._linear(begun)
        now = self._converged(begun)
        if _is_far_off(now.left) and self.model:
            x = self._coordinates(start).of(self.model)
            now = self._converged(self._sloped(self._placed(begun.errors, x)))
        if not _is_far_off(now.left):
            return now.corrected
        errors = begun.errors
        assert errors.seen_at is not None
        nothing = errors.at(np.zeros(len(errors.units)))
        return self.seen(nothing) if errors.seen_at[0].any() else nothing

    def fitted_with_values(self, start: Nuisance) -> tuple[Nuisance, Model]:
        """The likeliest errors and values of the model, together, whatever is left."""
        x = self._coordinates(start).of(self.model)
        begun = self._linear(self._placed(self._begun(start).errors, x))
        now = self._converged(begun, closer=SETTLED)
        return now.corrected, self._coordinates(start).model_at(now.x)

    def settled_with_values(self, start: Nuisance) -> tuple[Nuisance, Model]:
        """The likeliest errors and values of the model, where neither moves any more.

        In each round what they change is simulated to both sides, and the integration
        error is measured again: dry friction and play bend the way to the likeliest
        ones, on which single steps end too early.
        """
        x = self._coordinates(start).of(self.model)
        now = self._placed(self._begun(start).errors, x)
        self.correct(self._beside(now.errors, now.x))
        now = best = self._centred(self._at(now))
        for _ in range(MOST_ROUNDS):
            before, now = now, self._descended(now, share=0.0)
            if now is before:
                break
            self.correct(self._beside(now.errors, now.x))
            now = self._at(now)
            is_still = np.abs(now.x - before.x) <= STILL * before.errors_of_x()
            if np.all(is_still) and now.goal > before.goal - 2 * ENOUGH_NATS:
                best = min(now, best, key=lambda point: point.goal)
                break
            now = self._centred(now)
            best = min(now, best, key=lambda point: point.goal)
        return best.errors, self._coordinates(start).model_at(best.x)

    def ends(self, start: Nuisance, starts: FloatArray) -> FloatArray:
        """(m, p) where fits end that begin at (m, p) other values, in coordinates.

        Errors begin at those of `start`, around which it is known what they change.
        """
        x = self._coordinates(start).of(self.model)
        here, found = self._sloped(self._placed(start, x)), list[FloatArray]()
        for begun in starts:
            there = replace(self._placed(start, begun), slopes=here.slopes, seen_x=x)
            found.append(self._descended(there, share=0.0).x)
        return np.array(found)

    def _converged(self, now: FitPoint, closer: float = CLOSER) -> FitPoint:
        """The point after rounds of steps, as long as these approach the noise.

        Far from it a round may leave a share `closer` of the mean square at most. The
        best point is taken of those whose own integration error was measured.
        """
        best = now
        for _ in range(MOST_SEEN):
            before = _mean_square(now.left)
            now = self._descended(now)
            if _is_far_off(now.left) and _mean_square(now.left) > closer * before:
                break
            self.correct(self._beside(now.errors, now.x))
            now = self._at(now)
            if now.is_near:
                now = self._descended(now)
                break
            best = min(best, now, key=lambda point: point.goal)
            now = self._linear(now)
        return min(now, best, key=lambda point: point.goal)

    def moved(self, start: Nuisance) -> Nuisance:
        """The likeliest errors by what they changed where another fit ended."""
        now = self._begun(start)
        if now.errors.seen_at is None:
            now = self._linear(now)
        return self._descended(now).corrected

    def seen(self, errors: Nuisance) -> Nuisance:
        """Given errors, with what they change in these residuals."""
        return self._linear(self._placed(errors, np.zeros(0))).errors

    def _coordinates(self, start: Nuisance) -> Coordinates:
        return Coordinates(start.plant, self.model)

    def _begun(self, start: Nuisance) -> FitPoint:
        """Errors only where the model has no effects."""
        sizes = np.where(start.free_of(self._keys), start.sizes, 0.0)
        return self._placed(start.at(sizes), np.zeros(0))

    def _placed(self, errors: Nuisance, x: FloatArray) -> FitPoint:
        """A point whose changes by the (p,) values were not simulated."""
        (left,) = self.ask([self._beside(errors, x)])
        return FitPoint.of(errors, x, left)

    def _at(self, now: FitPoint) -> FitPoint:
        """The point with the residual there, after another error is taken out."""
        return replace(now, left=self.ask([self._beside(now.errors, now.x)])[0])

    def _descended(self, now: FitPoint, share: float = ENOUGH) -> FitPoint:
        """The point after steps as long as these help, by a `share` of the energy."""
        for _ in range(MOST_STEPS):
            other = self._step(now)
            # >=: of a simulation that blew up, two nats less is the same number
            if other.goal >= now.goal - max(share * now.goal, 2 * ENOUGH_NATS):
                break
            now = now.followed(other)
        return now

    def _step(self, now: FitPoint) -> FitPoint:
        """The best point on the way to the likeliest one."""
        other = self._best(now, TRIED)
        return other if other is not now else self._best(now, LAST_TRIED)

    def _best(self, now: FitPoint, tried: Sequence[tuple[float, float]]) -> FitPoint:
        """The best of `now` and where steps by shares and dampings lead."""
        errors, k = now.errors, len(now.errors.units)
        low, high = errors.bounds()
        free = errors.free_of(self._keys)
        sizes = errors.sizes
        if len(now.x):
            ends = self._coordinates(errors).bounds()
            far = [np.clip(end - now.x, -1, 1) / FLAT for end in ends]
            low, high = np.append(low, far[0]), np.append(high, far[1])
            free = np.append(free, np.ones(len(now.x), bool))
            sizes = np.append(sizes, np.zeros(len(now.x)))  # what is unknown stays
        known = *now.products(FLAT), sizes, free, low, high
        wanted = {damping: likeliest(*known, damping) for _, damping in tried}
        steps = [
            (errors.at(one[:k]), now.x + FLAT * one[k:])
            for share, damping in tried
            for one in [sizes + share * (wanted[damping] - sizes)]
        ]
        others = self.ask([self._beside(*one) for one in steps])
        points = [
            replace(now, errors=one, x=x, left=left)
            for (one, x), left in zip(steps, others, strict=True)
        ]
        return min([now, *points], key=lambda point: point.goal)

    def _linear(self, now: FitPoint) -> FitPoint:
        """The point, with what errors and values change there."""
        return self._sloped(now.simulated(self._changing(now), now.slopes, now.seen_x))

    def _sloped(self, now: FitPoint) -> FitPoint:
        """The point, with what values of the model change there."""
        if not len(now.x):
            return now
        high = self._coordinates(now.errors).bounds()[1]
        far = np.where(now.x + NUDGE_X <= high, NUDGE_X, -NUDGE_X)
        others = self.ask([self._beside(now.errors, x) for x in now.x + np.diag(far)])
        slopes = (others - now.left) / far[:, None]
        return now.simulated(now.errors, slopes, now.x)

    def _changing(self, now: FitPoint) -> Nuisance:
        """The errors, with what one standard deviation of each would change."""
        errors = now.errors
        tried, sizes = list[Model](), np.empty(len(errors.units))
        for i, unit in enumerate(errors.units):
            taken = unit.key in self._keys
            sizes[i] = 1.0 if taken else NUDGE
            more = sizes[i] * (np.arange(len(errors.units)) == i)
            own = errors if taken else errors.at(errors.sizes + more)
            tried.append((*self._beside(own, now.x), *([unit] if taken else ())))
        changes = errors.changes
        if tried:
            seen = self.ask(tried)  # in place, for memory
            seen -= now.left
            seen /= sizes[:, None]
            changes = Changes.of(seen)
        return replace(errors, changes=changes, seen_at=(errors.sizes, self._keys))

    def _centred(self, now: FitPoint) -> FitPoint:
        """The point, with what errors and values change there to both sides."""
        errors, k, p = now.errors, len(now.errors.units), len(now.x)
        ends = zip(errors.bounds(), self._coordinates(errors).bounds(), strict=True)
        low, high = (np.concatenate(both) for both in ends)
        far = np.append(np.full(k, WIDE), np.full(p, NUDGE_X))
        at = np.append(errors.sizes, now.x)
        middle = np.clip(at, low + far, high - far)
        free = np.append(errors.free_of(self._keys), np.ones(p, bool))
        found = np.zeros((k + p, len(now.left)))
        for some in np.split(np.arange(k + p), range(AT_ONCE, k + p, AT_ONCE)):
            own, tried = some[free[some]], list[Model]()
            for i in own:
                for side in (-1, 1):
                    there = np.where(np.arange(k + p) == i, middle + side * far, at)
                    tried.append(self._beside(errors.at(there[:k]), there[k:]))
            if tried:
                seen = self.ask(tried)
                found[own] = (seen[1::2] - seen[::2]) / (2 * far[own, None])
        if not free.all():
            found[~free] = self._alone(now, ~free[:k]) - now.left
        seen_at = errors.sizes, self._keys
        errors = replace(errors, changes=Changes.of(found[:k]), seen_at=seen_at)
        return now.simulated(errors, found[k:], now.x)

    def _alone(self, now: FitPoint, taken: BoolArray) -> FloatArray:
        """(m, N) residuals with one standard deviation of each error that is `taken`.

        These are at places of the model's effects.
        """
        units = [now.errors.units[i] for i in np.flatnonzero(taken)]
        beside = self._beside(now.errors, now.x)
        return self.ask([(*beside, unit) for unit in units])

    def _beside(self, errors: Nuisance, x: FloatArray) -> Model:
        """The model, with other values if any, and errors where it has none."""
        model = self._coordinates(errors).model_at(x) if len(x) else self.model
        return (*errors.beside(self._keys), *model)

    def _was_seen(self, errors: Nuisance) -> bool:
        """Whether changes were simulated beside a model with such effects."""
        return errors.seen_at is not None and errors.seen_at[1] == self._keys

    @property
    def _keys(self) -> frozenset[str]:
        return keys_within(self.model)


def _is_far_off(left: FloatArray) -> bool:
    """Whether a residual (N,) is more than twice the noise."""
    return _mean_square(left) >= MORE_THAN_NOISE**2


def _mean_square(left: FloatArray) -> float:
    """Mean square of the entries of a residual (N,) that count; others are 0."""
    return float(left @ left) / max(int(np.count_nonzero(left)), 1)

"""Tells which effects are not new: the healthy robot had them, too.

Old effects may be too faint to be found in the recordings of the healthy robot alone,
and come out where the diagnosed recordings tell more of them. But they are no change. A
model is therefore fitted to both. Two questions follow for its effects, as they stand
together, since what one of them explains another one may explain as well:

- Which must have changed? Values that fit the diagnosed and the healthy robot differ,
  and as few effects as possible are to make up for the difference.
- Which of the others did the healthy robot have? Those without which it is explained
  worse.

Both are answered to first order (Wald 1943, "Tests of statistical hypotheses concerning
several parameters when the number of observations is large"), an effect at a time, the
one first that makes up for most.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.conclude.block_errors import PRIOR_SPREAD
from diagnosis.conclude.estimates import standard_errors
from diagnosis.effects.library import effect, lasts
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.judging import Judge, gain_of_noise
from diagnosis.search.result import SearchResult
from groundwalk.arrays import FloatArray


def old_effects(judge: Judge, result: SearchResult) -> Model:
    """The effects that a search found, but that the healthy robot had as well.

    With the values that they have there. None on a floating base or without recordings
    of the healthy robot. What does not last is always new.
    """
    if result.winner is None or not judge.healthy or judge.fit.plant.base != "fixed":
        return ()
    (healthy,) = judge.healthy
    traces = [*judge.fit.traces, *healthy.traces]
    lasting = tuple(one for one in result.winner.model if lasts(one, traces))
    if not lasting:
        return ()
    own, now = _fitted(judge.fit, result.winner.model)
    healthy, then = _fitted(healthy, _fitted(healthy, lasting)[1].model)
    groups = groups_of(then.model)
    columns = [_size_columns(then.coordinates, group) for group in groups]
    before = Values.of(healthy, then)
    after = Values.of(own, now).part(now.coordinates.columns_of(lasting))
    changed = after.less(before).far_off(columns)
    same = [group for i, group in enumerate(groups) if i not in changed]
    return tuple(one for group in _had(healthy, then, same) for one in group)


def _fitted(predictor: Predictor, model: Model) -> tuple[Predictor, FittedModel]:
    """A model fitted where its integration error is taken out, and the predictor."""
    own = predictor.part(0, len(predictor.traces))
    own.correct(model)
    return own, fit_all(own, [model])[0]


def without(judge: Judge, result: SearchResult, old: Model) -> SearchResult:
    """The result of a search without some effects, the others fitted again."""
    if result.winner is None:
        return result
    gone = {one.key for one in old}
    less = tuple(one for one in result.winner.model if one.key not in gone)
    if len(less) == len(result.winner.model):
        return result
    if less:
        result = result.with_models(len(less), judge.judged([less]))
    return replace(result, chosen=len(less))


@dataclass(frozen=True, eq=False)
class Values:
    """(p,) values in scaled coordinates, with the (p, p) covariance of their errors."""

    values: FloatArray
    covariance: FloatArray

    @classmethod
    def of(cls, predictor: Predictor, fit: FittedModel) -> "Values":
        """The values of a fit, with their errors as large as what it leaves says."""
        information = fit.jacobian.T @ fit.jacobian
        held = np.eye(len(information)) / PRIOR_SPREAD**2
        white = np.linalg.inv(information + held)
        wider = standard_errors(predictor, fit) / np.sqrt(np.diag(white))
        return cls(fit.coordinates.of(fit.model), wider[:, None] * white * wider)

    def part(self, columns: Sequence[int]) -> "Values":
        """Some of the values, whatever the others are."""
        own = list(columns)
        return Values(self.values[own], self.covariance[np.ix_(own, own)])

    def less(self, other: "Values") -> "Values":
        """The difference to other values, whose errors are independent."""
        return Values(self.values - other.values, self.covariance + other.covariance)

    def away_from(self, values: FloatArray) -> "Values":
        """The difference to (p,) values that are known exactly."""
        return replace(self, values=self.values - values)

    def far_off(self, groups: Sequence[Sequence[int]]) -> list[int]:
        """Numbers of the groups of values that cannot all be zero, given as columns.

        One group after the other is let free, the one first without which zero fits the
        others best, as long as that gains more than the best does by chance.
        """
        free: list[int] = []
        while len(free) < len(groups):
            held = {i: [*groups[i]] for i in range(len(groups)) if i not in free}
            loss = self._loss([column for own in held.values() for column in own])
            over = {
                i: loss
                - self._loss([c for k, own in held.items() if k != i for c in own])
                - gain_of_noise(len(groups), len(held[i]))
                for i in held
            }
            best = max(over, key=lambda i: over[i])
            if over[best] <= 0:
                break
            free.append(best)
        return free

    def _loss(self, columns: Sequence[int]) -> float:
        """Energy [nats] at which some values are zero, whatever the others are."""
        if not columns:
            return 0.0
        some = self.part(columns)
        return 0.5 * float(some.values @ np.linalg.solve(some.covariance, some.values))


def _had(healthy: Predictor, then: FittedModel, groups: Sequence[Model]) -> list[Model]:
    """Those of some effects without which the healthy robot is explained worse.

    `then` is the fit to its recordings. What only an infinite value switches off is
    taken out, and the others are fitted again.
    """
    coordinates, known = then.coordinates, Values.of(healthy, then)
    columns = [_size_columns(coordinates, group) for group in groups]
    neutral = np.array(
        [
            coordinates.scaled(i, one.neutral) if np.isfinite(one.neutral) else np.inf
            for i, one in enumerate(coordinates.parameters)
        ]
    )
    finite = [bool(np.isfinite(neutral[own]).all()) for own in columns]
    away = known.away_from(np.where(np.isfinite(neutral), neutral, known.values))
    some = [i for i, one in enumerate(finite) if one]
    had = {some[k] for k in away.far_off([columns[i] for i in some])}
    for i in set(range(len(groups))) - set(some):
        keys = {one.key for one in groups[i]}
        less = tuple(one for one in then.model if one.key not in keys)
        loss = _fitted(healthy, less)[1].energy - then.energy
        scale = max(then.energy / healthy.noise_energy, 1.0)
        if loss / scale > gain_of_noise(len(groups)):
            had.add(i)
    return [groups[i] for i in sorted(had)]


def _size_columns(coordinates: Coordinates, group: Model) -> list[int]:
    """Columns of those values of an effect, or of tied ones, that are zero without it.

    The others, such as the rest angle of a spring, say nothing where it is absent.
    """
    return coordinates.columns_of(group)[: max(effect(group[0].name).components, 1)]

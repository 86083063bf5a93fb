"""What a fit would lose with fewer values, by linear estimates.

A model has fewer values without an effect, or where effects of a kind share them. Both
are linear constraints of its values; how much worse the fit gets with these, all other
values being fitted again, follows from its Jacobian (Wald 1943, "Tests of statistical
hypotheses concerning several parameters").
"""

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.ties import groups_of, motors
from diagnosis.search.fitting import FittedModel
from groundwalk.arrays import FloatArray

NUDGE = 1e-4
"""Step of a scaled coordinate, of order one, by which its scale is compared with that
of another joint."""


class Losses:
    """Energies [nats] by which a fit gets worse with fewer values."""

    def __init__(self, fit: FittedModel) -> None:
        """Prepare the estimates for a fit."""
        self._fit, self._of = fit, fit.coordinates
        self._x = self._of.of(fit.model)
        products = fit.jacobian.T @ fit.jacobian
        self._spread = np.linalg.pinv(products, hermitian=True)

    def without_each(self) -> Iterator[tuple[Model, float]]:
        """Each group of effects that share their values, and what it explains.

        Infinite where no finite value stands for no effect.
        """
        for group in groups_of(self._fit.model):
            own = self._of.columns_of(group)
            own = own[: max(effect(group[0].name).components, 1)]
            neutral = [self._of.parameters[i].neutral for i in own]
            if not np.isfinite(neutral).all():
                yield group, np.inf
                continue
            away = [
                self._x[i] - self._of.scaled(i, value)
                for i, value in zip(own, neutral, strict=True)
            ]
            yield group, self._of_constraint(np.eye(len(self._x))[own], away)

    def sharing(self, plant: Plant) -> Iterator[tuple[Model, float]]:
        """Pairs of groups that may share their values, and what is lost by that.

        That is, effects of one kind at joints with the same motor, or at bodies, which
        are not timed. They have the mean of their values.
        """
        kinds = motors(plant)
        groups = groups_of(self._fit.model)
        lasting = [one for one in groups if not effect(one[0].name).timed]
        for one, other in itertools.combinations(lasting, 2):
            both = (*one, *other)
            alike = {(placed.name, kinds.get(placed.place)) for placed in both}
            if len(alike) == 1:
                every = zip(*(placed.values for placed in both), strict=True)
                mean = tuple(float(np.mean(values)) for values in every)
                label = min(placed.place for placed in both)
                shared = tuple(replace(p, values=mean, tied=label) for p in both)
                yield shared, self._apart(one, other)

    def _apart(self, one: Model, other: Model) -> float:
        """What two groups with different values gain by these."""
        columns = zip(*map(self._of.columns_of, (one, other)), strict=True)
        constraint, away = [], []
        for i, j in columns:
            moved = self._x + NUDGE * (np.arange(len(self._x)) == j)
            every = [self._of.values_at(x)[j] for x in (self._x, moved)]
            seen = [self._of.scaled(i, value) for value in every]
            row = np.zeros(len(self._x))
            row[i], row[j] = 1.0, (seen[0] - seen[1]) / NUDGE
            constraint.append(row)
            away.append(self._x[i] - seen[0])
        return self._of_constraint(np.array(constraint), away)

    def _of_constraint(self, constraint: FloatArray, away: list[float]) -> float:
        """The loss where products of (m, p) rows with the values change by (m,)."""
        part = np.linalg.pinv(constraint @ self._spread @ constraint.T, hermitian=True)
        return 0.5 * float(np.array(away) @ part @ np.array(away))

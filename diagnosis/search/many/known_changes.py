"""Jacobians at the start of fits, from what a search already knows, without replays."""

from collections.abc import Mapping, Sequence

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import Signature
from diagnosis.search.fitting import FittedModel
from groundwalk.arrays import FloatArray


class KnownChanges:
    """What values of a fitted model, and further effects, change in the residual."""

    def __init__(
        self, fit: Predictor, best: FittedModel, found: Sequence[Signature]
    ) -> None:
        """Use the Jacobian of a fit, and signatures of effects beside its own."""
        self._fit, self._best = fit, best
        self._own = dict(
            zip(
                (one.key for one in best.model),
                zip(best.model, best.coordinates.columns, strict=True),
                strict=True,
            )
        )
        self._found: Mapping[str, Signature] = {
            one.placed.key: one for one in reversed(found)
        }

    def jacobian(self, start: Model) -> FloatArray | None:
        """(N, p) Jacobian of a model that has the fitted effects and others beside.

        None if it has effects of several values that were not fitted: a signature
        shows what one value changes.
        """
        coordinates = Coordinates(self._fit.plant, start)
        columns = np.zeros((len(self._best.residual), len(coordinates.parameters)))
        done = set[int]()
        for placed, own in zip(start, coordinates.columns, strict=True):
            known = self._known(placed) if placed.key in self._own else None
            if known is not None:
                if not done & set(own):
                    columns[:, own] = known
                    done |= set(own)
                continue
            change = self._new(placed, coordinates, own)
            if change is None:
                return None
            columns[:, own[0]] += change
        return columns

    def _known(self, placed: PlacedEffect) -> FloatArray | None:
        """(N, values) columns of an effect of the fitted model."""
        before, columns = self._own[placed.key]
        known = self._best.jacobian[:, columns]
        if before.tied == placed.tied:
            return known
        if not effect(placed.name).joint_by_joint:
            return None
        mine = self._fit.channels.of_joint(placed.place)
        return np.where(np.isin(self._fit.channel, mine)[:, None], known, 0.0)

    def _new(
        self, placed: PlacedEffect, coordinates: Coordinates, own: Sequence[int]
    ) -> FloatArray | None:
        """(N,) column of a further effect with one value; None if it has more."""
        signature = self._found.get(placed.key)
        if signature is None or len(own) > 1:
            return None
        (column,) = own
        neutral = coordinates.parameters[column].neutral
        if not np.isfinite(neutral):
            return None
        size = coordinates.scaled(column, signature.placed.values[0])
        size -= coordinates.scaled(column, neutral)
        change = np.zeros(len(self._best.residual))
        change[signature.rows] = signature.change / size
        return change

"""All measures of a grounding's forward model, before a policy is trained with it."""

import json
import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.measures import (
    Advance,
    autocorrelation,
    coverage,
    cross_correlation,
    excess_kurtosis,
    multi_step_error,
    r_squared,
    root_mean_square,
)
from sgat.models.forward_model import ForwardModel
from sgat.transitions import Transitions

LEVELS = (0.5, 0.8, 0.9, 0.95, 0.99)
"""Probabilities of the central intervals in which residuals are counted."""
LAGS = 10
"""Largest lag [ticks] at which the autocorrelation of residuals is measured."""
HORIZON = 10
"""Ticks for which a model predicts from its own predictions, without measurements."""


@dataclass(frozen=True, eq=False)
class GroundingReport:
    """How well a grounding's forward model predicts the next states of the real world.

    Measured on real transitions that the model was not fitted to; p is the number of
    columns of a next state.

    Attributes:
      one_step_error: (p,) root mean square error, in the state's units.
      one_step_r_squared: (p,) share of the variance of the state's change that is
        predicted.
      multi_step_error: (horizon, p) root mean square error 1, 2 ... ticks ahead, if the
        model predicts from its own predictions, in the state's units.
      log_likelihood: mean log-likelihood per transition and column.
      levels: (levels,) probabilities of central intervals of the normal distribution.
      coverage: (levels, p) share of the standardised residuals within each interval.
      autocorrelation: (lags, p) of the residuals, at lags of 1, 2 ... ticks.
      cross_correlation: (p, p) of the residuals at the same tick.
      excess_kurtosis: (p,) kurtosis of the residuals minus 3; 0 if they are normal.

    Example:
      >>> report = GroundingReport.of(forward, held_out, forward.predict)
      >>> print(report.to_json())
    """

    one_step_error: FloatArray
    one_step_r_squared: FloatArray
    multi_step_error: FloatArray
    log_likelihood: float
    levels: FloatArray
    coverage: FloatArray
    autocorrelation: FloatArray
    cross_correlation: FloatArray
    excess_kurtosis: FloatArray

    @classmethod
    def of(
        cls,
        forward: ForwardModel,
        held_out: Transitions,
        advance: Advance,
        horizon: int = HORIZON,
        lags: int = LAGS,
    ) -> Self:
        """Measure a forward model.

        Args:
          forward: model of the real world.
          held_out: transitions of the real world that the model was not fitted to.
          advance: predicts the whole state one tick later; `forward.predict` if a next
            state has all columns of a state.
          horizon: ticks that are predicted without measurements in between.
          lags: largest lag [ticks] of the autocorrelation.
        """
        residuals = forward.residuals(held_out)
        predicted = forward.predict(held_out.state, held_out.action)
        change = predicted - held_out.next_state + held_out.change
        return cls(
            one_step_error=root_mean_square(predicted - held_out.next_state),
            one_step_r_squared=r_squared(change, held_out.change),
            multi_step_error=multi_step_error(advance, held_out, horizon),
            log_likelihood=forward.score(held_out),
            levels=np.array(LEVELS),
            coverage=coverage(residuals, LEVELS),
            autocorrelation=autocorrelation(residuals, held_out.episode, lags),
            cross_correlation=cross_correlation(residuals),
            excess_kurtosis=excess_kurtosis(residuals),
        )

    def to_json(self) -> str:
        """All attributes as a JSON object; null where undefined or infinite."""
        return json.dumps(
            {name: _plain(value) for name, value in vars(self).items()}, allow_nan=False
        )


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if value is None or not math.isfinite(value) else value

"""All measures of a grounding's forward model, before a policy is trained with it."""

from typing import Any

import numpy as np

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
from sgat.models.transition_models import ForwardModel
from sgat.transitions import Transitions

LEVELS = (0.5, 0.8, 0.9, 0.95, 0.99)
"""Probabilities of the central intervals in which residuals are counted."""
LAGS = 10
"""Largest lag [ticks] at which the autocorrelation of residuals is measured."""
HORIZON = 10
"""Ticks for which a model predicts from its own predictions, without measurements."""


def grounding_report(
    forward: ForwardModel, held_out: Transitions, advance: Advance
) -> dict[str, Any]:
    """Measure how well a grounding's forward model predicts the real world.

    Args:
      forward: model of the real world.
      held_out: transitions of the real world that the model was not fitted to.
      advance: predicts the whole state one tick later; `forward.predict` if a next
        state has all columns of a state.

    Returns:
      Numbers and lists by name, None where undefined or infinite. Errors are in the
      state's units, p is the number of columns of a next state:

      - `one_step_error` (p,) and `multi_step_error` (HORIZON, p): root mean squares 1
        tick, and 1, 2 ... ticks ahead, if the model predicts from its own predictions;
      - `one_step_r_squared` (p,): share of the variance of the state's change that is
        predicted;
      - `log_likelihood`: mean per transition and column;
      - `levels` and `coverage` (levels, p): share of the standardised residuals within
        the normal distribution's central intervals;
      - `autocorrelation` (LAGS, p) of residuals, at lags of 1, 2 ... ticks;
        `cross_correlation` (p, p) at the same tick; `excess_kurtosis` (p,), 0 if they
        are normal.

    Example:
      >>> grounding_report(forward, held_out, forward.predict)["coverage"]
    """
    residuals = forward.residuals(held_out)
    predicted = forward.predict(held_out.state, held_out.action)
    change = predicted - held_out.next_state + held_out.change
    measures = {
        "one_step_error": root_mean_square(predicted - held_out.next_state),
        "one_step_r_squared": r_squared(change, held_out.change),
        "multi_step_error": multi_step_error(advance, held_out, HORIZON),
        "log_likelihood": forward.score(held_out),
        "levels": np.array(LEVELS),
        "coverage": coverage(residuals, LEVELS),
        "autocorrelation": autocorrelation(residuals, held_out.episode, LAGS),
        "cross_correlation": cross_correlation(residuals),
        "excess_kurtosis": excess_kurtosis(residuals),
    }
    arrays = {name: np.asarray(value) for name, value in measures.items()}
    return {
        name: np.where(np.isfinite(array), array, np.array(None)).tolist()
        for name, array in arrays.items()
    }

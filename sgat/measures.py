"""Measures of a grounding: functions on arrays, before any policy is trained in it.

Residuals are the standardised ones of `ForwardModel.residuals`, of transitions that the
model was not fitted to.
"""

from collections.abc import Callable, Sequence
from statistics import NormalDist

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.transitions import Transitions

Advance = Callable[[FloatArray, FloatArray], FloatArray]
"""A function of states (n, s) and actions (n, a) that gives the states (n, s) one
tick later."""


def root_mean_square(errors: FloatArray) -> FloatArray:
    """(d,) root mean square of errors (N, d), in their units."""
    return np.asarray(np.sqrt(np.mean(errors**2, axis=0)))


def r_squared(predicted: FloatArray, actual: FloatArray) -> FloatArray:
    """(d,) share of the variance of actual values (N, d) that is predicted.

    1 is perfect, 0 is no better than predicting the mean, NaN stands for constants.
    """
    error = np.mean((predicted - actual) ** 2, axis=0)
    return np.asarray(1 - error / _variance(actual))


def multi_step_error(
    advance: Advance, transitions: Transitions, horizon: int
) -> FloatArray:
    """(horizon, p) root mean square error of predictions 1, 2 ... ticks ahead.

    From every transition that has enough successors in its episode, the recorded
    actions are replayed and the predicted states are fed back.

    Args:
      advance: predicts a whole state; where a next state has all columns of a state,
        this can be `ForwardModel.predict`.
      transitions: recorded in the real world.
      horizon: ticks to predict.

    Raises:
      BadValueError: no episode is as long as the horizon.
    """
    episode = transitions.episode
    starts = np.arange(max(transitions.n - horizon + 1, 0))
    starts = starts[episode[starts] == episode[starts + horizon - 1]]
    if not len(starts):
        raise BadValueError(f"no episode is {horizon} ticks long")
    state, errors = transitions.state[starts], []
    for rows in starts + np.arange(horizon)[:, None]:
        state = advance(state, transitions.action[rows])
        predicted = state[:, : transitions.outcomes]
        errors.append(root_mean_square(predicted - transitions.next_state[rows]))
    return np.array(errors)


def coverage(residuals: FloatArray, levels: Sequence[float]) -> FloatArray:
    """(levels, d) share of the residuals within each central interval.

    The intervals are those of the standard normal distribution. Calibrated residuals
    lie within the interval of level 0.9 nine times in ten. An over-confident model's
    lie there less often; with heavy tails, this shows only at the high levels.

    Args:
      residuals: (N, d) standardised.
      levels: probabilities of the intervals, between 0 and 1.
    """
    bounds = [NormalDist().inv_cdf((1 + level) / 2) for level in levels]
    return np.array([(np.abs(residuals) <= bound).mean(axis=0) for bound in bounds])


def lagged_pairs(
    values: FloatArray, episode: IntArray, lag: int
) -> tuple[FloatArray, FloatArray]:
    """Rows (pairs, d) of values (N, d), and the rows `lag` ticks before them.

    Both rows of a pair belong to the same episode.

    Raises:
      BadValueError: no episode is longer than the lag.
    """
    same = episode[lag:] == episode[: len(episode) - lag]
    if not same.any():
        raise BadValueError(f"no episode is longer than {lag} ticks")
    return values[lag:][same], values[: len(values) - lag][same]


def autocorrelation(residuals: FloatArray, episode: IntArray, lags: int) -> FloatArray:
    """(lags, d) correlation of residuals (N, d) with those 1, 2 ... ticks before."""
    off = residuals - residuals.mean(axis=0)
    rows = []
    for lag in range(1, lags + 1):
        now, before = lagged_pairs(off, episode, lag)
        rows.append((now * before).mean(axis=0) / _variance(off))
    return np.array(rows)


def cross_correlation(residuals: FloatArray) -> FloatArray:
    """(d, d) correlation of residuals (N, d) at the same tick; NaN for constants."""
    off = residuals - residuals.mean(axis=0)
    spread = np.sqrt(_variance(off))
    return np.asarray(off.T @ off / len(off) / np.outer(spread, spread))


def excess_kurtosis(residuals: FloatArray) -> FloatArray:
    """(d,) kurtosis of residuals (N, d) minus 3: 0 is normal, above are heavy tails."""
    off = residuals - residuals.mean(axis=0)
    return np.asarray(np.mean(off**4, axis=0) / _variance(off) ** 2 - 3)


def _variance(values: FloatArray) -> FloatArray:
    """(d,) variance of values (N, d); exactly constant columns give NaN."""
    return np.where(np.ptp(values, axis=0) > 0, values.var(axis=0), np.nan)

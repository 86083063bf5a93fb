"""Functions on arrays that measure how well a model predicts a world's next states.

Residuals are differences between real and predicted next states, standardised by the
predicted distribution as in `ForwardModel.residuals`. Measures mean something only for
transitions that the model was not fitted to.
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
    """(d,) root mean square of each column of errors (N, d), in the column's unit."""
    return np.asarray(np.sqrt(np.mean(errors**2, axis=0)))


def r_squared(predicted: FloatArray, actual: FloatArray) -> FloatArray:
    """(d,) share of the variance of actual values (N, d) that is predicted.

    1 is perfect, 0 is no better than predicting the mean; NaN for constant columns.
    """
    error = np.mean((predicted - actual) ** 2, axis=0)
    return np.asarray(1 - error / _variance(actual))


def multi_step_error(
    advance: Advance, transitions: Transitions, horizon: int
) -> FloatArray:
    """(horizon, p) root mean square error of predictions 1 ... `horizon` ticks ahead.

    From every transition that has enough successors in its episode, the recorded
    actions are replayed and the predicted states are fed back. `advance` predicts a
    whole state; errors are of the p columns of a next state, in their units.

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
    """(levels, d) share of residuals within the standard normal's central intervals.

    Nine in ten residuals of a calibrated model lie within the interval of level 0.9,
    and fewer of an over-confident one. Heavy tails show only at the high levels.
    Residuals (N, d) are standardised; levels are probabilities between 0 and 1.
    """
    bounds = [NormalDist().inv_cdf((1 + level) / 2) for level in levels]
    return np.array([(np.abs(residuals) <= bound).mean(axis=0) for bound in bounds])


def autocorrelation(residuals: FloatArray, episode: IntArray, lags: int) -> FloatArray:
    """(lags, d) correlation of residuals (N, d) with those 1 ... `lags` ticks ago.

    Both are of the same episode, numbered by (N,); BadValueError if none is so long.
    """
    off = residuals - residuals.mean(axis=0)
    rows = []
    for lag in range(1, lags + 1):
        same = episode[lag:] == episode[:-lag]
        if not same.any():
            raise BadValueError(f"no episode is longer than {lag} ticks")
        now, before = off[lag:][same], off[:-lag][same]
        rows.append((now * before).mean(axis=0) / _variance(off))
    return np.array(rows)


def cross_correlation(residuals: FloatArray) -> FloatArray:
    """(d, d) correlation between the columns of residuals (N, d); NaN if constant."""
    off = residuals - residuals.mean(axis=0)
    spread = np.sqrt(_variance(off))
    return np.asarray(off.T @ off / len(off) / np.outer(spread, spread))


def excess_kurtosis(residuals: FloatArray) -> FloatArray:
    """(d,) kurtosis of residuals (N, d) minus 3: 0 if normal, more with heavy tails."""
    off = residuals - residuals.mean(axis=0)
    return np.asarray(np.mean(off**4, axis=0) / _variance(off) ** 2 - 3)


def _variance(values: FloatArray) -> FloatArray:
    """(d,) variance of values (N, d); exactly constant columns give NaN."""
    return np.where(np.ptp(values, axis=0) > 0, values.var(axis=0), np.nan)

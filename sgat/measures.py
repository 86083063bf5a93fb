"""How good a grounding is, before any policy is trained in it.

Pure functions on arrays: residuals are standardised ones, `ForwardModel.residuals`, of
transitions that the model was not fitted to.
"""

from collections.abc import Callable, Sequence
from statistics import NormalDist

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.transitions import Transitions

Advance = Callable[[FloatArray, FloatArray], FloatArray]
"""States (n, s) and actions (n, a) to the states one tick later (n, s)."""


def root_mean_square(errors: FloatArray) -> FloatArray:
    """(d,) of errors (N, d)."""
    return np.asarray(np.sqrt(np.mean(errors**2, axis=0)))


def r_squared(predicted: FloatArray, actual: FloatArray) -> FloatArray:
    """(d,) share of the variance of the (N, d) actual values that is predicted.

    1 is perfect, 0 no better than the mean, NaN where nothing varies.
    """
    error = np.mean((predicted - actual) ** 2, axis=0)
    return np.asarray(1 - error / _variance(actual))


def multi_step_error(
    advance: Advance, transitions: Transitions, horizon: int
) -> FloatArray:
    """(horizon, p) root mean square error after 1, 2 ... ticks without correction.

    From every transition that has enough successors in its episode, the recorded
    actions are replayed and the predicted states fed back.

    Args:
      advance: predicts a whole state; where a next state is as wide as a state this
        can be `ForwardModel.predict` itself.
      transitions: what really happened.
      horizon: ticks.
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
    """(levels, d) share of the residuals within each central normal interval.

    Calibrated residuals are within the interval of level 0.9 nine times in ten; an
    over-confident model's are less often, but with heavy tails that shows only at
    the high levels.
    """
    bounds = [NormalDist().inv_cdf((1 + level) / 2) for level in levels]
    return np.array([(np.abs(residuals) <= bound).mean(axis=0) for bound in bounds])


def lagged_pairs(
    values: FloatArray, episode: IntArray, lag: int
) -> tuple[FloatArray, FloatArray]:
    """Rows of (N, d) values, and those `lag` ticks before them in the same episode."""
    same = episode[lag:] == episode[: len(episode) - lag]
    if not same.any():
        raise BadValueError(f"no episode is longer than {lag} ticks")
    return values[lag:][same], values[: len(values) - lag][same]


def autocorrelation(residuals: FloatArray, episode: IntArray, lags: int) -> FloatArray:
    """(lags, d) correlation with the residual 1, 2 ... ticks before; 0 is white."""
    off = residuals - residuals.mean(axis=0)
    rows = []
    for lag in range(1, lags + 1):
        now, before = lagged_pairs(off, episode, lag)
        rows.append((now * before).mean(axis=0) / _variance(off))
    return np.array(rows)


def cross_correlation(residuals: FloatArray) -> FloatArray:
    """(d, d) correlation between dimensions at the same tick; NaN where constant."""
    off = residuals - residuals.mean(axis=0)
    spread = np.sqrt(_variance(off))
    return np.asarray(off.T @ off / len(off) / np.outer(spread, spread))


def excess_kurtosis(residuals: FloatArray) -> FloatArray:
    """(d,) fourth moment over squared variance, less 3: 0 is normal, above heavy."""
    off = residuals - residuals.mean(axis=0)
    return np.asarray(np.mean(off**4, axis=0) / _variance(off) ** 2 - 3)


def _variance(values: FloatArray) -> FloatArray:
    """(d,) of (N, d) values; NaN where they are constant, whatever rounding says."""
    return np.where(np.ptp(values, axis=0) > 0, values.var(axis=0), np.nan)

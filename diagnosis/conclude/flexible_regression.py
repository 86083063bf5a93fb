"""A flexible regression without physics, which shows how much error is predictable.

If it removes more of the nominal sim's error than the effects found do, then the error
has structure that no known effect has (model discrepancy, Kennedy and O'Hagan 2001).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from diagnosis.residuals.predictor import WORST, Predictor
from diagnosis.traces.trace import filled
from groundwalk.arrays import BoolArray, FloatArray

FEATURES = 150
"""Number of random cosines of the inputs that serve as features of the regression."""

FINE = 3.0
"""Standard deviation of the random frequencies of cosines of a single input [radians
per standard deviation of the input]."""

LAGS = (0, 1, 3, 6, 12)
"""Delays [rows] at which the regression sees each input."""

FEWEST = 200
"""Fewest rows from which a regression is learned; with fewer it predicts 0."""

PENALTIES = (1.0, 10.0, 100.0, 1000.0)
"""Penalties of the ridge regression that are tried."""


def flexible_regression_errors(
    learn: Predictor, judge: Predictor, seed: np.random.SeedSequence
) -> FloatArray:
    """(c,) rms, in units of noise, of the error that a regression leaves per channel.

    For each channel a ridge regression predicts the nominal sim's error from random
    Fourier features (Rahimi and Recht 2007) of simulated motion, commands and time. Its
    penalty is chosen on a quarter of the rows, in blocks of 50. Both predictors have
    the same channels; the regression learns from the first one's data.
    """
    rng = np.random.default_rng(seed)
    known, wrong, seen = _data(learn)
    asked, left, scored = _data(judge)
    errors, c = [], len(learn.channels.names)
    for channel in range(c):
        column = channel % len(learn.plant.joints)
        inputs = _inputs(known, column, c)
        lift = _Lift(inputs, rng)
        rows, used = seen[:, channel], scored[:, channel]
        model = _ridge(lift(inputs)[rows], wrong[rows, channel])
        rest = left[:, channel] - lift(_inputs(asked, column, c)) @ model
        errors.append(np.sqrt(np.mean(rest[used] ** 2)) if used.any() else 0.0)
    return np.array(errors)


class _Lift:
    """Computes a regression's features: scaled inputs, random cosines, a constant.

    Half of the cosines are smooth functions of all inputs. The others have higher
    frequencies and a single input each, as the cogging of a motor has.
    """

    def __init__(self, inputs: FloatArray, rng: np.random.Generator) -> None:
        width = inputs.shape[1]
        self._middle, self._scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-9
        self._weight = rng.normal(0, 1 / np.sqrt(width), (width, FEATURES))
        own = rng.integers(0, width, FEATURES // 2)
        columns = np.arange(len(own))
        self._weight[:, columns] = 0.0
        self._weight[own, columns] = rng.normal(0, FINE, len(own))
        self._phase = rng.uniform(0, 2 * np.pi, FEATURES)

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """(rows, features) features of (rows, inputs) inputs."""
        z = (inputs - self._middle) / self._scale
        cosines = np.cos(z @ self._weight + self._phase)
        return np.hstack([z, cosines, np.ones((len(z), 1))])


def _ridge(features: FloatArray, wanted: FloatArray) -> FloatArray:
    """(features,) coefficients of the best ridge regression; 0 with too few rows."""
    if len(wanted) < FEWEST:
        return np.zeros(features.shape[1])
    held = np.arange(len(wanted)) // 50 % 4 == 3

    def error(penalty: float) -> float:
        model = _solved(features[~held], wanted[~held], penalty)
        return float(np.mean((wanted[held] - features[held] @ model) ** 2))

    return _solved(features, wanted, min(PENALTIES, key=error))


def _solved(features: FloatArray, wanted: FloatArray, penalty: float) -> FloatArray:
    """(features,) coefficients of a ridge regression with a given penalty."""
    gram = features.T @ features + penalty * np.eye(features.shape[1])
    return np.asarray(np.linalg.solve(gram, features.T @ wanted))


class _Seen(NamedTuple):
    """What a regression sees of a recording.

    `values` (T, c + j + 1) are simulated channels, commands and time; errors are known
    of each row whose number is a multiple of `every`.
    """

    values: FloatArray
    every: int


def _data(predictor: Predictor) -> tuple[list[_Seen], FloatArray, BoolArray]:
    """What is seen of each recording, its errors, and whether each counts.

    Where torques are compared, positions and velocities take the place of simulated
    channels and commands. The (rows, c) errors are those of the nominal sim, in units
    of noise. Simulations that diverge are cut off, so that all values are finite.
    """
    c = len(predictor.channels.names)
    nominal = np.nan_to_num(np.clip(predictor.predict([()])[0], -WORST, WORST))
    wrong = predictor.residuals([()])[0].reshape(-1, c)
    scored = predictor.scored.reshape(-1, c)
    found, first = [], 0
    for trace in predictor.traces:
        rows = predictor.seen_rows(trace)
        time_s = (trace.time_s[rows] - trace.time_s[0])[:, None]
        sim = nominal[first : first + len(time_s)]
        first += len(time_s)
        command = sim[:, : trace.position_rad.shape[1]]
        if trace.motion is not None:
            sim, command = trace.motion.position_rad, trace.motion.velocity_rad_s
        elif trace.command_rad is not None:
            command = filled(trace.command_rad)[rows]
        every = trace.compared.step // (rows.step or 1)
        found.append(_Seen(np.hstack([sim, command, time_s]), every))
    return found, wrong, scored


def _inputs(seen: Sequence[_Seen], column: int, c: int) -> FloatArray:
    """(rows, inputs) inputs of the regression for one joint, in rows with errors.

    They are simulated and commanded positions now and some rows before, speed and its
    sign, and time.
    """
    parts = []
    for values, every in seen:
        own = values[:, [column, c + column]]
        lagged = [
            np.vstack([own[:1].repeat(lag, axis=0), own[: len(own) - lag]])
            for lag in LAGS
        ]
        speed = np.gradient(own[:, :1], axis=0)
        every_row = np.hstack([*lagged, speed, np.sign(speed), values[:, -1:]])
        parts.append(every_row[::every])
    return np.vstack(parts)

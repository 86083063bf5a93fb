"""The mismatch map: the nominal sim's error by channel and by kind of motion."""

from collections.abc import Mapping

import numpy as np

from diagnosis.residuals.bursts import bursts
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.smoothing import moving_mean
from diagnosis.verdict import MismatchCell
from groundwalk.arrays import BoolArray, FloatArray

FAST, SLOW = 0.7, 0.2
"""Shares of a joint's top speed (its 95 % quantile) above which motion counts as fast
and below which it counts as slow."""

REVERSAL_S = 0.1
"""Length [s] of the interval around each change of direction whose rows count as
"reversals" in the map of errors."""

FEWEST = 20
"""Fewest rows from which the error in a kind of motion is computed."""


def mismatch_map(
    predictor: Predictor, residual: FloatArray
) -> tuple[MismatchCell, ...]:
    """The nominal sim's error, one cell for each channel, the largest share first.

    `residual` (N,) is that of the nominal sim, in units of noise.
    """
    energy = np.zeros(len(predictor.channels.names))
    np.add.at(energy, predictor.channel, residual**2 - predictor.scored)
    energy = np.maximum(energy, 0.0)
    total = max(float(energy.sum()), 1e-12)
    shares = [float(each) / total for each in energy]
    cells = [_cell(predictor, residual, i, share) for i, share in enumerate(shares)]
    return tuple(sorted(cells, key=lambda cell: -cell.share))


def _cell(
    predictor: Predictor, residual: FloatArray, index: int, share: float
) -> MismatchCell:
    """The error of the channel with this index; `share` is its share of all error."""
    channels = predictor.channels
    name, noise = channels.names[index], float(channels.noise[index])
    rows = predictor.channel == index
    own, scored = residual[rows], predictor.scored[rows]
    rms = float(np.sqrt(np.mean(own[scored] ** 2))) if scored.any() else 0.0
    return MismatchCell(
        channel=name,
        unit=channel_unit(predictor.plant, name),
        share=share,
        error_rms=rms * noise,
        noise_rms=noise,
        regimes=_regimes(predictor, index, own, scored),
        bursts=tuple(sorted(bursts(predictor, residual, index))),
    )


def _regimes(
    predictor: Predictor, index: int, own: FloatArray, scored: BoolArray
) -> Mapping[str, float]:
    """Rms error [noise] by kind of motion, such as "fast"; {} unless a position."""
    if index >= len(predictor.plant.joints):
        return {}
    flags = [_flags(t.time_s, t.position_rad[:, index]) for t in predictor.traces]
    found = {}
    for name in flags[0] if all(flags) else ():
        rows = np.concatenate([each[name] for each in flags]) & scored
        if rows.sum() >= FEWEST:
            found[name] = float(np.sqrt(np.mean(own[rows] ** 2)))
    return found


def _flags(time_s: FloatArray, position_rad: FloatArray) -> dict[str, BoolArray]:
    """For each kind of motion the (T,) rows of a recording that belong to it."""
    seen = np.isfinite(position_rad)
    if not seen.any():
        return {}
    filled = np.interp(time_s, time_s[seen], position_rad[seen])
    tick_s = float(np.median(np.diff(time_s)))
    smooth = moving_mean(filled, max(round(0.05 / tick_s), 1))
    velocity = np.gradient(smooth, time_s)
    speed = np.abs(velocity)
    top = float(np.quantile(speed, 0.95))
    turn = np.concatenate([[False], np.diff(np.sign(velocity)) != 0])
    near = np.convolve(turn, np.ones(max(int(REVERSAL_S / tick_s), 1)), mode="same") > 0
    third = (time_s[-1] - time_s[0]) / 3
    return {
        "forward": velocity > SLOW * top,
        "backward": velocity < -SLOW * top,
        "fast": speed > FAST * top,
        "slow": speed < SLOW * top,
        "reversals": near & (top > 0),
        "first third": time_s < time_s[0] + third,
        "last third": time_s > time_s[-1] - third,
        "high positions": filled > np.quantile(filled, 0.8),
        "low positions": filled < np.quantile(filled, 0.2),
    }

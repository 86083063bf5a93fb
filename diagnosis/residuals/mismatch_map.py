"""Where the nominal sim errs, and the shape of an error that no effect explains."""

from collections.abc import Mapping

import numpy as np

from diagnosis.residuals.bursts import bursts
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.smoothing import moving_mean
from diagnosis.verdict import MismatchCell, Unexplained
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

    `residual` (N,) is that of the nominal sim, in units of noise. Errors are compared
    with the noise floors.
    """
    channels = predictor.channels
    residual = residual * (channels.noise / channels.floor)[predictor.channel]
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
    """The error of the channel with this index; `share` is its share of all error.

    `residual` (N,) is in units of the noise floor.
    """
    channels = predictor.channels
    name, noise = channels.names[index], float(channels.floor[index])
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
        every = zip(flags, predictor.traces, strict=True)
        rows = np.concatenate([each[name][t.compared] for each, t in every]) & scored
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


BINS = 16
"""Number of bins, and so of points, of a curve of mean errors."""

FEWEST_IN_BIN = 10
"""Fewest rows in a bin of the curve; bins with fewer are left out."""


def unexplained(
    predictor: Predictor, residual: FloatArray, share: float
) -> Unexplained | None:
    """The mean error of the worst joint over one quantity; None if no row counts.

    The quantity is the one of the joint's position, velocity and command and of time
    over which the mean error is most significant. `residual` (N,) is that of the best
    model, in units of noise; it leaves `share` of the squared error above the noise.
    The worst joint is that which is off by most noise floors.
    """
    channels = predictor.channels
    residual = residual * (channels.noise / channels.floor)[predictor.channel]
    energy = np.zeros(len(predictor.channels.names))
    np.add.at(energy, predictor.channel, residual**2 - predictor.scored)
    joint = int(np.argmax(energy[: len(predictor.plant.joints)]))
    rows = (predictor.channel == joint) & predictor.scored
    if not rows.any():
        return None
    wrong = residual[rows] * float(channels.floor[joint])
    kept = rows[predictor.channel == joint]
    curves = [
        (name, unit, *_curve(values[kept], wrong))
        for name, unit, values in _orders(predictor, joint)
    ]
    name, unit, at, mean, spread = max(curves, key=_explained)
    channel = channels.names[joint]
    plant, part = predictor.plant, float(np.clip(share, 0.0, 1.0))
    own = channel_unit(plant, channel)
    unit = plant.unit(unit, plant.joints[joint])
    return Unexplained(part, channel, own, name, unit, at, mean, spread)


Curve = tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]
"""A curve of errors: mean quantity in each bin, mean error, standard error of it."""


def _curve(values: FloatArray, wrong: FloatArray) -> Curve:
    """The curve of (rows,) errors over (rows,) values, in bins of equally many rows."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, BINS + 1)))
    where = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    at, mean, spread = [], [], []
    for k in range(max(len(edges) - 1, 1)):
        own = wrong[where == k]
        if len(own) >= FEWEST_IN_BIN:
            at.append(float(values[where == k].mean()))
            mean.append(float(own.mean()))
            spread.append(float(own.std() / np.sqrt(len(own))))
    return tuple(at), tuple(mean), tuple(spread)


def _explained(curve: tuple[str, str, *Curve]) -> float:
    """Significance of a curve (name, unit, curve): chi-square of its means."""
    mean, spread = np.array(curve[3]), np.array(curve[4])
    return float(np.sum((mean / np.maximum(spread, 1e-12)) ** 2)) if len(mean) else 0.0


def _orders(predictor: Predictor, joint: int) -> list[tuple[str, str, FloatArray]]:
    """Name, unit and (rows,) values of what a joint's error may depend on."""
    name = predictor.plant.joints[joint]
    parts = []
    for trace in predictor.traces:
        q = np.nan_to_num(trace.position_rad[:, joint])
        velocity = np.gradient(moving_mean(q, 5), trace.time_s)
        asked = q if trace.command_rad is None else trace.command_rad[:, joint]
        since_s = trace.time_s - trace.time_s[0]
        values = np.stack([q, velocity, np.nan_to_num(asked), since_s])
        parts.append(values[:, trace.compared])
    names = f"position.{name}", f"velocity.{name}", f"command.{name}", "time"
    units = "rad", "rad/s", "rad", "s"
    return list(zip(names, units, np.concatenate(parts, axis=1), strict=True))

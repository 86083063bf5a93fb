"""Shows an unexplained error as a curve over the quantity that it depends on most."""

import numpy as np

from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.smoothing import moving_mean
from diagnosis.verdict import Unexplained
from groundwalk.arrays import FloatArray

BINS = 16
"""Number of bins, and so of points, of a curve of mean errors."""

FEWEST = 10
"""Fewest rows in a bin of the curve; bins with fewer are left out."""


def unexplained(
    predictor: Predictor, residual: FloatArray, share: float
) -> Unexplained | None:
    """The mean error of the worst joint over one quantity; None if no row counts.

    The quantity is the one of the joint's position, velocity and command and of time
    over which the mean error is most significant.

    Args:
      predictor: the predictor that computed `residual`.
      residual: (N,) residual of the best model, in units of noise.
      share: share of the squared error above the noise that the model leaves.
    """
    energy = np.zeros(len(predictor.channels.names))
    np.add.at(energy, predictor.channel, residual**2 - predictor.scored)
    joint = int(np.argmax(energy[: len(predictor.plant.joints)]))
    rows = (predictor.channel == joint) & predictor.scored
    if not rows.any():
        return None
    wrong = residual[rows] * float(predictor.channels.noise[joint])
    kept = rows[predictor.channel == joint]
    curves = [
        (name, unit, *_curve(values[kept], wrong))
        for name, unit, values in _orders(predictor, joint)
    ]
    name, unit, at, mean, spread = max(curves, key=_explained)
    channel = predictor.channels.names[joint]
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
        if len(own) >= FEWEST:
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
        parts.append(np.stack([q, velocity, np.nan_to_num(asked), since_s]))
    names = f"position.{name}", f"velocity.{name}", f"command.{name}", "time"
    units = "rad", "rad/s", "rad", "s"
    return list(zip(names, units, np.concatenate(parts, axis=1), strict=True))

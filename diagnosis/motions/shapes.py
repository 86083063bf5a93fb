"""Shapes of motions, from -1 to 1, each of which shows some physics best."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray

Shape = Callable[[FloatArray, float], FloatArray]
"""A function from (T,) times [s] and a duration [s] to (T,) positions from -1 to 1. It
begins and ends at 0, so that motions can be played one after the other."""


@dataclass(frozen=True)
class Motion:
    """A motion that may be proposed.

    Attributes:
      name: name of its file, without ending.
      words: noun for reports.
      good_for: what it shows, for users.
      duration_s: how long it is to last [s].
      shape: the positions.
      sudden: whether commands jump, so that no speed of theirs is limited.
    """

    name: str
    words: str
    good_for: str
    duration_s: float
    shape: Shape
    sudden: bool = False


def _through(knots: Sequence[tuple[float, float]]) -> Shape:
    """Straight lines through points (share of the duration, position)."""
    share, position = np.array(knots).T

    def shape(time_s: FloatArray, duration_s: float) -> FloatArray:
        return np.asarray(np.interp(time_s, share * duration_s, position))

    return shape


def _poses(time_s: FloatArray, duration_s: float) -> FloatArray:
    """Holds at seven poses, with smooth moves of a third of the time between them."""
    levels = np.array([0.0, 0.9, -0.9, 0.45, -0.45, 0.75, 0.0])
    at = np.clip(time_s / duration_s, 0.0, 1.0) * (len(levels) - 1)
    number = np.minimum(at.astype(int), len(levels) - 2)
    way = np.clip(3 * (at - number), 0.0, 1.0)
    smooth = 0.5 - 0.5 * np.cos(np.pi * way)
    return np.asarray(levels[number] + (levels[number + 1] - levels[number]) * smooth)


def _jumps(time_s: FloatArray, duration_s: float) -> FloatArray:
    """Sudden moves between two levels, which the last second ends."""
    inside = (time_s > 0.5) & (time_s < duration_s - 1.0)
    return np.asarray(0.5 * np.sign(np.sin(2 * np.pi * (time_s - 0.5) / 1.6)) * inside)


def _chirp(time_s: FloatArray, duration_s: float) -> FloatArray:
    """Sines from 0.2 to 5 Hz, that shrink as they quicken, so that speed stays."""
    hertz = 0.2 * 25.0 ** np.clip(time_s / duration_s, 0.0, 1.0)
    turns = 0.2 * duration_s / np.log(25.0) * (hertz / 0.2 - 1)
    end = np.clip((duration_s - time_s) / 0.3, 0.0, 1.0)
    return np.asarray(np.sin(2 * np.pi * turns) / (1 + hertz / 0.8) * end)


def _sweeps(time_s: FloatArray, duration_s: float) -> FloatArray:
    """Fast sines of full reach, which grow and fade over a second."""
    edge = np.minimum(np.minimum(time_s, duration_s - time_s), 1.0)
    fade = 0.5 - 0.5 * np.cos(np.pi * np.clip(edge, 0.0, 1.0))
    return np.asarray(fade * np.sin(2 * np.pi * 0.7 * time_s))


_RAMPS = (0, 0), (0.2, 1), (0.6, -1), (0.72, 0), (0.79, 1), (0.93, -1), (1, 0)
_STROKES = tuple((k / 16, (-1) ** k * 0.04 * k * (k < 16)) for k in range(17))

MOTIONS = (
    Motion(
        "slow_ramps",
        "slow ramps there and back, at two speeds",
        "dry friction by direction, viscous friction by speed",
        24.0,
        _through(_RAMPS),
    ),
    Motion(
        "holds",
        "holds at several poses",
        "gravity: payloads, offsets, springs, weak servos",
        18.0,
        _poses,
    ),
    Motion(
        "chirp",
        "chirp from 0.2 to 5 Hz",
        "inertia, elasticity, delays, damping",
        20.0,
        _chirp,
    ),
    Motion(
        "reversals",
        "small strokes that turn back often",
        "play, and friction that sticks",
        16.0,
        _through(_STROKES),
    ),
    Motion(
        "steps", "steps", "delays, limits of torque, damping", 10.0, _jumps, sudden=True
    ),
    Motion(
        "sweeps",
        "fast strokes of full reach",
        "limits of speed and torque, drag, end stops",
        10.0,
        _sweeps,
    ),
)
"""The motions that may be proposed."""

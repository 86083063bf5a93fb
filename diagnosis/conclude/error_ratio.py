"""How many times smaller one sim's error is than another's, with an interval.

Both sims predict the same recordings. Their squared errors are summed over units that
are independent: recordings if there are many, else blocks of time. The units are drawn
again at random with the errors of both sims together (paired bootstrap; Efron 1979,
"Bootstrap methods: another look at the jackknife"). Of few units the draws scatter too
little; the ends of the interval are moved apart by sqrt(n / (n - 1)) and by what
Student's t of n - 1 degrees of freedom is wider than the normal distribution
(Hesterberg 2015, "What teachers should know about the bootstrap").
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from diagnosis.residuals.predictor import Predictor
from diagnosis.search.chance import ALIKE, FEWEST_BLOCKS, independent_blocks
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.distributions import normal_ppf, t_ppf

Unit = Literal["blocks of time", "recordings"]
"""What is drawn again at random: each counts as independent of the others."""

LEVEL = 0.95
"""Probability with which an interval holds the ratio."""

DRAWS = 4000
"""Number of draws: the ends of an interval then vary by a tenth of its half width."""

FEWEST_RECORDINGS = 5
"""Fewest recordings from which on these are drawn. How much fewer differ is not known:
then the interval holds for more time of motions like these, not for other motions."""

SMALLEST = 1e-9
"""Smallest error [noise floors] that is divided by."""


@dataclass(frozen=True)
class Ratio:
    """An error as a multiple of another one, with the ends of its 95 % interval.

    Above 1 the second sim is better. The ends are `value` where there is one unit only.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Squares:
    """Sums of squared errors of two sims over u units of the data.

    Attributes:
      unit: what the units are.
      before, after: (u, c) sums in each channel, in units of squared noise floors.
      count: (u, c) numbers of the entries that were summed.
    """

    unit: Unit
    before: FloatArray
    after: FloatArray
    count: FloatArray

    def rms(self, weight: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """(..., c) rms errors of both sims, units having weights (..., u); all 1."""
        weight = np.ones(len(self.count)) if weight is None else weight
        count = np.maximum(weight @ self.count, 1.0)
        before, after = (
            np.sqrt(weight @ one / count) for one in (self.before, self.after)
        )
        return before, after

    def ratios(self, seed: np.random.SeedSequence) -> tuple[Ratio, list[Ratio]]:
        """The ratio of both sims' errors over all channels, and in each channel.

        Over all channels an error is the root of the mean of squares, each in units of
        its noise floor.
        """
        units = len(self.count)
        draws = np.random.default_rng(seed).multinomial(
            units, np.full(units, 1 / units), DRAWS
        )
        drawn = _logarithms(*self.rms(draws.astype(float)))
        measured = _logarithms(*self.rms())
        tail = (1 - LEVEL) / 2
        ends = np.quantile(drawn, [tail, 1 - tail], axis=0) - measured
        ends = ends * _wider(units)
        together, *channels = [
            Ratio(
                *(float(np.exp(one)) for one in (middle, middle + low, middle + high))
            )
            for middle, low, high in zip(measured, *ends, strict=True)
        ]
        return together, channels


def _logarithms(before: FloatArray, after: FloatArray) -> FloatArray:
    """(..., 1 + c) logarithms of ratios of errors (..., c): of all, then of each."""
    both = []
    for rms in (before, after):
        every = np.sqrt(np.mean(rms**2, axis=-1, keepdims=True))
        both.append(np.log(np.maximum(np.concatenate([every, rms], -1), SMALLEST)))
    return np.asarray(both[0] - both[1])


def _wider(units: int) -> float:
    """Factor by which the interval of so few units is wider than the draws say."""
    if units < 2:
        return 1.0
    tail = (1 + LEVEL) / 2
    student = t_ppf(tail, units - 1) / normal_ppf(tail)
    return student * float(np.sqrt(units / (units - 1)))


def squares_of(predictor: Predictor, before: FloatArray, after: FloatArray) -> Squares:
    """Squared errors, in units that are independent, of residuals (N,) of two sims.

    `predictor` is of the recordings, residuals are in units of its channels' noise.
    """
    recordings = len(predictor.traces)
    if recordings >= FEWEST_RECORDINGS:
        return summed(predictor, before, after, predictor.trace, "recordings")
    blocks = [independent_blocks(predictor, one) for one in (before, after)]
    number = min(blocks, key=lambda one: int(one.max()))
    while True:
        found = summed(predictor, before, after, number, "blocks of time")
        if len(found.count) < 2 * FEWEST_BLOCKS or not _alike(found):
            return found
        number = _in_pairs(number, predictor.trace)


def _alike(squares: Squares) -> bool:
    """Whether what successive units add to the ratio of both errors is correlated.

    `independent_blocks` asks that of the errors themselves. But their squares may stay
    large for longer than errors keep their sign, as a motion goes on.
    """
    shares = [
        np.sum(one / np.maximum(squares.count.sum(axis=0), 1.0), axis=1)
        for one in (squares.before, squares.after)
    ]
    before, after = (one / max(float(one.sum()), 1e-300) for one in shares)
    more = after - before
    alike = float(np.sum(more[1:] * more[:-1])) / max(float(np.sum(more**2)), 1e-300)
    return bool(alike > ALIKE / np.sqrt(len(more)))


def _in_pairs(number: IntArray, trace: IntArray) -> IntArray:
    """(N,) numbers of blocks, of which two successive ones of a trace are joined."""
    first = np.full(int(trace.max()) + 1, np.iinfo(np.int64).max)
    np.minimum.at(first, trace, number)
    joined = trace * (int(number.max()) + 1) + (number - first[trace]) // 2
    return np.unique(joined, return_inverse=True)[1]


def summed(
    predictor: Predictor,
    before: FloatArray,
    after: FloatArray,
    number: IntArray,
    unit: Unit,
) -> Squares:
    """Squared errors (N,) of two sims, summed over entries with the same `number`."""
    channels = predictor.channels
    scale, c = channels.noise / channels.floor, len(channels.names)
    place = number * c + predictor.channel
    size = (int(number.max()) + 1) * c

    def total(values: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(place, values, size).reshape(-1, c), float)

    count = total(predictor.scored.astype(float))
    own = [total((one * scale[predictor.channel]) ** 2) for one in (before, after)]
    some = count.any(axis=1)  # blocks in which nothing counts are none
    return Squares(unit, own[0][some], own[1][some], count[some])

"""Compares the torque that a recorded motion needs with the measured torque."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.inverse import NeededTorques
from diagnosis.residuals.channels import LEAST_TORQUE, Channels
from diagnosis.residuals.predictor import WORST, Model, Predictor
from diagnosis.residuals.reference_noise import Block, ReferenceNoise, waves
from diagnosis.residuals.replays import variants_of
from diagnosis.residuals.stop_contact import StopContact
from diagnosis.residuals.tolerance import Tolerance
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray, IntArray

FEWEST = 0.25
"""Share of a block's rows that must count for its mean to count."""

WAVE_BLOCKS = 16
"""Number of successive means whose errors may be correlated in the same way as in the
recordings of the healthy robot."""


class TorquePredictor(Predictor):
    """Computes the torques that the motion in recordings needs, without a replay.

    Torque is averaged over blocks of successive rows, over which smoothing has made the
    motion nearly constant: each mean is one entry of a residual, at the first row of
    its block; entries of all other rows do not count. A mean of fewer rows, since the
    joint was too slow in others, weighs less.

    What a wrong scale and a wrong zero of the measured torques change lies within the
    tolerances, beside those of the model.
    """

    def _prepare(self) -> None:
        """Find the rows that count; all traces have a `motion`.

        Steps, threads and windows are those of replays: they change nothing.
        """
        plant, traces = self.plant, self.traces
        self._needed = NeededTorques(plant, traces)
        motions = [trace.motion for trace in traces if trace.motion is not None]
        known = np.isfinite(self._measured)
        self._counts = np.concatenate([one.counts for one in motions]) & known
        starts, first, sizes = list[int](), 0, list[int]()
        for trace, motion in zip(traces, motions, strict=True):
            own = range(first, first + trace.ticks, motion.block_rows)
            starts += own
            sizes += [motion.block_rows] * len(own)
            first += trace.ticks
        self._starts = np.array(starts)
        self._rows = np.add.reduceat(self._counts.astype(float), self._starts)
        full = np.array(sizes)[:, None]
        # the noise is that of means over whole blocks
        self._weight = 1 / np.sqrt(full * np.maximum(self._rows, 1.0))
        self._scored = np.zeros_like(self._counts)
        self._scored[self._starts] = self._rows >= FEWEST * full
        self.scored = self._scored.reshape(-1)
        self.blocks = _blocks(self._starts, self._scored, len(self._counts))
        largest = np.nanmax(np.abs(self._measured), axis=0, initial=0.0)
        rows = [motion.block_rows for motion in motions]
        noise = self.channels.noise
        self._stops = StopContact.of(plant, traces, rows, largest, noise)

    @property
    def by_torque(self) -> bool:
        """Whether torques are compared: they are."""
        return True

    def correct(self, model: Model = ()) -> FloatArray:
        """Zeros (c,), since nothing is integrated."""
        return np.zeros(len(self.channels.names))

    def _start_doubt(self, model: Model) -> None:
        """None, since nothing starts anywhere."""

    def predict(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c) torques that the motion needs by n models, for all traces."""
        torque = np.empty((len(models), *self._measured.shape))
        given = [self._doubts.given(model) for model in models]
        for rows, _, acting, _ in self._replays.together(given):
            torque[:, rows] = self._needed.of(variants_of(self.plant, acting))[:, rows]
        if self._on_replay is not None:
            self._on_replay(len(models))
        return torque

    def exact(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c) torques as of `predict`: there is no integration error."""
        return self.predict(models)

    def _errors(self, models: Sequence[Model], exactly: bool) -> FloatArray:
        """(n, rows, c) measured less needed torques in means over blocks [noise]."""
        wrong = self._means(self._measured - self.predict(models))
        given = [self._doubts.given(model) for model in models]
        own = self._starts
        wrong[:, own] = self._stops.rested(
            wrong[:, own], variants_of(self.plant, given)
        )
        return wrong

    def _means(self, torque_nm: FloatArray) -> FloatArray:
        """(n, rows, c) means of torques (n, rows, c) over blocks, in units of noise."""
        wrong = np.where(self._counts, torque_nm / self.channels.noise, 0.0)
        wrong = np.where(np.isfinite(wrong), np.clip(wrong, -WORST, WORST), WORST)
        found = np.zeros_like(wrong)
        sums = np.add.reduceat(wrong, self._starts, axis=1)
        found[:, self._starts] = sums * self._weight
        return np.where(self._scored, found, 0.0)

    def _beyond(self) -> Tolerance:
        """Changes by wrong zeros of the measured torques."""
        size_nm = np.where(np.isfinite(self._measured), self._measured, 0.0)
        zero_nm = LEAST_TORQUE * np.sqrt(np.mean(size_nm**2, axis=0))
        joints = len(self.channels.names)
        wrong = np.eye(joints)[:, None] * zero_nm * np.ones_like(self._measured)
        zeros = self._doubts.before_tolerance(self._means(wrong))
        names = [f"torque_offset@{name.split('.')[1]}" for name in self.channels.names]
        return Tolerance(zeros, names)


def predictor_of(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels | None = None,
    step_s: float | None = None,
    threads: int = 1,
    noise: ReferenceNoise | None = None,
    on_replay: Callable[[int], None] | None = None,
    window_s: float = 0.0,
    finest_s: float | None = None,
) -> Predictor:
    """A predictor of torques for traces with a `motion`, else one that replays them.

    Arguments are those of `Predictor`.
    """
    by_torque = all(trace.motion is not None for trace in traces)
    kind = TorquePredictor if by_torque else Predictor
    options = step_s, threads, noise, on_replay, window_s, finest_s
    return kind(plant, traces, channels, *options)


def _blocks(starts: IntArray, scored: BoolArray, rows: int) -> list[Block]:
    """Groups of successive means, as blocks of errors that may be correlated."""
    found = []
    for first in range(0, len(starts), WAVE_BLOCKS):
        own = starts[first : first + WAVE_BLOCKS]
        after = first + WAVE_BLOCKS
        stop = int(starts[after]) if after < len(starts) else rows
        counted = np.asarray(scored[int(own[0]) : stop].any(axis=1))
        within = np.linspace(0, 1, stop - int(own[0]), endpoint=False)
        found.append(Block(slice(int(own[0]), stop), waves(within, counted)))
    return found

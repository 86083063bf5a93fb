"""Compares the torque that a recorded motion needs with the measured torque."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.asked import AskedTorques, centred, late_commands_known
from diagnosis.replay.inverse import NeededTorques
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.channels import LEAST_TORQUE, Channels, measured_of
from diagnosis.residuals.predictor import WORST, Model, Predictor
from diagnosis.residuals.reference_noise import Block, ReferenceNoise, waves
from diagnosis.residuals.replays import variants_of
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from diagnosis.residuals.tolerance import Tolerance
from diagnosis.residuals.torques.healthy_torques import HealthyTorques
from diagnosis.residuals.torques.joint_errors import Means
from diagnosis.residuals.torques.stop_contact import StopContact
from diagnosis.traces.trace import Trace, asked
from groundwalk.arrays import BoolArray, FloatArray, IntArray

FEWEST = 0.25
"""Share of a block's rows that must count for its mean to count."""

WAVE_BLOCKS = 16
"""Number of successive means whose errors may be correlated in the same way as in the
recordings of the healthy robot."""


class TorquePredictor(Predictor):
    """Computes the torques that the motion in recordings needs, without a replay.

    Torque is averaged over blocks of successive rows, over which smoothing has made the
    motion nearly constant: each mean is one entry of a residual. A mean of fewer rows,
    since the joint was too slow in others, weighs less.

    What a wrong scale and a wrong zero of the measured torques change lies within the
    tolerances, beside those of the model.
    """

    def _prepare(self) -> None:
        """Find the rows that count; all traces have a `motion`.

        Steps, threads and windows are those of replays: they change nothing.
        """
        plant, traces = self.plant, self.traces
        self._needed = NeededTorques(plant, traces)
        in_model = plant.servo.back_emf_nm_s_rad
        self._asked = AskedTorques(traces, in_model) if asked(traces) else None
        motions = [trace.motion for trace in traces if trace.motion is not None]
        measured = [measured_of(trace, self.channels) for trace in traces]
        self._measured = np.concatenate(measured)
        known = np.isfinite(self._measured)
        self._counts = np.concatenate([one.counts for one in motions]) & known
        if self._asked is not None:
            late = np.concatenate([late_commands_known(one) for one in traces])
            self._counts &= late[:, None]
        starts, first, sizes = list[int](), 0, list[int]()
        for trace, motion in zip(traces, motions, strict=True):
            own = range(first, first + trace.ticks)[trace.compared]
            starts += own
            sizes += [motion.block_rows] * len(own)
            first += trace.ticks
        self._starts = np.array(starts)
        lasts = np.diff(self._starts, append=first)
        self._block_of = np.repeat(np.arange(len(starts)), lasts)
        self._rows = np.add.reduceat(self._counts.astype(float), self._starts)
        full = np.array(sizes)[:, None]
        # the noise is that of means over whole blocks
        self._weight = 1 / np.sqrt(full * np.maximum(self._rows, 1.0))
        self._scored = self._rows >= FEWEST * full
        self.scored = self._scored.reshape(-1)
        self.blocks = _blocks(self._starts, self._scored, len(self._counts))
        largest = np.nanmax(np.abs(self._measured), axis=0, initial=0.0)
        rows = [motion.block_rows for motion in motions]
        noise = self.channels.noise
        self._stops = StopContact.of(plant, traces, rows, largest, noise)
        self._whitening: list[FloatArray] | None = None
        self._usual: FloatArray | None = None

    @property
    def by_torque(self) -> bool:
        """Whether torques are compared: they are."""
        return True

    def correct(self, model: Model = ()) -> FloatArray:
        """Zeros (c,), since nothing is integrated."""
        return np.zeros(len(self.channels.names))

    def _start_doubt(self, model: Model) -> None:
        """None, since nothing starts anywhere."""

    def seen_rows(self, trace: Trace) -> slice:
        """All rows of a trace."""
        return slice(0, trace.ticks)

    def predict(self, models: Sequence[Model]) -> FloatArray:
        """(n, T, c) torques that the motion needs by n models, in all T rows."""
        torque = np.empty((len(models), *self._measured.shape))
        given = [self._doubts.given(model) for model in models]
        for rows, _, acting, _ in self._replays.together(given):
            variants = variants_of(self.plant, acting)
            needed = self._needed.of(variants)
            if self._healthy is not None:
                needed = needed + self._usual_nm(self._healthy)
            if self._asked is not None:
                needed = self._asked.of(needed, variants)
            own = rows[self._block_of]
            torque[:, own] = needed[:, own]
        if self._on_replay is not None:
            self._on_replay(len(models))
        return torque

    def exact(self, models: Sequence[Model]) -> FloatArray:
        """(n, T, c) torques as of `predict`: there is no integration error."""
        return self.predict(models)

    def drawn(self, random: np.random.Generator) -> FloatArray:
        """(blocks, c) errors of a right model [noise]: what means vary by, drawn."""
        return np.asarray(random.standard_normal(self._scored.shape))

    def _errors(self, models: Sequence[Model], exactly: bool) -> FloatArray:
        """(n, blocks, c) means of measured less needed torques [noise]."""
        wrong = self._means(self._measured - self.predict(models))
        given = [self._doubts.given(model) for model in models]
        wrong = self._stops.rested(wrong, variants_of(self.plant, given))
        if self._healthy is not None:
            wrong = self._less_usual(wrong, self._healthy)
        return wrong

    @property
    def _healthy(self) -> HealthyTorques | None:
        """The torque errors of the healthy robot, if they are known."""
        noise = self._doubts.noise
        return None if noise is None else noise.healthy

    def fit_nuisance(self, model: Model) -> None:
        """Find likely small mismatch, unless the healthy robot's errors are known."""
        if self._healthy is None:
            super().fit_nuisance(model)

    def take_nuisance(self, errors: Nuisance | None, model: Model) -> None:
        """Take small mismatch, unless the healthy robot's errors are known."""
        if self._healthy is None:
            super().take_nuisance(errors, model)

    def means(self, model: Model = ()) -> Means:
        """Mean torques [N m] that a model lacks, and what they may go with."""
        bare = self._with(noise=None)
        needed = bare.predict([model])[0]
        scored = self._scored
        missing = self._averages(self._measured - needed)
        columns = self._columns()
        k = columns.shape[2]
        averages = [self._averages(columns[:, :, i]) for i in range(k)]
        first = np.concatenate([[0], np.cumsum([t.ticks for t in self.traces])])
        recording = np.searchsorted(first, self._starts, side="right") - 1
        block = np.concatenate(
            [np.arange(int((recording == i).sum())) for i in range(len(self.traces))]
        )
        return Means(
            np.where(scored, missing, np.nan),
            np.stack(averages, axis=2),
            self._averages(needed),
            recording,
            block,
            tuple(trace.recording for trace in self.traces),
        )

    def _averages(self, values: FloatArray) -> FloatArray:
        """(blocks, j) averages of values (rows, j) over the rows that count."""
        counted = np.where(self._counts, np.nan_to_num(values), 0.0)
        sums = np.add.reduceat(counted, self._starts, axis=0)
        return np.asarray(sums / np.maximum(self._rows, 1.0))

    def _columns(self) -> FloatArray:
        """(rows, j, k) what torque errors may go with, `joint_errors.COLUMNS`."""
        needed = self._needed.of(variants_of(self.plant, [()]))[0]
        parts, first = [], 0
        for trace in self.traces:
            motion = trace.motion
            assert motion is not None
            q, v = motion.position_rad, motion.velocity_rad_s
            own = needed[first : first + trace.ticks]
            first += trace.ticks
            late = np.zeros_like(q)
            if trace.command_rad is not None:
                rate = np.gradient(centred(trace), trace.time_s, axis=0)
                late = trace.servo.kp_nm_rad * rate
            every = (
                np.ones_like(q),
                v,
                np.sign(v),
                q,
                np.sin(q),
                np.cos(q),
                motion.acceleration_rad_s2,
                own,
                np.abs(own) * np.sign(v),
                late,
            )
            parts.append(np.stack(every, axis=2))
        return np.concatenate(parts)

    def _usual_nm(self, healthy: HealthyTorques) -> FloatArray:
        """(rows, j) torque errors that the healthy robot has in this motion."""
        if self._usual is None:
            self._usual = healthy.torque(self._columns())
        return self._usual

    def _less_usual(self, wrong: FloatArray, healthy: HealthyTorques) -> FloatArray:
        """(n, blocks, c) errors, whitened with what recordings usually differ by."""
        if self._whitening is None:
            self._whitening = healthy.whitening(self.means())
        found = np.zeros_like(wrong)
        full = 1 / (self._weight**2 * np.maximum(self._rows, 1.0))
        weight = np.sqrt(np.maximum(self._rows, 1.0) / full)
        for j, matrix in enumerate(self._whitening):
            some = np.flatnonzero(self._scored[:, j])
            mean_nm = wrong[:, some, j] * self.channels.noise[j] / weight[some, j]
            found[:, some, j] = mean_nm @ matrix.T
        return np.clip(found, -WORST, WORST)

    def _means(self, torque_nm: FloatArray) -> FloatArray:
        """(n, blocks, c) means of torques (n, T, c), in units of noise."""
        wrong = np.where(self._counts, torque_nm / self.channels.noise, 0.0)
        wrong = np.where(np.isfinite(wrong), np.clip(wrong, -WORST, WORST), WORST)
        sums = np.add.reduceat(wrong, self._starts, axis=1)
        return np.where(self._scored, sums * self._weight, 0.0)

    def _beyond(self) -> Tolerance:
        """Changes by wrong zeros of the measured torques."""
        size_nm = np.where(np.isfinite(self._measured), self._measured, 0.0)
        zero_nm = LEAST_TORQUE * np.sqrt(np.mean(size_nm**2, axis=0))
        joints = len(self.channels.names)
        wrong = np.eye(joints)[:, None] * zero_nm * np.ones_like(self._measured)
        zeros = self._doubts.before_tolerance(self._means(wrong))
        names = [f"torque_offset@{name.split('.')[1]}" for name in self.channels.names]
        return Tolerance(Changes.of(zeros), names)


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
        own = slice(first, min(first + WAVE_BLOCKS, len(starts)))
        stop = starts[own.stop] if own.stop < len(starts) else rows
        within = (starts[own] - starts[first]) / (stop - starts[first])
        counted = np.asarray(scored[own].any(axis=1))
        found.append(Block(own, waves(within, counted)))
    return found

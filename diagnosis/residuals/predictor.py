"""Replays models of a robot on recordings, and returns their residuals."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import replay
from diagnosis.residuals.channels import Channels, measured_of, shared_channels, stacked
from diagnosis.residuals.limbs import Limb, limbs_of
from diagnosis.residuals.reference_noise import ReferenceNoise, blocks_of
from diagnosis.residuals.start_state import (
    POSITION_SPREAD_RAD,
    POSITION_STEP_RAD,
    VELOCITY_SPREAD_RAD_S,
    VELOCITY_STEP_RAD_S,
    StartUncertainty,
    nudged,
)
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import is_left_over, runs_of, window_s
from groundwalk.arrays import BoolArray, FloatArray

Model = tuple[PlacedEffect, ...]
"""The nominal robot model plus these effects; an empty tuple adds nothing."""

STEPS_S = {"fixed": (0.004, 0.002, 0.001), "floating": (0.002,)}
"""Time steps of replays [s] by the kind of base, from the longest to the shortest; a
shorter one is used where the integration error of the longer one is too large."""

WARM_UP_S = 0.4
"""The first seconds of a recording that are not scored, because its start state is only
known up to sensor noise."""

BLOCK_S = 0.5
"""Length [s] of the time blocks between which errors count as independent; within a
block they may be correlated."""

MOST_ROWS = 192
"""Most simulations in one batch. More would need more memory and save no time."""

WORST = 1e4
"""Largest residual [noise]; a replay that diverges gets it in every row."""


class Predictor:
    """Replays models on traces and corrects the integration error of the replays.

    The integration error of a coarse time step is smooth and hardly depends on the
    model. `calibrate` measures it once with finer steps and Richardson extrapolation
    (first order: twice the finer result minus the coarser one); it is then added to
    every replay.

    Attributes:
      plant: nominal robot model.
      traces: the recordings that are replayed.
      channels: the quantities that are compared, c of them, with their noise.
      step_s: time step of the replays [s].
      blocks: rows of all traces in blocks of 0.3 s, as reference noise uses them.
      channel: (N,) index of the channel of each entry of a residual.
      trace: (N,) index of the trace of each entry.
      block: (N,) number of the time block of each entry, for standard errors.
      scored: (N,) whether the entry counts; others are always 0.
    """

    def __init__(
        self,
        plant: Plant,
        traces: Sequence[Trace],
        channels: Channels | None = None,
        step_s: float | None = None,
        threads: int = 1,
        noise: ReferenceNoise | None = None,
        on_replay: Callable[[int], None] | None = None,
    ) -> None:
        """Estimate the states that the traces start from.

        Args:
          plant: nominal robot model.
          traces: recordings to replay, all with the same channels.
          channels: the quantities to compare with their noise; estimated from the
            traces where None.
          step_s: time step [s] of the replays; the longest of `STEPS_S` where None.
          threads: processor threads of each batch.
          noise: model errors known from reference recordings; none where None.
          on_replay: called after each batch with the number of its replays, counted as
            replays of all traces at the step `step_s`.
        """
        self.plant, self.traces = plant, list(traces)
        self.step_s, self._threads = step_s or STEPS_S[plant.base][0], threads
        self.channels = channels or shared_channels(plant, traces)
        self._limbs = limbs_of(plant)
        per_trace = [runs_of(plant, trace) for trace in traces]
        self._runs = [run for runs in per_trace for run in runs]
        self._first_run = np.cumsum([0, *(len(runs) for runs in per_trace)]).tolist()
        rows = [trace.ticks for trace in traces]
        c = len(self.channels.names)
        self._measured = np.concatenate(
            [measured_of(trace, self.channels) for trace in traces]
        )
        self._scored = np.isfinite(self._measured) & ~self._warming()[:, None]
        self._correction = np.zeros((sum(rows), c))
        self._fine_correction = self._correction
        self._ends = np.cumsum(rows).tolist()
        self._doubt: StartUncertainty | None = None
        self._noise, self._on_replay = noise, on_replay
        self.blocks = blocks_of(self._runs, self._scored.any(axis=1))
        self.channel = np.tile(np.arange(c), sum(rows))
        self.trace = np.repeat(np.arange(len(rows)), np.array(rows) * c)
        self.scored = self._scored.reshape(-1)
        self.block = np.unique(
            np.repeat(_block_numbers(traces), c), return_inverse=True
        )[1]

    def part(self, first: int, last: int) -> "Predictor":
        """A predictor of traces `first` to `last - 1`, with the same calibration."""
        some = self._like(self.traces[first:last], self.step_s)
        ends = [0, *self._ends]
        own = slice(ends[first], ends[last])
        some._correction = self._correction[own]
        some._fine_correction = self._fine_correction[own]
        if self._doubt is not None:
            runs = self._first_run[first], self._first_run[last]
            some._doubt = self._doubt.part(*runs)
        return some

    def stepped(self, step_s: float) -> "Predictor":
        """A predictor of the same traces with another time step [s], not calibrated."""
        return self._like(self.traces, step_s)

    def _like(self, traces: Sequence[Trace], step_s: float) -> "Predictor":
        """An uncalibrated predictor of other traces or with another time step."""
        own = self.channels, step_s, self._threads, self._noise, self._on_replay
        return Predictor(self.plant, traces, *own)

    def calibrate(self, model: Model = ()) -> float:
        """Measure the integration error and the influence of wrong start states.

        Args:
          model: the effects at which they are measured; a replay that diverges counts
            with the largest error, `WORST`.

        Returns:
          Rms [noise] of the integration error that the correction leaves.
        """
        coarse, fine, finer = (
            self._replayed([model], self.step_s / part)[0] for part in (1, 2, 4)
        )
        self._correction = 2 * finer - fine - coarse
        self._fine_correction = 2 * (finer - fine)
        self._doubt = self._start_doubt(model)
        # what remains after the extrapolation is the error of second order
        left = (finer - fine) - (fine - coarse) / 2
        left = np.nan_to_num(left / self.channels.noise, nan=WORST)
        return float(np.sqrt(np.mean(np.clip(left, -WORST, WORST) ** 2)))

    def _start_doubt(self, model: Model) -> StartUncertainty | None:
        """How wrong start states change the replays; None where noise includes it."""
        # with a floating base the reference noise contains the errors of wrong starts
        if self._noise is not None and self.plant.base == "floating":
            return None
        runs, models = nudged(self._runs), [self._given(model)]
        variants = variants_of(self.plant, models)
        results = replay(runs, variants, self.step_s, self._threads)
        stacks = [stacked(result, self.channels)[0] for result in results]
        count = len(self._runs)
        plain, positions, velocities = (
            np.concatenate(stacks[k * count : (k + 1) * count]) for k in range(3)
        )
        changes = [
            np.where(self._scored, (other - plain) * scale / self.channels.noise, 0.0)
            for other, scale in (
                (positions, POSITION_SPREAD_RAD / POSITION_STEP_RAD),
                (velocities, VELOCITY_SPREAD_RAD_S / VELOCITY_STEP_RAD_S),
            )
        ]
        changes = [np.nan_to_num(change) for change in changes]
        ends = np.cumsum([run.trace.ticks for run in self._runs])
        return StartUncertainty(changes, ends.tolist())

    def _given(self, model: Model) -> Model:
        """The model together with the effects that the reference shows."""
        return (*self._noise.model, *model) if self._noise else model

    def _warming(self) -> BoolArray:
        """(rows,) whether a row is not scored, as the first ones of a window."""
        flags = []
        for run in self._runs:
            since_s = run.trace.time_s - run.trace.time_s[0]
            whole = window_s(self.plant, run.trace) is None
            left_over = is_left_over(self.plant, run.trace)
            flags.append(since_s < WARM_UP_S if whole else (since_s <= 0) | left_over)
        return np.concatenate(flags)

    def measured(self, index: int) -> FloatArray:
        """(T, c) measured values of the trace with this index."""
        return measured_of(self.traces[index], self.channels)

    def predict(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c) predicted values, the rows of all traces one after another.

        Models with a spring between motor and link are replayed with half the time
        step: their motor oscillates too fast for the full one.

        Args:
          models: n models.
        """
        stiff = [any(effect(placed.name).stiff for placed in one) for one in models]
        predicted = np.empty((len(models), *self._correction.shape))
        for is_stiff, step_s, correction in (
            (False, self.step_s, self._correction),
            (True, self.step_s / 2, self._fine_correction),
        ):
            rows = [i for i, one in enumerate(stiff) if one is is_stiff]
            if rows:
                some = self._replayed([models[i] for i in rows], step_s)
                predicted[rows] = some + correction
        return predicted

    def exact(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c) predictions, each with the integration error of its own model.

        Takes six times as long as `predict`. It matters where models of the same
        physics are integrated differently, such as a damping that MuJoCo treats
        implicitly and an equal force that it treats explicitly.

        Args:
          models: n models.
        """
        fine, finer = (self._replayed(models, self.step_s / part) for part in (2, 4))
        return 2 * finer - fine

    def residuals(self, models: Sequence[Model], exactly: bool = False) -> FloatArray:
        """(n, N) measured minus predicted values in units of noise; 0 where not scored.

        Wrong start states and reference noise are taken out. A replay that diverges
        gets the largest residual, `WORST`.

        Args:
          models: n models.
          exactly: predict with `exact` instead of `predict`.
        """
        predicted = self.exact(models) if exactly else self.predict(models)
        wrong = (self._measured - predicted) / self.channels.noise
        wrong = np.where(np.isfinite(wrong), np.clip(wrong, -WORST, WORST), WORST)
        wrong = np.where(self._scored, wrong, 0.0)
        if self._doubt is not None:
            wrong = self._doubt.without(wrong)
        if self._noise is not None:
            wrong = self._noise.without(wrong, self.blocks)
        return wrong.reshape(len(models), -1)

    def _replayed(self, models: Sequence[Model], step_s: float) -> FloatArray:
        """(n, rows, c) replays without corrections, each limb simulated by itself."""
        shape = len(models), len(self._measured), len(self.channels.names)
        predicted = np.empty(shape)
        for limb in self._limbs:
            felt = [limb.felt(self._given(model)) for model in models]
            rows = {model: i for i, model in enumerate(dict.fromkeys(felt))}
            own, columns = limb.channels(self.channels)
            found = self._replayed_limb(limb, list(rows), step_s, own)
            predicted[:, :, columns] = found[[rows[model] for model in felt]]
        if self._on_replay is not None:
            self._on_replay(len(models) * round(self.step_s / step_s))
        return predicted

    def _replayed_limb(
        self, limb: Limb, models: Sequence[Model], step_s: float, own: Channels
    ) -> FloatArray:
        """(n, rows, channels of the limb) replays of one limb, in batches."""
        runs = [limb.run(run) for run in self._runs]
        most = max(1, MOST_ROWS // len(runs))
        parts = []
        for first in range(0, len(models), most):
            variants = variants_of(limb.plant, models[first : first + most])
            results = replay(runs, variants, step_s, self._threads)
            stacks = [stacked(result, own) for result in results]
            parts.append(np.concatenate(stacks, axis=1))
        return np.concatenate(parts)


def _block_numbers(traces: Sequence[Trace]) -> FloatArray:
    """(rows,) numbers of the time blocks, different for each trace."""
    return np.concatenate(
        [(t.time_s - t.time_s[0]) // BLOCK_S + 1000 * i for i, t in enumerate(traces)]
    )


def variants_of(plant: Plant, models: Sequence[Model]) -> Variants:
    """Model fields, servos and forces for a batch, with one row for each model.

    Args:
      plant: nominal robot model.
      models: the models of the rows.
    """
    variants = Variants(plant, len(models))
    for row, model in enumerate(models):
        for placed in model:
            values = np.array(placed.values)
            effect(placed.name).apply(variants, row, placed.place, values)
    return variants

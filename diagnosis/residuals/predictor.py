"""What models of a plant predict, and how far that is from what was measured."""

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
"""The plant with these effects; empty for the plant as it is."""

STEPS_S = {"fixed": (0.004, 0.002, 0.001), "floating": (0.002,)}
"""Of replays, by the plant's base; the shorter ones where the longest is too wrong."""

WARM_UP_S = 0.4
"""Not scored: the start state is known to the sensors' noise only."""

BLOCK_S = 0.5
"""Errors within a block may be alike, those of different blocks are not."""

MOST_ROWS = 192
"""Simulations in one batch."""

WORST = 1e4


class Predictor:
    """Replays models on traces, with the integrator's error taken out.

    Replays at a coarse step are wrong by something smooth that hardly depends on the
    model. Its size is found once, with finer steps and Richardson's extrapolation
    (first order: twice the finer less the coarser), and added to every replay since.
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
        """Find the states that the traces start from.

        Args:
          plant: nominal.
          traces: to be predicted, all with the same channels.
          channels: with their noise; measured on the traces where None.
          step_s: of the coarse replays; the longest of `STEPS_S` where None.
          threads: of every batch.
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
        blocks = np.concatenate(
            [
                (t.time_s - t.time_s[0]) // BLOCK_S + 1000 * i
                for i, t in enumerate(traces)
            ]
        )
        _, block = np.unique(np.repeat(blocks, c), return_inverse=True)
        self.block = block

    def part(self, first: int, last: int) -> "Predictor":
        """Of traces `first` to `last - 1` only, as well calibrated."""
        some = Predictor(
            self.plant,
            self.traces[first:last],
            self.channels,
            self.step_s,
            self._threads,
            self._noise,
            self._on_replay,
        )
        ends = [0, *self._ends]
        own = slice(ends[first], ends[last])
        some._correction = self._correction[own]
        some._fine_correction = self._fine_correction[own]
        if self._doubt is not None:
            runs = self._first_run[first], self._first_run[last]
            some._doubt = self._doubt.part(*runs)
        return some

    def stepped(self, step_s: float) -> "Predictor":
        """Of the same traces in steps of another length; not calibrated."""
        return Predictor(
            self.plant,
            self.traces,
            self.channels,
            step_s,
            self._threads,
            self._noise,
            self._on_replay,
        )

    def calibrate(self, model: Model = ()) -> float:
        """Measure the integrator's error at a model; the rms [noise] that is left.

        So is what wrong starts change. What blows up is as wrong as anything can be.
        """
        coarse, fine, finer = (
            self._replayed([model], self.step_s / part)[0] for part in (1, 2, 4)
        )
        self._correction = 2 * finer - fine - coarse
        self._fine_correction = 2 * (finer - fine)
        self._doubt = self._start_doubt(model)
        # of the first order, twice the finer less the fine is left with the second
        left = (finer - fine) - (fine - coarse) / 2
        left = np.nan_to_num(left / self.channels.noise, nan=WORST)
        return float(np.sqrt(np.mean(np.clip(left, -WORST, WORST) ** 2)))

    def _start_doubt(self, model: Model) -> StartUncertainty | None:
        # a window's wrong start is in what the windows of the reference get wrong
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
        """With what is wrong when all is well."""
        return (*self._noise.model, *model) if self._noise else model

    def _warming(self) -> BoolArray:
        """Rows that are not scored: of whole traces a while, of windows their first."""
        flags = []
        for run in self._runs:
            since_s = run.trace.time_s - run.trace.time_s[0]
            whole = window_s(self.plant, run.trace) is None
            left_over = is_left_over(self.plant, run.trace)
            flags.append(since_s < WARM_UP_S if whole else (since_s <= 0) | left_over)
        return np.concatenate(flags)

    def measured(self, index: int) -> FloatArray:
        """(T, c) what a trace measured."""
        return measured_of(self.traces[index], self.channels)

    def predict(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c), the traces' rows one after another.

        Models with a spring between motor and link take half the step: what it stores
        and gives back is lost in a step that its motor swings in.
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
        """(n, rows, c), each with the integrator's error as it is at that model.

        For six times the work of `predict`: what is implicit in one model, such as a
        damping, may be explicit in the next, and their errors differ.
        """
        fine, finer = (self._replayed(models, self.step_s / part) for part in (2, 4))
        return 2 * finer - fine

    def residuals(self, models: Sequence[Model], exactly: bool = False) -> FloatArray:
        """(n, N) measured less predicted, in units of noise; 0 where not scored.

        What blew up is as wrong as anything can be.

        Args:
          models: the effects.
          exactly: as `exact` predicts them, and not as `predict` does.
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
        """(n, rows, channels of the limb)."""
        runs = [limb.run(run) for run in self._runs]
        most = max(1, MOST_ROWS // len(runs))
        parts = []
        for first in range(0, len(models), most):
            variants = variants_of(limb.plant, models[first : first + most])
            results = replay(runs, variants, step_s, self._threads)
            stacks = [stacked(result, own) for result in results]
            parts.append(np.concatenate(stacks, axis=1))
        return np.concatenate(parts)


def variants_of(plant: Plant, models: Sequence[Model]) -> Variants:
    """A row for each model."""
    variants = Variants(plant, len(models))
    for row, model in enumerate(models):
        for placed in model:
            values = np.array(placed.values)
            effect(placed.name).apply(variants, row, placed.place, values)
    return variants

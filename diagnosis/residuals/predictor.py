"""Simulates models of a robot on recordings (replays), and returns their residuals."""

from collections.abc import Callable, Sequence
from copy import copy

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels, measured_of, shared_channels
from diagnosis.residuals.reference_noise import ReferenceNoise, blocks_of
from diagnosis.residuals.replays import Model as Model
from diagnosis.residuals.replays import Replays, tolerated
from diagnosis.residuals.start_state import StartUncertainty
from diagnosis.residuals.tolerance import Tolerance
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import is_left_over, window_s
from groundwalk.arrays import BoolArray, FloatArray

STEPS_S = {"fixed": (0.004, 0.002, 0.001), "floating": (0.002,)}
"""Time steps of simulations [s] by the kind of base, the longest first."""

WARM_UP_S = 0.4
"""Time [s] at the start of a recording in which errors do not count, because the start
state of the simulation is only known up to sensor noise."""

BLOCK_S = 0.5
"""Length [s] of the time blocks of which standard errors take account: errors in
different blocks count as independent, those in one block may be correlated."""

WORST = 1e7
"""Residuals are clipped to this size [noise]; a simulation that diverges gets it in all
rows after that."""


class Predictor:
    """Simulates models on recordings, and corrects the integration error.

    The integration error of a coarse time step is smooth and hardly depends on the
    model. `calibrate` measures it once for one model, with finer steps and Richardson
    extrapolation (first order: twice the finer result minus the coarser one); it is
    then taken out of every simulation. So steps may be long: of the model at which
    it was measured nothing is wrong, and of others only what they change.

    Attributes:
      blocks: rows of all traces in blocks of 0.3 s, in which model errors that the
        healthy robot shows are correlated.
      channel: (N,) index of the channel of each entry of a residual.
      trace: (N,) index of the trace of each entry.
      block: (N,) number of the time block (0.5 s) of each entry, for standard errors.
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
        window_s: float = 0.0,
        finest_s: float | None = None,
    ) -> None:
        """Estimate the states from which the simulations of the traces start.

        Args:
          plant: nominal robot model.
          traces: recordings, all with the same channels.
          channels: the quantities to compare; None to estimate them from the traces.
          step_s: time step of the simulations; None for 4 ms (floating base: 2 ms).
          threads: number of threads that simulate a batch.
          noise: model errors that recordings of the healthy robot show, or None.
          on_replay: called after each batch with its number of simulations, counted as
            simulations of all traces at the step `step_s`.
          window_s: least length of windows in which joints without servos are
            simulated.
          finest_s: shortest of the time steps with which the integration error is
            measured; None for a quarter of `step_s`, which is the longest.
        """
        self.plant, self.traces = plant, list(traces)
        self.step_s, self._threads = step_s or STEPS_S[plant.base][0], threads
        self.finest_s = finest_s or self.step_s / 4
        self.channels = channels or shared_channels(plant, traces)
        self._window_s = window_s
        self._replays = Replays(plant, traces, self.channels, threads, window_s)
        rows = [trace.ticks for trace in traces]
        c = len(self.channels.names)
        self._measured = np.concatenate(
            [measured_of(trace, self.channels) for trace in traces]
        )
        self._scored = np.isfinite(self._measured) & ~self._warming()[:, None]
        self._correction = np.zeros((sum(rows), c))
        self._fine_correction = self._exact_correction = self._correction
        self._ends = np.cumsum(rows).tolist()
        self._doubt: StartUncertainty | None = None
        self._tolerance: Tolerance | None = None
        self._noise, self._on_replay = noise, on_replay
        self.blocks = blocks_of(self._replays.runs, self._scored.any(axis=1))
        self.channel = np.tile(np.arange(c), sum(rows))
        self.trace = np.repeat(np.arange(len(rows)), np.array(rows) * c)
        self.scored = self._scored.reshape(-1)
        numbers = [  # none occurs in two traces
            (trace.time_s - trace.time_s[0]) // BLOCK_S + 1000 * i
            for i, trace in enumerate(traces)
        ]
        blocks = np.repeat(np.concatenate(numbers), c)
        self.block = np.unique(blocks, return_inverse=True)[1]
        self._prepare()

    def _prepare(self) -> None:
        """Prepare what another kind of predictor needs beside windows and channels."""

    def part(self, first: int, last: int) -> "Predictor":
        """A predictor of traces `first` to `last - 1`, with the same calibration."""
        some = self.stepped(self.step_s, self.finest_s, self.traces[first:last])
        ends = [0, *self._ends]
        own = slice(ends[first], ends[last])
        some._correction = self._correction[own]
        some._fine_correction = self._fine_correction[own]
        some._exact_correction = self._exact_correction[own]
        if self._doubt is not None:
            runs = self._replays.first_run
            some._doubt = self._doubt.part(runs[first], runs[last])
        if self._tolerance is not None:
            entries = np.zeros_like(self._scored)
            entries[own] = True
            some._tolerance = self._tolerance.part(entries.reshape(-1))
        return some

    @property
    def noise_energy(self) -> float:
        """Energy [nats] that a right model leaves on average.

        It is 1/2 for each entry that counts, less what whitening takes out of noise.
        """
        taken = [one.taken for one in (self._doubt, self._tolerance) if one is not None]
        return 0.5 * float(self.scored.sum() - sum(taken))

    def without_tolerances(self) -> "Predictor":
        """A copy whose residuals are not whitened with tolerances."""
        some = copy(self)
        some._tolerance = None
        return some

    def with_tolerances_beside(self, model: Model) -> "Predictor":
        """A copy whose tolerances are those of all but a model's effects."""
        some = copy(self)
        if self._tolerance is not None:
            some._tolerance = self._tolerance.beside({one.key for one in model})
        return some

    def with_likely_tolerances(self, model: Model) -> "Predictor":
        """A copy whose tolerances are as wide as the errors that a model leaves."""
        some = copy(self)
        if self._tolerance is not None:
            (left,) = self.without_tolerances().residuals([model])
            some._tolerance = self._tolerance.scaled(self._tolerance.likely_scale(left))
        return some

    @property
    def by_torque(self) -> bool:
        """Whether torques that the motion needs are compared, without a replay."""
        return False

    def on(self, plant: Plant) -> "Predictor":
        """An uncalibrated predictor of the same traces with another robot model."""
        own = self.channels, self.step_s, self._threads, self._noise, self._on_replay
        return type(self)(plant, self.traces, *own, self._window_s, self.finest_s)

    def stepped(
        self,
        step_s: float,
        finest_s: float | None = None,
        traces: Sequence[Trace] | None = None,
    ) -> "Predictor":
        """An uncalibrated predictor with other time steps, see the constructor.

        It is of given or its own traces.
        """
        own = self.channels, step_s, self._threads, self._noise, self._on_replay
        some = self.traces if traces is None else traces
        return type(self)(self.plant, some, *own, self._window_s, finest_s)

    def calibrate(self, model: Model = (), tolerances: bool = True) -> FloatArray:
        """Measure the integration error of a model, and what wrong start states change.

        Both are then taken out of the residuals of all models, and so is what errors
        within the tolerances of the nominal model change. Returns (c,) the rms, in
        units of noise, of the integration error that remains in each channel. Without
        `tolerances` those stay that were found before.
        """
        error = self.correct(model)
        self.doubt(model, tolerances)
        return error

    def doubt(self, model: Model = (), tolerances: bool = True) -> None:
        """Find what wrong start states change, and errors within tolerances."""
        known = self._tolerance
        self._doubt, self._tolerance = self._start_doubt(model), None
        if not tolerances:
            self._tolerance = known
        elif self.plant.base == "fixed":  # contacts outdo tolerances by far
            self._tolerance = self._tolerated(model)

    def doubt_as(self, other: "Predictor") -> None:
        """Take what wrong start states change, and tolerances, of the same traces."""
        self._doubt, self._tolerance = other._doubt, other._tolerance

    def correct(self, model: Model = ()) -> FloatArray:
        """Measure the integration error of a model, to be taken out of all residuals.

        Returns (c,) the rms, in units of noise, of that which remains in each channel;
        large if the simulation of `model` diverges.
        """
        own = [self.step_s / part for part in (1, 2, 4)]
        finest = [self.finest_s * part for part in (4, 2, 1)]
        found = {
            step_s: self._replayed([model], step_s)[0]
            for step_s in dict.fromkeys([*own, *finest])
        }
        coarse, fine, finer = (found[step_s] for step_s in finest)
        right = 2 * finer - fine
        self._correction = right - found[own[0]]
        self._fine_correction = right - found[own[1]]
        self._exact_correction = right - (2 * found[own[2]] - found[own[1]])
        # the extrapolation leaves the error of second order
        left = (finer - fine) - (fine - coarse) / 2
        left = np.nan_to_num(left / self.channels.noise, nan=WORST)
        return np.asarray(np.sqrt(np.mean(np.clip(left, -WORST, WORST) ** 2, axis=0)))

    def _start_doubt(self, model: Model) -> StartUncertainty | None:
        """How wrong start states change simulations; None if noise includes that."""
        # with a floating base the reference noise contains the errors of wrong starts
        if self._noise is not None and self.plant.base == "floating":
            return None
        changes = self._replays.start_errors(self._given(model), self.step_s)
        changes = np.where(self._scored, changes, 0.0) / self.channels.noise
        ends = np.cumsum([run.trace.ticks for run in self._replays.runs])
        return StartUncertainty(np.nan_to_num(changes), ends.tolist())

    def _tolerated(self, model: Model) -> Tolerance:
        """Changes of the residual that lie within the model's tolerances."""
        every = tolerated(self.plant, self.traces)
        residuals = self.residuals([model, *((*model, one) for one in every)])
        return Tolerance(residuals[1:] - residuals[0], [one.key for one in every])

    def _given(self, model: Model) -> Model:
        """The model, and the effects that recordings of the healthy robot show."""
        return (*self._noise.model, *model) if self._noise else model

    def _warming(self) -> BoolArray:
        """(rows,) whether errors in a row do not count: at starts, in short windows."""
        flags = []
        for run in self._replays.runs:
            since_s = run.trace.time_s - run.trace.time_s[0]
            whole = window_s(self.plant, run.trace) is None
            left_over = is_left_over(self.plant, run.trace)
            flags.append(since_s < WARM_UP_S if whole else (since_s <= 0) | left_over)
        return np.concatenate(flags)

    def predict(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c) values of c channels as n models predict them, for all traces.

        A model with a spring between motor and link is simulated with half the time
        step: its motor oscillates too fast for the full one.
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
        """(n, rows, c) values of c channels as n models predict them, more exactly.

        Each model's own integration error is corrected instead of a common one, which
        takes six times as long as `predict`. It matters where models of the same
        physics are integrated differently, such as a damping that MuJoCo treats
        implicitly and an equal force that it treats explicitly.
        """
        fine, finer = (self._replayed(models, self.step_s / part) for part in (2, 4))
        return np.asarray(2 * finer - fine + self._exact_correction)

    def residuals(self, models: Sequence[Model], exactly: bool = False) -> FloatArray:
        """(n, N) measured less predicted values of n models, in units of noise.

        Entries that do not count are 0, those of a simulation that diverges `WORST`.
        The influence of wrong start states, and model errors that recordings of the
        healthy robot show, are taken out. `exactly` predicts by `exact` instead of
        `predict`.
        """
        return self._whitened(self._errors(models, exactly))

    def _errors(self, models: Sequence[Model], exactly: bool) -> FloatArray:
        """(n, rows, c) measured less predicted values of n models [noise]."""
        predicted = self.exact(models) if exactly else self.predict(models)
        wrong = (self._measured - predicted) / self.channels.noise
        wrong = np.where(np.isfinite(wrong), np.clip(wrong, -WORST, WORST), WORST)
        return np.where(self._scored, wrong, 0.0)

    def _whitened(self, wrong: FloatArray) -> FloatArray:
        """(n, N) errors (n, rows, c) without what is no evidence, in units of noise."""
        if self._doubt is not None:
            wrong = self._doubt.without(wrong)
        if self._noise is not None:
            wrong = self._noise.without(wrong, self.blocks)
        flat = wrong.reshape(len(wrong), -1)
        return flat if self._tolerance is None else self._tolerance.without(flat)

    def _replayed(self, models: Sequence[Model], step_s: float) -> FloatArray:
        """(n, rows, c) simulated values without corrections."""
        given = [self._given(model) for model in models]
        predicted = self._replays.values(given, step_s)
        if self._on_replay is not None:
            self._on_replay(len(models) * round(self.step_s / step_s))
        return predicted

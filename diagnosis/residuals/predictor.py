"""Simulates models of a robot on recordings (replays), and returns their residuals."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.servos import late_commands
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels, measured_of, shared_channels
from diagnosis.residuals.doubted import Doubted
from diagnosis.residuals.doubts import Doubts
from diagnosis.residuals.integration_error import IntegrationError
from diagnosis.residuals.models_around import models_around
from diagnosis.residuals.reference_noise import ReferenceNoise, blocks_of
from diagnosis.residuals.replays import Model as Model
from diagnosis.residuals.replays import Replays, time_blocks
from diagnosis.residuals.start_state import StartUncertainty
from diagnosis.residuals.timing.clock import clock_noise
from diagnosis.residuals.timing.command_timing import CommandTiming, jumps_of
from diagnosis.residuals.trust import Trust
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

STEPS_S = {"fixed": (0.004, 0.002, 0.001), "floating": (0.002,)}
"""Time steps of simulations [s] by the kind of base, the longest first."""

BLOCK_S = 0.5
"""Length [s] of the time blocks of which standard errors take account: errors in
different blocks count as independent, those in one block may be correlated."""

WORST = 1e7
"""Residuals are clipped to this size [noise]; a simulation that diverges gets it in all
rows after that."""

MOST_ENTRIES = 2**21
"""Most values of residuals that are computed at once, to limit memory."""


class Predictor(Doubted):
    """Simulates models on recordings, and corrects the integration error.

    `calibrate` measures the integration error for one model, which is then taken out of
    every simulation. So steps may be long: of the model at which it was measured
    nothing is wrong, and of others only what they change.

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
        replays: Replays | None = None,
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
          replays: replays of these traces; None to prepare them.
        """
        self.plant, self.traces = plant, list(traces)
        self.step_s, self._threads = step_s or STEPS_S[plant.base][0], threads
        self.finest_s = finest_s or self.step_s / 4
        self.channels = channels or shared_channels(plant, traces)
        self._window_s = window_s
        self._replays = replays or Replays(
            plant, traces, self.channels, threads, window_s
        )
        rows = [trace.rows for trace in traces]
        c = len(self.channels.names)
        self._measured = np.concatenate(
            [measured_of(trace, self.channels)[trace.compared] for trace in traces]
        )
        self._scored = np.isfinite(self._measured) & ~self._replays.warming()[:, None]
        none = np.zeros((sum(rows), c))
        self._error = IntegrationError(none, none, none, none)
        self._ends = np.cumsum(rows).tolist()
        self._on_replay = on_replay
        self.blocks = blocks_of(self._replays.runs, self._scored.any(axis=1))
        self.channel = np.tile(np.arange(c), sum(rows))
        self.trace = np.repeat(np.arange(len(rows)), np.array(rows) * c)
        self.scored = self._scored.reshape(-1)
        self.block = np.repeat(time_blocks(traces, BLOCK_S), c)
        self._prepare()
        clock = clock_noise(self.traces, self.channels, self._scored)
        self._doubts = Doubts(clock=clock, noise=noise, blocks=self.blocks)
        self._trust: Trust = {}

    def trusting(self, trust: Trust) -> None:
        """Take other weights of recordings; what wrong starts change is to be found."""
        self._trust, weights = trust, None
        if trust:
            c = len(self.channels.names)
            known = [trust.get(one.recording, np.ones(c)) for one in self.traces]
            weights = np.stack(known)[self.trace.reshape(-1, c)[:, 0]]
        self._doubts = replace(self._doubts, trust=weights)

    def squares_in(self, model: Model) -> dict[str, FloatArray]:
        """What a model leaves in each recording, by its name, without weights.

        (2, c) sums of squares, and numbers of entries, in units of noise.
        """
        (left,) = self.evenly().residuals([model])
        found = dict[str, FloatArray]()
        for k, trace in enumerate(self.traces):
            own = (self.trace == k) & self.scored
            count = np.bincount(self.channel[own], minlength=len(self.channels.names))
            sums = np.bincount(self.channel[own], left[own] ** 2, len(count))
            both = np.stack([sums, count.astype(float)])
            found[trace.recording] = found.get(trace.recording, 0 * both) + both
        return found

    def _prepare(self) -> None:
        """Prepare what another kind of predictor needs beside windows and channels."""

    def part(self, first: int, last: int) -> "Predictor":
        """A predictor of traces `first` to `last - 1`, with the same calibration."""
        replays = self._replays.part(first, last)
        some = self._of(self.traces[first:last], self.step_s, self.finest_s, replays)
        ends = [0, *self._ends]
        rows, c = slice(ends[first], ends[last]), len(self.channels.names)
        some._error = self._error.part(rows)
        runs = slice(self._replays.first_run[first], self._replays.first_run[last])
        own = slice(rows.start * c, rows.stop * c), slice(first, last), runs
        some._doubts = some._doubts.part(self._doubts, *own)
        return some

    @property
    def steps_s(self) -> list[float]:
        """Time step [s] of the simulations of each trace."""
        return [self.step_s / finer for finer in self._replays.finer]

    @property
    def by_torque(self) -> bool:
        """Whether torques that the motion needs are compared, without a replay."""
        return False

    def on(self, plant: Plant) -> "Predictor":
        """An uncalibrated predictor of the same traces with another robot model."""
        own = (
            self.channels,
            self.step_s,
            self._threads,
            self._doubts.noise,
            self._on_replay,
        )
        some = type(self)(plant, self.traces, *own, self._window_s, self.finest_s)
        some.trusting(self._trust)
        return some

    def stepped(
        self,
        step_s: float,
        finest_s: float | None = None,
        finer: Sequence[int] | None = None,
    ) -> "Predictor":
        """An uncalibrated predictor with other time steps, see the constructor.

        For each trace as many steps are taken for one as `finer` says; as many as
        before for None.
        """
        replays = self._replays
        if finer is not None:
            replays = replays.with_finer(finer)
        return self._of(self.traces, step_s, finest_s, replays)

    def _of(
        self,
        traces: Sequence[Trace],
        step_s: float,
        finest_s: float | None,
        replays: Replays,
    ) -> "Predictor":
        """An uncalibrated predictor of some traces."""
        own = self.channels, step_s, self._threads, self._doubts.noise, self._on_replay
        more = self._window_s, finest_s, replays
        some = type(self)(self.plant, traces, *own, *more)
        some.trusting(self._trust)
        return some

    def correct(self, model: Model = ()) -> FloatArray:
        """Measure the integration error of a model, to be taken out of all residuals.

        Returns (c,) the rms, in units of noise, of that which remains in each channel;
        large if the simulation of `model` diverges. Fast errors that the robot model
        makes for the healthy robot are noise, too.
        """
        near = models_around(self.plant, self._doubts.given(model))

        def values(step_s: float) -> FloatArray:
            return np.asarray(np.mean(self._values(near, step_s), axis=0))

        self._error, left = IntegrationError.of(values, self.step_s, self.finest_s)
        known = self._doubts.noise
        noise = self.channels.noise * (1.0 if known is None else known.scale)
        with np.errstate(over="ignore"):  # simulations diverge
            left = np.nan_to_num(left / noise, nan=WORST)
        return np.asarray(np.sqrt(np.mean(np.clip(left, -WORST, WORST) ** 2, axis=0)))

    def _doubt_times(self, model: Model) -> None:
        """Find what commands that jump early or late change, and wrong start states."""
        self._doubts = replace(self._doubts, commands=self._command_doubt(model))
        self._doubts = replace(self._doubts, start=self._start_doubt(model))

    def _command_doubt(self, model: Model) -> CommandTiming | None:
        """How late commands change simulations; None if clocks do not jitter."""
        clock = self._doubts.clock
        if clock is None or any(trace.command_rad is None for trace in self.traces):
            return None
        late_s = self.channels.jitter_s
        given = self._doubts.given(model)
        late = *given, late_commands(late_s)
        one, other = self._replays.values([given, late], self.step_s)
        changes = np.where(self._scored, one - other, 0.0) / self.channels.noise
        if self._doubts.trust is not None:
            changes = changes * self._doubts.trust
        jumps = jumps_of(self.traces, self.channels)
        return CommandTiming(np.nan_to_num(changes), jumps, self._ends, clock)

    def _start_doubt(self, model: Model) -> StartUncertainty | None:
        """How wrong start states change simulations; None if noise includes that."""
        # with a floating base the reference noise contains the errors of wrong starts
        if self._doubts.noise is not None and self.plant.base == "floating":
            return None
        changes = self._replays.start_errors(self._doubts.given(model), self.step_s)
        changes = np.where(self._scored, changes, 0.0) / self.channels.noise
        ends = np.cumsum([run.trace.rows for run in self._replays.runs])
        whiten = self._doubts.timed
        return StartUncertainty(np.nan_to_num(changes), ends.tolist(), whiten)

    def seen_rows(self, trace: Trace) -> slice:
        """The rows of a trace in which values are predicted."""
        return trace.compared

    def predict(self, models: Sequence[Model]) -> FloatArray:
        """(n, rows, c) values of c channels as n models predict them, for all traces.

        Only those in `seen_rows` of the traces.

        Models are simulated with as many steps for one as their effects need.
        """
        finer = [
            max((effect(placed.name).finer for placed in one), default=1)
            for one in models
        ]
        predicted = np.empty((len(models), *self._error.whole.shape))
        for part, correction in self._error.of_parts.items():
            rows = [i for i, one in enumerate(finer) if one == part]
            if rows:
                some = self._replayed([models[i] for i in rows], self.step_s / part)
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
        return np.asarray(2 * finer - fine + self._error.extrapolated)

    @property
    def has_reference(self) -> bool:
        """Whether recordings of the healthy robot show errors, which are taken out."""
        return self._doubts.noise is not None

    @property
    def knows_healthy_torques(self) -> bool:
        """Whether torques are compared, of which the healthy robot's errors are known.

        Then these are what its recordings differ by, and effects are few.
        """
        noise = self._doubts.noise
        return noise is not None and noise.healthy is not None

    def residuals(self, models: Sequence[Model], exactly: bool = False) -> FloatArray:
        """(n, N) measured less predicted values of n models, in units of noise.

        Entries that do not count are 0, those of a simulation that diverges `WORST`.
        The influence of wrong start states, and model errors that recordings of the
        healthy robot show, are taken out. `exactly` predicts by `exact` instead of
        `predict`.
        """
        some = max(1, MOST_ENTRIES // self._measured.size)
        found = np.empty((len(models), len(self.scored)))
        for i in range(0, len(models), some):  # in place, for memory
            own = models[i : i + some]
            found[i : i + some] = self._doubts.without(self._errors(own, exactly), own)
        return found

    def drawn(self, random: np.random.Generator) -> FloatArray:
        """(rows, c) errors of a right model [noise]: drawn noise, and rounding."""
        exact = self.predict([()])[0]
        errors = self.channels.read(exact, random) - exact
        return np.asarray(np.nan_to_num(errors / self.channels.noise))

    def residual_of(self, errors: FloatArray) -> FloatArray:
        """(N,) residual that errors (rows, c) [noise] of a right model leave.

        The influence of wrong start states, and so on, is taken out of them.
        """
        wrong = np.where(self._scored, errors, 0.0)
        return np.asarray(self._doubts.without(wrong[None], [()])[0])

    def _errors(self, models: Sequence[Model], exactly: bool) -> FloatArray:
        """(n, rows, c) measured less predicted values of n models [noise]."""
        predicted = self.exact(models) if exactly else self.predict(models)
        with np.errstate(over="ignore", invalid="ignore"):  # simulations diverge
            wrong = (self._measured - predicted) / self.channels.noise
        wrong = np.where(np.isfinite(wrong), np.clip(wrong, -WORST, WORST), WORST)
        return np.where(self._scored, wrong, 0.0)

    def _replayed(self, models: Sequence[Model], step_s: float) -> FloatArray:
        """(n, rows, c) simulated values without corrections."""
        return self._values([self._doubts.given(model) for model in models], step_s)

    def _values(self, given: Sequence[Model], step_s: float) -> FloatArray:
        """(n, rows, c) simulated values of models with all that they are given."""
        predicted = self._replays.values(given, step_s)
        if self._on_replay is not None:
            self._on_replay(len(given) * round(self.step_s / step_s))
        return predicted

"""Simulates models of a robot on the windows of recordings (replays)."""

import itertools
from collections.abc import Iterator, Sequence
from copy import copy

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import replay
from diagnosis.residuals.channels import Channels, stacked
from diagnosis.residuals.limbs import Limb, limbs_of
from diagnosis.residuals.start_state import SPREADS, STEPS, nudged
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run, is_left_over, runs_of, window_s
from groundwalk.arrays import BoolArray, FloatArray, IntArray

Model = tuple[PlacedEffect, ...]
"""A hypothesis: the nominal robot model plus these effects, or nothing for ()."""

WARM_UP_S = 0.4
"""Time [s] at the start of a recording in which errors do not count, because the start
state of the simulation is only known up to sensor noise."""

MOST_ROWS = 192
"""Most simulations in one batch; more would save no time."""

MOST_VALUES = 2**23
"""Most values of a quantity that are simulated in one batch, to limit memory."""


SHORTEST_S = 2.5e-4
"""Shortest step [s] of recordings whose steps are finer than others': a servo that
saturates lasts longer."""


class Replays:
    """Simulates models on all windows of some recordings, limb by limb.

    Values are those in the rows that are compared.

    Attributes:
      runs: the windows of all recordings, one after the other.
      first_run: index of each recording's first window, and the number of windows.
      finer: for each recording the number of steps that are taken for one.
    """

    def __init__(
        self,
        plant: Plant,
        traces: Sequence[Trace],
        channels: Channels,
        threads: int,
        window_s: float,
    ) -> None:
        """Divide recordings into windows; arguments are those of `Predictor`."""
        self._plant, self._channels, self._threads = plant, channels, threads
        self._limbs = limbs_of(plant)
        per_trace = [runs_of(plant, trace, window_s) for trace in traces]
        self.runs = [run for runs in per_trace for run in runs]
        self.first_run = np.cumsum([0, *(len(runs) for runs in per_trace)]).tolist()
        rows = [sum(run.trace.rows for run in runs) for runs in per_trace]
        self._recording = np.repeat([trace.recording for trace in traces], rows)
        self._trace = np.repeat(np.arange(len(traces)), rows)
        self.finer = [1] * len(traces)

    def part(self, first: int, last: int) -> "Replays":
        """The replays of traces `first` to `last - 1`."""
        some = copy(self)
        ends = self.first_run[first : last + 1]
        some.runs = self.runs[ends[0] : ends[-1]]
        some.first_run = [end - ends[0] for end in ends]
        own = (self._trace >= first) & (self._trace < last)
        some._recording, some._trace = self._recording[own], self._trace[own] - first
        some.finer = self.finer[first:last]
        return some

    def with_finer(self, finer: Sequence[int]) -> "Replays":
        """Replays that take several steps for one, for each trace a number."""
        some = copy(self)
        some.finer = list(finer)
        return some

    def values(self, models: Sequence[Model], step_s: float) -> FloatArray:
        """(n, rows, c) simulated values of c channels with a time step [s]."""
        shape = len(models), len(self._recording), len(self._channels.names)
        predicted = np.empty(shape)
        for rows, runs, acting, finer in self.together(models):
            for limb in self._limbs:
                felt = [limb.felt(model) for model in acting]
                number = {model: i for i, model in enumerate(dict.fromkeys(felt))}
                own, columns = limb.channels(self._channels)
                fine_s = max(step_s / finer, min(step_s, SHORTEST_S))
                found = self._of_limb(limb, runs, list(number), fine_s, own)
                place = np.ix_(np.arange(len(models)), rows, np.array(columns))
                predicted[place] = found[[number[model] for model in felt]]
        return predicted

    def together(
        self, models: Sequence[Model]
    ) -> Iterator[tuple[BoolArray, list[Run], list[Model], int]]:
        """Yield groups of recordings, and the effects of the models that act in them.

        Recordings are simulated together unless an effect acts in one of them only, or
        steps must be finer in some. A group is given by its rows (rows,) and windows;
        the last item is by how much its steps are finer.
        """
        alone = {one.recording for model in models for one in model} - {None}
        rest = {str(name) for name in np.unique(self._recording)} - alone
        groups = (rest, *({one} for one in sorted(map(str, alone))))
        windows = np.repeat(self.finer, np.diff(self.first_run)).tolist()
        rows = np.array(self.finer)[self._trace]
        for group, finer in itertools.product(groups, sorted(set(self.finer))):
            runs = [
                run
                for run, own in zip(self.runs, windows, strict=True)
                if run.trace.recording in group and own == finer
            ]
            if runs:
                yield (
                    np.isin(self._recording, list(group)) & (rows == finer),
                    runs,
                    [
                        tuple(one for one in model if one.recording in (None, *group))
                        for model in models
                    ],
                    finer,
                )

    def warming(self) -> BoolArray:
        """(rows,) whether errors in a row do not count: at starts, in short windows."""
        flags = []
        for run in self.runs:
            since_s = (run.trace.time_s - run.trace.time_s[0])[run.trace.compared]
            whole = window_s(self._plant, run.trace) is None
            left_over = is_left_over(self._plant, run.trace)
            flags.append(since_s < WARM_UP_S if whole else (since_s <= 0) | left_over)
        return np.concatenate(flags)

    def start_errors(self, model: Model, step_s: float) -> FloatArray:
        """(k, rows, c) changes of simulated values by wrong start states.

        Each is by one joint's position or velocity that is wrong by one standard
        deviation, with the effects of a model that act in all recordings.
        """
        lasting = tuple(one for one in model if one.recording is None)
        variants = variants_of(self._plant, [lasting])
        columns = np.arange(len(self._channels.names))
        # joints of different limbs do not move each other, so they share a simulation
        limbs = [one.columns for one in self._limbs]
        groups = [
            [column for column in same if column is not None]
            for same in itertools.zip_longest(*limbs)
        ]
        every = [self.runs, *nudged(self.runs, groups)]
        most = _batch(self.runs)
        parts = [
            self._stacked(list(itertools.chain(*every[i : i + most])), variants, step_s)
            for i in range(0, len(every), most)
        ]
        plain, *moved = np.split(np.concatenate(parts), len(every))
        spreads = np.repeat(np.divide(SPREADS, STEPS), len(groups))
        own = [limb.channels(self._channels)[1] for limb in self._limbs]
        return np.stack(
            [
                np.where(np.isin(columns, mine), (other - plain) * spread, 0.0)
                for other, spread in zip(moved, spreads, strict=True)
                for mine in own
            ]
        )

    def _stacked(
        self, runs: Sequence[Run], variants: Variants, step_s: float
    ) -> FloatArray:
        """(rows, c) simulated values of all windows, one after the other."""
        results = replay(runs, variants, step_s, self._threads)
        return np.concatenate(
            [
                stacked(one, self._channels)[0, run.trace.compared]
                for one, run in zip(results, runs, strict=True)
            ]
        )

    def _of_limb(
        self,
        limb: Limb,
        some: Sequence[Run],
        models: Sequence[Model],
        step_s: float,
        own: Channels,
    ) -> FloatArray:
        """(n, rows of the runs, channels of the limb) simulated values, in batches."""
        runs = [limb.run(run) for run in some]
        most, parts = _batch(runs), []
        for first in range(0, len(models), most):
            variants = variants_of(limb.plant, models[first : first + most])
            results = replay(runs, variants, step_s, self._threads)
            stacks = [
                stacked(one, own)[:, run.trace.compared]
                for one, run in zip(results, runs, strict=True)
            ]
            parts.append(np.concatenate(stacks, axis=1))
        return np.concatenate(parts)


def _batch(runs: Sequence[Run]) -> int:
    """How many times windows are simulated in one batch."""
    values = sum(run.trace.ticks * len(run.position_rad) for run in runs)
    return max(1, min(MOST_ROWS // len(runs), MOST_VALUES // values))


def time_blocks(traces: Sequence[Trace], length_s: float) -> IntArray:
    """(rows,) number of the time block of each row that is compared.

    No block is in two recordings.
    """
    numbers = [
        (trace.time_s[trace.compared] - trace.time_s[0]) // length_s + 1000 * i
        for i, trace in enumerate(traces)
    ]
    return np.unique(np.concatenate(numbers), return_inverse=True)[1]


def variants_of(plant: Plant, models: Sequence[Model]) -> Variants:
    """Model fields, servos and forces with which a batch simulates n models."""
    variants = Variants(plant, len(models))
    for row, model in enumerate(models):
        for placed in model:
            values = np.array(placed.values)
            effect(placed.name).apply(variants, row, placed.place, values)
    return variants

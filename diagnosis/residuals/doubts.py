"""What makes a residual no evidence of missing physics.

Clocks jitter, simulations start from states that are measured with noise, healthy
robots differ from their models, and models have small mismatch. What each of these can
explain is taken out of residuals, by whitening them with its covariance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.effects.library import keys_within
from diagnosis.residuals.reference_noise import Block, ReferenceNoise
from diagnosis.residuals.replays import Model
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from diagnosis.residuals.start_state import StartUncertainty
from diagnosis.residuals.timing.clock import ClockNoise
from diagnosis.residuals.timing.command_timing import CommandTiming
from diagnosis.residuals.tolerance import Tolerance
from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Doubts:
    """What is taken out of residuals; None stands for nothing.

    Attributes:
      trust: (rows, c) weights, below 1 where models leave more than in most recordings.
      clock: jitter of the time stamps.
      commands: when commands jump, if that is not known for the same reason.
      start: wrong start states.
      noise: errors that recordings of the healthy robot show, in the rows of `blocks`.
      nuisance: likely small mismatch of the nominal model, which is in simulations.
      tolerance: other small mismatch, which is possible around it, and other values of
        the effects that the healthy robot has.
      old: (p, N) what each of these values changes in residuals, in scaled
        coordinates.
    """

    trust: FloatArray | None = None
    clock: ClockNoise | None = None
    commands: CommandTiming | None = None
    start: StartUncertainty | None = None
    noise: ReferenceNoise | None = None
    blocks: Sequence[Block] = ()
    nuisance: Nuisance | None = None
    tolerance: Tolerance | None = None
    old: FloatArray | None = None

    def given(self, model: Model) -> Model:
        """The model, what recordings of the healthy robot show, and small mismatch."""
        given = self.noise.model if self.noise else ()
        if self.nuisance is not None:
            given = (*given, *self.nuisance.beside(keys_within(model)))
        return (*given, *model)

    def timed(self, wrong: FloatArray) -> FloatArray:
        """(n, rows, c) errors with their weights, whitened with those of the clock."""
        wrong = wrong if self.trust is None else wrong * self.trust
        wrong = wrong if self.clock is None else self.clock.without(wrong)
        return wrong if self.commands is None else self.commands.without(wrong)

    def without(self, wrong: FloatArray, models: Sequence[Model]) -> FloatArray:
        """(n, N) errors (n, rows, c) of n models without what is no evidence."""
        flat = self.before_tolerance(wrong)
        if self.tolerance is None:
            return flat
        known = [self.tolerance.taken_back(keys_within(one)) for one in models]
        return self.tolerance.without(flat - np.array(known))

    def before_tolerance(self, wrong: FloatArray) -> FloatArray:
        """(n, N) errors (n, rows, c) without what is no matter of tolerance."""
        wrong = self.timed(wrong)
        if self.start is not None:
            wrong = self.start.without(wrong)
        if self.noise is not None:
            wrong = self.noise.without(wrong, self.blocks)
        return wrong.reshape(len(wrong), -1)

    @property
    def is_known(self) -> bool:
        """Whether recordings of the healthy robot say how large small mismatch is."""
        return self.noise is not None and self.noise.spread is not None

    @property
    def taken(self) -> float:
        """Number of a residual's squares that whitening takes out of noise."""
        every = self.commands, self.start, self.tolerance
        return sum(one.taken for one in every if one is not None)

    def part(
        self, whole: "Doubts", entries: slice, traces: slice, runs: slice
    ) -> "Doubts":
        """What is taken out of some `entries` of a residual of a `whole`.

        These are of some of its recordings (`traces`), in some of its windows (`runs`).
        Weights, clock, noise and blocks are one's own.
        """
        commands = whole.commands and whole.commands.part(traces)
        start = whole.start and whole.start.part(runs.start, runs.stop)
        nuisance = whole.nuisance and whole.nuisance.part(entries)
        tolerance = whole.tolerance and whole.tolerance.part(entries)
        old = None if whole.old is None else whole.old[:, entries]
        some = replace(self, commands=commands, start=start, old=old)
        return replace(some, nuisance=nuisance, tolerance=tolerance)

    def taking(self, nuisance: Nuisance, beyond: Tolerance) -> "Doubts":
        """With likely small mismatch, and what is possible around it or `beyond`."""
        spread = self.noise.spread if self.noise else None
        tolerance = nuisance.tolerance(spread, self.old).and_of(beyond)
        return replace(self, nuisance=nuisance, tolerance=tolerance)

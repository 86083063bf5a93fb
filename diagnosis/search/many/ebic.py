"""Compares models of different size by the extended Bayesian information criterion.

Chen and Chen 2008, "Extended Bayesian information criteria for model selection with
large model spaces": each value costs half the logarithm of the sample size, each choice
among candidates the logarithm of their number. The sample size is the number of
independent blocks of time, since no robot model is exact and its errors last; and the
noise is as large as a model leaves it, for the same reason.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import (
    is_everywhere,
    kinds_of,
    motors,
    number_of_values,
)
from diagnosis.search.chance import independent_samples
from diagnosis.search.judging import places_of_effects
from diagnosis.search.many.repeats import design_effect
from diagnosis.search.result import Judged
from groundwalk.arrays import FloatArray


@dataclass(frozen=True)
class Ebic:
    """The criterion for models of the same recordings.

    Attributes:
      samples: number of independent samples in all recordings.
      candidates: number of effects at their places that could be tried.
      joints: number of the robot's joints.
      rows: number of rows of the fitting data, at any of which something may begin.
      alike: sets of joints with the same motor.
    """

    samples: float
    candidates: int
    joints: int
    rows: int = 1
    alike: frozenset[frozenset[str]] = frozenset()

    @classmethod
    def of(
        cls,
        fit: Predictor,
        select: Predictor,
        residual: FloatArray,
        repeats: bool = True,
    ) -> "Ebic":
        """The criterion where a model leaves an (N,) residual of the fitting data.

        The selection data count as well, with as long blocks. Errors that come again
        count each time if they may be `repeats`, otherwise once.
        """
        both = fit.scored.sum() + select.scored.sum()
        counted = float(independent_samples(fit, residual))
        if not repeats:
            counted /= design_effect(fit, residual)
        samples = float(counted * both / fit.scored.sum())
        rows = sum(trace.ticks for trace in fit.traces)
        kinds = motors(fit.plant)
        alike = frozenset(
            frozenset(joint for joint, own in kinds.items() if own == kind)
            for kind in kinds.values()
        )
        joints = len(fit.plant.joints)
        return cls(samples, places_of_effects(fit), joints, rows, alike)

    def score(self, judged: Judged) -> float:
        """The criterion [nats] of a model: the smaller, the better."""
        fitted = 0.5 * self.samples * float(np.log(max(judged.energy, 1e-12)))
        return fitted + self.price(judged.model)

    def prefers(self, judged: Judged, other: Judged) -> bool:
        """Whether a model is better than another one."""
        return self.score(judged) < self.score(other)

    def nats(self, gain: float, judged: Judged) -> float:
        """A loss of energy of the fitting data, in nats of independent samples."""
        energy = judged.fit.energy
        return self.nats_between(energy + gain, energy)

    def nats_between(self, before: float, after: float) -> float:
        """A fall of the energy of some data, in nats of independent samples."""
        ratio = max(before, 1e-12) / max(after, 1e-12)
        return 0.5 * self.samples * float(np.log(ratio))

    def price(self, model: Model) -> float:
        """What a model costs [nats]: its values, and its choices among candidates.

        A kind of effect at half of all joints or more is one choice: that of the kind.
        So are effects that share a value at all joints with the same motor, but not at
        some that were chosen. What does not last was chosen among all times as well,
        and rare effects need more evidence.
        """
        value = 0.5 * np.log(self.samples)
        choices, rare = 0, 0.0
        for name in {placed.name for placed in model}:
            own = tuple(placed for placed in model if placed.name == name)
            count = sum(map(self._choices, kinds_of(own, self.joints)))
            choices += count
            rare += count * effect(name).rarity_nats
            rare += count * np.log(self.rows) if effect(name).timed else 0.0
        return float(
            value * number_of_values(model) + choices * np.log(self.candidates) + rare
        )

    def _choices(self, group: Model) -> int:
        """Number of choices by which effects of one kind got to their places."""
        places = frozenset(placed.place for placed in group)
        chosen = not (is_everywhere(len(places), self.joints) or places in self.alike)
        return len(places) if chosen else 1

    def price_within(self, model: Model, group: Model) -> float:
        """What some effects add to the price [nats] of the model that has them."""
        keys = {placed.key for placed in group}
        rest = tuple(placed for placed in model if placed.key not in keys)
        return self.price(model) - self.price(rest)

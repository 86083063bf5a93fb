"""The result of a search: fitted models, and how plausible each one is."""

from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Model
from diagnosis.search.fitting import FittedModel


@dataclass(frozen=True, eq=False)
class Judged:
    """A fitted model and how well it explains fitting and selection data.

    Attributes:
      fit: the model, fitted to the fitting data.
      selected: energy on the selection data [nats]: minus the log-likelihood.
      weight: 1 where the fitting data count in comparisons with other models, 0 where
        gains there may be chance.
    """

    fit: FittedModel
    selected: float
    weight: float = 0.0

    @property
    def model(self) -> Model:
        """The effects with their values."""
        return self.fit.model

    @property
    def energy(self) -> float:
        """Energy on the fitting and the selection data together [nats]."""
        return self.fit.energy + self.selected

    @property
    def evidence(self) -> float:
        """Energy on the data that count in comparisons with other models [nats]."""
        return self.energy if self.weight else self.selected

    @property
    def keys(self) -> frozenset[str]:
        """Effects and places of the model, without values."""
        return keys_of(self.model)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The best models that a search has found, and how many effects it believes.

    Attributes:
      nothing: energy of the nominal sim on the selection data [nats].
      floor: energy that noise alone leaves on the selection data [nats].
      best: the best models of each number of effects, the best first.
      chosen: the number of effects that are believed.
      nothing_fit: energy of the nominal sim on the fitting data [nats].
      floor_fit: energy that noise alone leaves on the fitting data [nats].
    """

    nothing: float
    floor: float
    best: dict[int, list[Judged]]
    chosen: int
    nothing_fit: float = 0.0
    floor_fit: float = 0.0

    @property
    def winner(self) -> Judged | None:
        """The model that is believed; None for the nominal sim."""
        return self.best[self.chosen][0] if self.chosen else None

    def worse(self, judged: Judged) -> float:
        """How much less plausible than the winner a model of its size is [nats]."""
        assert self.winner is not None
        floor = self.floor + self.winner.weight * self.floor_fit
        scale = scale_of(self.best[self.chosen], floor)
        return plausibility(judged, scale) - plausibility(self.winner, scale)

    def closed(self, judged: Judged) -> float:
        """Share of the nominal sim's energy above the noise that a model removes.

        The larger of two shares, that of the selection data and that of all data: an
        effect such as an end stop may show in the fitting data only, and a robot that
        falls may fall in many ways there.
        """
        excess, gained = self.nothing - self.floor, self.nothing - judged.selected
        more = self.nothing_fit - self.floor_fit, self.nothing_fit - judged.fit.energy
        shares = (gained, excess), (gained + more[1], excess + more[0])
        return max((a / b for a, b in shares if b > 0), default=0.0)


def keys_of(model: Model) -> frozenset[str]:
    """The set of effects and places of a model, without values."""
    return frozenset(placed.key for placed in model)


VALUE_NATS = 2.0
"""Penalty for each value of a model [nats]."""


def plausibility(judged: Judged, scale: float) -> float:
    """How implausible a model is [nats]: its energy plus penalties.

    Rare effects and additional values are penalised.

    Args:
      judged: the model.
      scale: energy of the best model divided by that of the noise, at least 1. Where no
        model is exact, residuals exceed the noise and differences count less.
    """
    return judged.evidence / scale + sum(
        effect(placed.name).rarity_nats + VALUE_NATS * len(placed.values)
        for placed in judged.model
    )


def scale_of(judged: Sequence[Judged], floor: float) -> float:
    """Energy of the best model divided by that of the noise, at least 1.

    Args:
      judged: models.
      floor: energy that noise alone leaves on the data of their evidence [nats].
    """
    least = min((one.evidence for one in judged), default=floor)
    return max(least / floor, 1.0) if floor > 0 else 1.0


def ranked(judged: Sequence[Judged], floor: float) -> list[Judged]:
    """Models in the order of their plausibility, the most plausible first.

    Args:
      judged: models.
      floor: energy that noise alone leaves on the data of their evidence [nats].
    """
    scale = scale_of(judged, floor)
    return sorted(judged, key=lambda one: plausibility(one, scale))

"""What a search goes by, and what it comes to."""

from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.residuals.predictor import Model
from diagnosis.search.fitting import Fit


@dataclass(frozen=True)
class Rules:
    """How far the search looks, and when it believes.

    Attributes:
      singles: effects alone that are fitted ...
      others: ... of which so many are effects that are not among the best guesses.
      beam: models that grow further.
      growths: ways in which each of them grows.
      pairs: pairs that promise most at first order, which are fitted.
      first_steps: of a fit, after which most models are given up ...
      finished: ... but for so many ...
      far: ... that are behind by no more than this share of what the best explains.
      rounds: of refinement, as another model may then be the best.
      compared: models that are compared with the integrator's error of each.
      swaps: effects that are tried in the stead of each one of the best model.
      largest: effects in a model.
      suspicious: times the noise's energy: so much is looked at in pairs, even if no
        effect alone is of use; below it a search ends ...
      promising: ... where no guess gains this part of the least gain.
      least_gain: log-likelihood that an effect must gain on the selection data.
      least_hint: the same for one that gains much more on the fitting data ...
      alone: ... unless it gains so many times the least there: then it must not cost
        that much.
      least_pattern: and as much as a pattern of this rms [noise] would: below it is
        what integrators and clocks do wrong.
      least_share: and this share of the energy above the noise that the best model so
        far leaves ...
      unsure_floor: ... as far as that is more than this part of the noise's own.
      least_of_all: and this share of what the plant alone leaves.
    """

    singles: int = 12
    others: int = 4
    beam: int = 3
    growths: int = 4
    pairs: int = 8
    first_steps: int = 3
    finished: int = 10
    far: float = 0.5
    rounds: int = 4
    compared: int = 8
    swaps: int = 6
    largest: int = 3
    suspicious: float = 1.5
    promising: float = 0.5
    least_gain: float = 15.0
    least_hint: float = 3.0
    alone: float = 4.0
    least_pattern: float = 0.15
    least_share: float = 0.3
    unsure_floor: float = 0.1
    least_of_all: float = 0.0001


@dataclass(frozen=True, eq=False)
class Judged:
    """A fitted model and how well it does on both kinds of data.

    Attributes:
      fit: on the fitting data.
      selected: energy on the selection data: minus the log-likelihood.
      weight: of the fitting data beside them, where models are compared that may gain
        something there by chance only: 0 or 1.
    """

    fit: Fit
    selected: float
    weight: float = 0.0

    @property
    def model(self) -> Model:
        """The effects."""
        return self.fit.model

    @property
    def energy(self) -> float:
        """On fitting and selection data together."""
        return self.fit.energy + self.selected

    @property
    def evidence(self) -> float:
        """Energy on the data by which it is compared with others."""
        return self.energy if self.weight else self.selected

    @property
    def keys(self) -> frozenset[str]:
        """Effects and places, without values."""
        return keys_of(self.model)


@dataclass(frozen=True, eq=False)
class Found:
    """What a search came to.

    Attributes:
      nothing: energy of the plant alone on the selection data.
      floor: energy that noise alone would leave there.
      best: the models of each size that do best, the best first.
      chosen: how many effects are believed.
      nothing_fit: as `nothing`, on the fitting data.
      floor_fit: as `floor`, likewise.
    """

    nothing: float
    floor: float
    best: dict[int, list[Judged]]
    chosen: int
    nothing_fit: float = 0.0
    floor_fit: float = 0.0

    @property
    def winner(self) -> Judged | None:
        """The model that is believed; None for the plant alone."""
        return self.best[self.chosen][0] if self.chosen else None

    def worse(self, judged: Judged) -> float:
        """Nats by which a model of the chosen size is less plausible than the best."""
        assert self.winner is not None
        floor = self.floor + self.winner.weight * self.floor_fit
        scale = scale_of(self.best[self.chosen], floor)
        return plausibility(judged, scale) - plausibility(self.winner, scale)

    def closed(self, judged: Judged) -> float:
        """Share of the energy above the noise that a model takes away.

        Of the selection data, or of all: what an effect does may show in the fitting
        data only, such as a stop that the joint does not reach in the others; and a
        robot that falls may do so in many ways there.
        """
        excess, gained = self.nothing - self.floor, self.nothing - judged.selected
        more = self.nothing_fit - self.floor_fit, self.nothing_fit - judged.fit.energy
        shares = (gained, excess), (gained + more[1], excess + more[0])
        return max((a / b for a, b in shares if b > 0), default=0.0)


def keys_of(model: Model) -> frozenset[str]:
    """Effects and places of a model, without values."""
    return frozenset(placed.key for placed in model)


RARE_NATS = {
    "drag": 3.0,
    "servo_damping": 2.0,
    "sensor_delay": 1.0,
    "servo_fade": 1.0,
    "com_offset": 1.0,
    "external_force": 3.0,
    "uneven_ground": 10.0,
}
"""What is seldom the matter must fit better by so much than what often is. Uneven
ground lies wherever each sole stood, which are as many values as it was put down."""

VALUE_NATS = 2.0
"""So must what has more values."""


def plausibility(judged: Judged, scale: float) -> float:
    """The evidence's energy, more for what is rare or has many values.

    Args:
      judged: a model.
      scale: energy of the best model over that of the noise, at least 1: where no model
        is exact, residuals are larger than the noise and tell less.
    """
    return judged.evidence / scale + sum(
        RARE_NATS.get(placed.name, 0.0) + VALUE_NATS * len(placed.values)
        for placed in judged.model
    )


def scale_of(judged: Sequence[Judged], floor: float) -> float:
    """How much larger than the noise's energy that of the best model is."""
    least = min((one.evidence for one in judged), default=floor)
    return max(least / floor, 1.0) if floor > 0 else 1.0


def ranked(judged: Sequence[Judged], floor: float) -> list[Judged]:
    """The most plausible first.

    Args:
      judged: models.
      floor: energy that noise alone would leave of the evidence.
    """
    scale = scale_of(judged, floor)
    return sorted(judged, key=lambda one: plausibility(one, scale))

"""The result of a search: fitted models, how plausible each is, and their storage."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.ties import number_of_values
from diagnosis.search.fitting import FittedModel
from diagnosis.search.hooks import Saved


@dataclass(frozen=True, eq=False)
class Judged:
    """A fitted model and how well it explains fitting and selection data.

    `selected` is its energy (minus the log-likelihood) on the selection data [nats];
    `weight` is 1 if the fitting data count in comparisons, 0 if gains there may be
    chance.
    """

    fit: FittedModel
    selected: float
    weight: float = 0.0

    @property
    def model(self) -> Model:
        """The model's effects with their values."""
        return self.fit.model

    @property
    def energy(self) -> float:
        """Minus the log-likelihood of fitting and selection data together [nats]."""
        return self.fit.energy + self.selected

    @property
    def evidence(self) -> float:
        """Minus the log-likelihood of the data that count in comparisons [nats]."""
        return self.energy if self.weight else self.selected

    @property
    def keys(self) -> frozenset[str]:
        """The model's effects and places as "effect@place", without values."""
        return keys_of(self.model)


MOST_LEFT = 0.5
"""If the error energy that remains exceeds that of the noise by at most this share of
it, hardly more than noise remains, and the verdict is not `unknown`."""


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The best models that a search has found, and how many effects it believes.

    An energy is half the sum of squared residuals in units of noise.

    Attributes:
      nothing, nothing_fit: the nominal sim's on selection and fitting data [nats].
      floor, floor_fit: those that noise alone leaves [nats].
      best: the best models of each number of effects, the best first.
      chosen: the number of effects that are believed.
      most_left: share of the noise's energy by which more may be left and still hardly
        be more than noise.
      correlated: what chance gains as a multiple of what it does in independent noise;
        so many nats of energy count as one.
    """

    nothing: float
    floor: float
    best: dict[int, list[Judged]]
    chosen: int
    nothing_fit: float = 0.0
    floor_fit: float = 0.0
    most_left: float = MOST_LEFT
    correlated: float = 1.0

    @property
    def winner(self) -> Judged | None:
        """The model that is believed; None for the nominal sim."""
        return self.best[self.chosen][0] if self.chosen else None

    def with_models(self, size: int, judged: list[Judged]) -> "SearchResult":
        """The result with other models of one number of effects, the best first."""
        return replace(self, best={**self.best, size: judged})

    def worse(self, judged: Judged) -> float:
        """How much less plausible than the winner an equally large model is [nats]."""
        assert self.winner is not None
        floor = self.floor + self.winner.weight * self.floor_fit
        scale = scale_of(self.best[self.chosen], floor, self.correlated)
        return plausibility(judged, scale) - plausibility(self.winner, scale)

    def closed(self, judged: Judged) -> float:
        """Share of the nominal sim's energy above the noise that a model removes.

        The larger one of the shares on the selection data and on fitting and selection
        data: an effect such as an end stop may show in the fitting data only, and a
        robot may fall in many ways there. At most 1: tolerances explain noise, too.
        """
        excess, gained = self.nothing - self.floor, self.nothing - judged.selected
        more = self.nothing_fit - self.floor_fit, self.nothing_fit - judged.fit.energy
        shares = (gained, excess), (gained + more[1], excess + more[0])
        return min(max((a / b for a, b in shares if b > 0), default=0.0), 1.0)

    def leaves_much(self, least_closed: float) -> bool:
        """Whether more than noise is left, and less than a share is removed."""
        selected, fitted, closed = self.nothing, self.nothing_fit, 0.0
        if self.winner:
            selected, fitted = self.winner.selected, self.winner.fit.energy
            closed = self.closed(self.winner)
        much = selected > (1 + self.most_left) * self.floor
        much |= fitted > (1 + self.most_left) * self.floor_fit
        return bool(much and closed < least_closed)


def keys_of(model: Model) -> frozenset[str]:
    """The effects and places of a model as "effect@place", without values."""
    return frozenset(placed.key for placed in model)


VALUE_NATS = 2.0
"""Penalty [nats] for each value (fitted number) of a model when models are compared."""


def plausibility(judged: Judged, scale: float) -> float:
    """The implausibility of a model [nats]: lower is more plausible.

    It is minus the log-likelihood, plus penalties for rare effects and for each value.
    `scale` divides the log-likelihood: if no model is exact, or what is left lasts from
    row to row, differences count less.
    """
    rarity = sum(effect(placed.name).rarity_nats for placed in judged.model)
    return (
        judged.evidence / scale + rarity + VALUE_NATS * number_of_values(judged.model)
    )


def scale_of(judged: Sequence[Judged], floor: float, correlated: float = 1.0) -> float:
    """Energy [nats] that counts as one nat, at least 1.

    That is the energy of the best model divided by `floor`, that of the noise, or what
    chance gains as a multiple of that in independent noise (`correlated`), if larger:
    it grows with the energy, too.
    """
    least = min((one.evidence for one in judged), default=floor)
    return max(least / floor, correlated, 1.0) if floor > 0 else max(correlated, 1.0)


def ranked(
    judged: Sequence[Judged], floor: float, correlated: float = 1.0
) -> list[Judged]:
    """Models, the most plausible first; `floor` is the noise's energy [nats].

    So many nats as `correlated` says count as one, see `scale_of`.
    """
    scale = scale_of(judged, floor, correlated)
    return sorted(judged, key=lambda one: plausibility(one, scale))


def pack(judged: Sequence[Judged]) -> Saved:
    """Convert judged models to the form that a checkpoint stores."""
    models = [
        {"model": _plain(each.model), "selected": each.selected, "weight": each.weight}
        for each in judged
    ]
    arrays = {
        f"{name}{i}": getattr(each.fit, name)
        for i, each in enumerate(judged)
        for name in ("residual", "jacobian")
    }
    return Saved(models, arrays)


def unpack(saved: Saved, plant: Plant) -> list[Judged]:
    """Restore judged models that `pack` has converted, exact to the last digit."""
    judged = []
    for i, one in enumerate(saved.plain):
        model = _model(one["model"])
        residual, jacobian = (saved.arrays[f"{k}{i}"] for k in ("residual", "jacobian"))
        fit = FittedModel(model, residual, jacobian, Coordinates(plant, model))
        judged.append(Judged(fit, one["selected"], one["weight"]))
    return judged


def pack_noise(noise: ReferenceNoise) -> Saved:
    """Convert model errors of the healthy robot to the form a checkpoint stores."""
    names = ("scale", "power", "axes")
    arrays = {name: getattr(noise, name) for name in names}
    if noise.spread is not None:
        arrays["spread"] = noise.spread
    plain = {"model": _plain(noise.model), "found": _plain(noise.found)}
    return Saved({**plain, "rows": noise.rows}, arrays)


def unpack_noise(saved: Saved) -> ReferenceNoise:
    """Restore noise that `pack_noise` has converted, exact to the last digit."""
    arrays = saved.arrays
    return ReferenceNoise(
        _model(saved.plain["model"]),
        arrays["scale"],
        arrays["power"],
        arrays["axes"],
        saved.plain["rows"],
        arrays.get("spread"),
        found=_model(saved.plain.get("found", [])),  # none in older checkpoints
    )


def _plain(model: Model) -> list[list[Any]]:
    """A model as lists [effect, place, values, recording, tied], one for each."""
    return [
        [one.name, one.place, list(one.values), one.recording, one.tied]
        for one in model
    ]


def _model(plain: list[list[Any]]) -> Model:
    """A model from lists [effect, place, values, recording, tied]."""
    return tuple(
        PlacedEffect(name, place, tuple(values), recording, tied)
        for name, place, values, recording, tied in plain
    )

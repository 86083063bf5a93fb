"""Two controls: the right physics elsewhere, and other physics at the right place."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import all_effects, effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import FittedModel, fit_all

MOST = 4
STEPS = 4


@dataclass(frozen=True, eq=False)
class Controls:
    """What a model would be without its main effect, and with another in its stead.

    Attributes:
      without: the other effects, refitted.
      wrong_place: with the same effect at the other place that does best; None where it
        has no other.
      wrong_effect: with another effect at the same place, drawn by lot; None where no
        other can be there.
    """

    without: Model
    wrong_place: Model | None
    wrong_effect: Model | None

    @classmethod
    def of(
        cls,
        predictor: Predictor,
        model: Model,
        alike: Collection[str],
        rng: np.random.Generator,
    ) -> "Controls":
        """FittedModel all of them.

        Args:
          predictor: of the data to fit to.
          model: that is believed, of one effect at least.
          alike: "effect@place" of what explains the same; that is no control.
          rng: draws the lot.
        """
        main, rest = _main(predictor, model)
        return cls(
            rest,
            _best(predictor, rest, _elsewhere(predictor, main)),
            _best(predictor, rest, _by_lot(predictor, main, rest, alike, rng)),
        )


def _main(predictor: Predictor, model: Model) -> tuple[PlacedEffect, Model]:
    """The effect without which most is left, and the others without it."""
    if len(model) == 1:
        return model[0], ()
    rests = [tuple(one for one in model if one is not main) for main in model]
    fits = _fitted(predictor, rests)
    worst = max(range(len(model)), key=lambda i: fits[i].energy)
    return model[worst], fits[worst].model


def _elsewhere(predictor: Predictor, main: PlacedEffect) -> list[PlacedEffect]:
    return [
        PlacedEffect(main.name, place, main.values)
        for place in effect(main.name).places(predictor.plant, predictor.traces)
        if place != main.place
    ]


def _by_lot(
    predictor: Predictor,
    main: PlacedEffect,
    rest: Model,
    alike: Collection[str],
    rng: np.random.Generator,
) -> list[PlacedEffect]:
    """One of the effects that can be there, of typical size; none if there is none.

    With as many values as the main one, if there are such.
    """
    plant, traces = predictor.plant, predictor.traces
    others = [
        PlacedEffect(
            name,
            main.place,
            tuple(p.typical for p in kind.parameters(plant, main.place)),
        )
        for name, kind in all_effects().items()
        if main.place in kind.places(plant, traces)
    ]
    barred = {main.key, *alike, *(one.key for one in rest)}
    others = [
        one
        for one in others
        if not (one.key in barred or _contains(one, main) or _contains(main, one))
    ]
    equal = [one for one in others if len(one.values) == len(main.values)]
    choice = equal or others
    return [choice[int(rng.integers(len(choice)))]] if choice else []


def _contains(one: PlacedEffect, other: PlacedEffect) -> bool:
    return one.key in (grown.key for grown in grown_from(other))


def _best(
    predictor: Predictor, rest: Model, options: list[PlacedEffect]
) -> Model | None:
    """With the option that fits best, of those that first look best."""
    taken = {placed.key for placed in rest}
    models = [(*rest, one) for one in options if one.key not in taken]
    if not models:
        return None
    energies = (predictor.residuals(models) ** 2).sum(axis=1)
    likely = [models[int(i)] for i in np.argsort(energies)[:MOST]]
    return min(_fitted(predictor, likely), key=lambda fit: fit.energy).model


def _fitted(predictor: Predictor, models: list[Model]) -> list[FittedModel]:
    return fit_all(predictor, models, STEPS, followed=True)

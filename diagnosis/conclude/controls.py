"""Wrong models (controls) that must predict held-out recordings worse than a diagnosis.

The main effect of a model is left out, moved to the best other place, or replaced by
another one at its place.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import all_effects, containing, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of, without_each
from diagnosis.search.fitting import FittedModel, fit_all

MOST = 4
"""Number of wrong models that are fitted to find the best one: those with the smallest
errors before the fit."""

STEPS = 4
"""Most steps of the fit of a wrong model, enough for a comparison."""

AT_ONCE = 8
"""Number of models with many effects that are fitted side by side, to limit memory."""


def controls_of(
    predictor: Predictor, model: Model, alike: Collection[str], rng: np.random.Generator
) -> dict[str, Model | None]:
    """Fit models that differ from the one found in its main effect.

    The main effect is the one whose removal increases the error most.

    Effects `alike`, keys "effect@place", may be the truth as well and are no controls.

    Returns:
      "without": the other effects alone; "wrong_place": the main effect moved to the
      best other place; "wrong_effect": it is replaced by another one at the same place,
      chosen at random. None if there is no such model.
    """
    main, rest = _main(predictor, model)
    places = effect(main.name).places(predictor.plant, predictor.traces)
    own = {one.place for one in next(one for one in groups_of(model) if main in one)}
    moved = [replace(main, place=place) for place in places if place not in own]
    other = _by_lot(predictor, main, rest, alike, rng)
    return {
        "without": rest,
        "wrong_place": _best(predictor, rest, moved),
        "wrong_effect": _best(predictor, rest, other),
    }


def _main(predictor: Predictor, model: Model) -> tuple[PlacedEffect, Model]:
    """The effect whose removal increases the error most, and the others refitted."""
    if len(model) == 1:
        return model[0], ()
    smaller = without_each(model)
    (whole,) = fit_all(predictor, [model], 1)
    left = list[tuple[float, Model]]()
    for first in range(0, len(smaller), AT_ONCE):
        some = smaller[first : first + AT_ONCE]
        known = [whole.jacobian_of(one) for one in some]
        fits = fit_all(predictor, some, STEPS, followed=True, jacobians=known)
        left += [(fit.energy, fit.model) for fit in fits]
    worst = max(range(len(smaller)), key=lambda i: left[i][0])
    main = next(one for one in model if one not in smaller[worst])
    return main, left[worst][1]


def _by_lot(
    predictor: Predictor,
    main: PlacedEffect,
    rest: Model,
    alike: Collection[str],
    rng: np.random.Generator,
) -> list[PlacedEffect]:
    """An effect of typical size at the main effect's place, chosen at random, if any.

    Effects with as many values as the main one are preferred.
    """
    plant, traces = predictor.plant, predictor.traces
    barred = {main.key, *alike, *(one.key for one in rest)}
    others = []
    for name, kind in all_effects().items():
        if main.place in kind.places(plant, traces):
            typical = tuple(p.typical for p in kind.parameters(plant, main.place))
            one = PlacedEffect(name, main.place, typical)
            if not (one.key in barred or _contains(one, main) or _contains(main, one)):
                others.append(one)
    equal = [one for one in others if len(one.values) == len(main.values)]
    choice = equal or others
    return [choice[int(rng.integers(len(choice)))]] if choice else []


def _contains(one: PlacedEffect, other: PlacedEffect) -> bool:
    """Whether an effect is a more general form of another."""
    return one.key in containing(other)


def _best(
    predictor: Predictor, rest: Model, options: list[PlacedEffect]
) -> Model | None:
    """The effects `rest` with the option that fits best; None without options."""
    taken = {placed.key for placed in rest}
    models = [(*rest, one) for one in options if one.key not in taken]
    if not models:
        return None
    energies = (predictor.residuals(models) ** 2).sum(axis=1)
    likely = [models[int(i)] for i in np.argsort(energies)[:MOST]]
    return min(_fitted(predictor, likely), key=lambda fit: fit.energy).model


def _fitted(predictor: Predictor, models: list[Model]) -> list[FittedModel]:
    """Models after a few steps of a fit, enough for a comparison."""
    return fit_all(predictor, models, STEPS, followed=True)

"""Two controls: the right physics elsewhere, and other physics at the right place."""

import numpy as np

from diagnosis.effect import Placed
from diagnosis.fitting import fit_all
from diagnosis.library import EFFECTS
from diagnosis.predictor import Model, Predictor
from diagnosis.search_result import Judged, keys_of

MOST = 4


def wrong_places(predictor: Predictor, model: Model) -> Model | None:
    """The same effects at the wrong places that do best, refitted; None if none is."""
    options = [
        tuple(
            Placed(placed.effect, place, placed.values) if other is placed else other
            for other in model
        )
        for placed in model
        for place in EFFECTS[placed.effect].places(predictor.plant, predictor.traces)
        if place != placed.place
    ]
    return _best(predictor, model, options)


def wrong_effects(
    predictor: Predictor, model: Model, tried: list[Judged], confusable: set[str]
) -> Model | None:
    """Other effects at the right places that do best; None if none was tried.

    Args:
      predictor: of the data to fit to.
      model: that is believed.
      tried: other models, already fitted.
      confusable: keys of effects that explain the same; they are no control.
    """
    places = sorted(placed.place for placed in model)
    others = [
        judged.model
        for judged in tried
        if sorted(placed.place for placed in judged.model) == places
        and judged.keys != keys_of(model)
        and not judged.keys & confusable
    ]
    return others[0] if others else None


def _best(predictor: Predictor, model: Model, options: list[Model]) -> Model | None:
    """The option that fits best, of those that first look best."""
    options = [option for option in options if len(keys_of(option)) == len(model)]
    if not options:
        return None
    residuals = predictor.residuals(options)
    order = np.argsort((residuals**2).sum(axis=1))[:MOST]
    fits = fit_all(predictor, [options[int(i)] for i in order], 4, followed=True)
    return min(fits, key=lambda fit: fit.energy).model

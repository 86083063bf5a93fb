"""Models around one, among which simulations differ at random only.

When dry friction lets a joint go, or teeth touch, depends on anything. If the
integration error were measured at one model, what is random there would be taken out of
it and of no other: a fit would not leave it. So it is measured at some around it.
"""

from diagnosis.effects.library import effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.replays import Model

NEARBY = 0.01
"""Relative changes of friction and play: they are to and fro, so that only what is
random differs."""


def models_around(plant: Plant, model: Model) -> list[Model]:
    """Up to four models with slightly other friction and play.

    The model itself where it has neither, and on a floating base.
    """
    if plant.base == "floating":
        return [model]
    near = (NEARBY, 1), (-NEARBY, 1), (NEARBY / 2, 2), (-NEARBY / 2, 2)
    return list(dict.fromkeys(_changed(plant, model, *one) for one in near))


def _changed(plant: Plant, model: Model, far: float, every: int) -> Model:
    """The model with friction and play changed, their signs in turn by `every` few."""
    found = list(model)
    for i, one in enumerate(model):
        kind, factor = effect(one.name), 1 + far * (-1) ** (i // every)
        if kind.jumps or kind.finer > 1:
            found[i] = kind.stretched(plant, one, factor)
    return tuple(found)

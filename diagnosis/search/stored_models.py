"""Converts fitted models and learned noise to a form that a checkpoint can store."""

from collections.abc import Sequence
from typing import Any

from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.search.fitting import Coordinates, FittedModel
from diagnosis.search.hooks import Saved
from diagnosis.search.result import Judged


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
    return Saved({"model": _plain(noise.model), "rows": noise.rows}, arrays)


def unpack_noise(saved: Saved) -> ReferenceNoise:
    """Restore noise that `pack_noise` has converted, exact to the last digit."""
    return ReferenceNoise(
        _model(saved.plain["model"]), rows=saved.plain["rows"], **saved.arrays
    )


def _plain(model: Model) -> list[list[Any]]:
    """A model as lists [effect, place, values], one for each effect."""
    return [[one.name, one.place, list(one.values)] for one in model]


def _model(plain: list[list[Any]]) -> Model:
    """A model from lists [effect, place, values]."""
    return tuple(PlacedEffect(effect, place, tuple(v)) for effect, place, v in plain)

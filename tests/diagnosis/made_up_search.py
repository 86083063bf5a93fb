"""Searches that came to something made up."""

import numpy as np

from diagnosis.effects.parts import PlacedEffect
from diagnosis.search.fitting import Coordinates, FittedModel
from diagnosis.search.result import Judged, SearchResult

VALUES = {
    "viscous_friction": (0.1,),
    "coulomb_friction": (0.1,),
    "servo_gain": (0.8,),
    "armature": (0.01,),
    "payload_mass": (0.1,),
    "stribeck_friction": (0.1, 0.1, 0.1),
    "external_force": (0.0, 0.0, 1.0, 0.5, 0.2),
}


def placed(key):
    """Of "effect@place"."""
    name, place = key.split("@")
    return PlacedEffect(name, place, VALUES[name])


def judged(plant, selected, *keys):
    """A model that leaves so much energy on the selection data."""
    model = tuple(placed(key) for key in keys)
    coordinates = Coordinates(plant, model)
    nothing = np.zeros((1, len(coordinates.parameters)))
    return Judged(FittedModel(model, np.zeros(1), nothing, coordinates), selected)


def found(plant, *models, nothing=1e4, floor=100.0):
    """A search whose models (selected, *keys) are all of the first one's size."""
    every = [judged(plant, *model) for model in models]
    size = len(models[0]) - 1
    return SearchResult(nothing, floor, {size: every}, size)

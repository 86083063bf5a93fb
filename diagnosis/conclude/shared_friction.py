"""One dry friction for all joints, where small mismatch stands for it at several.

Small mismatch of the model holds a little friction of each joint. Where that is surely
there at several joints, it is missing physics: one value for all joints may say it
better than one of each. Both are compared by Laplace's approximation of how probable
the recordings are with each (MacKay 2003, "Information theory, inference, and learning
algorithms", chapter 28).

Only measured torques are asked: friction changes them in proportion, so that the
approximation is good. What it changes in a replay jumps.
"""

import numpy as np

from diagnosis.conclude.nuisance_found import sure_nuisance
from diagnosis.effects.friction import CoulombFriction
from diagnosis.effects.library import effect, keys_within
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.data_sets import DataSets
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import tied
from diagnosis.search.chance import independent_samples
from diagnosis.search.fitting import fit_all
from diagnosis.verdict import Found

FEWEST = 2
"""Fewest joints whose friction is surely there, so that it may be that of all."""


def with_shared_friction(data: DataSets, model: Model, least_gain: float) -> Model:
    """A model, with one dry friction of all joints if that is the likelier account.

    `least_gain` [nats] is what the friction of a joint must explain to be surely there.
    The model is returned as it is where recordings are replayed, or where no small
    mismatch is fitted.
    """
    if not data.learned.by_torque or data.learned.nuisance is None:
        return model
    both, _ = data.calibrated(model)
    _, larger = sure_nuisance(both, model, least_gain)
    sure = [one for one in larger if one.name == CoulombFriction.name]
    if len(sure) < FEWEST:
        return model
    shared = _shared(both, model, sure)
    beside, _ = data.calibrated(shared)
    (fit,) = fit_all(beside.with_tolerances_beside(shared), [shared])
    beside, _ = data.calibrated(fit.model)
    value = 0.5 * float(np.log(independent_samples(both, both.residuals([model])[0])))
    likelier = _energy(beside, fit.model) + value < _energy(both, model)
    return fit.model if likelier else model


def _shared(both: Predictor, model: Model, sure: list[Found]) -> Model:
    """The model, with friction of the median size that is sure at all other joints."""
    size = float(np.median([one.parameters["torque"].value for one in sure]))
    kind, taken = effect(CoulombFriction.name), keys_within(model)
    places = kind.places(both.plant, both.traces)
    every = [PlacedEffect(kind.name, place, (size,)) for place in places]
    free = [one for one in every if one.key not in taken]
    return (*model, *tied(both.plant, free, "all"))


def _energy(both: Predictor, model: Model) -> float:
    """Minus the logarithm [nats] of how probable recordings are, small errors unknown.

    It has the energy of what is left, that of the likeliest errors, and the logarithm
    of the share of usual errors that recordings leave possible. `both` is calibrated
    at the model.
    """
    errors = both.nuisance
    assert errors is not None
    (left,) = both.without_tolerances().residuals([model])
    free = errors.free_of(keys_within(model))
    sizes, products = errors.sizes[free], errors.changes.products()[np.ix_(free, free)]
    spread = float(np.linalg.slogdet(np.eye(len(sizes)) + products)[1])
    return 0.5 * (float(left @ left + sizes @ sizes) + spread)

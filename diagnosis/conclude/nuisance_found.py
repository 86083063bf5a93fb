"""Small mismatch of the nominal model that recordings show for sure."""

import itertools

import numpy as np

from diagnosis.conclude.answer import probability
from diagnosis.conclude.estimates import Z_80, standard_errors
from diagnosis.effects.library import effect, keys_within
from diagnosis.residuals.data_sets import DataSets
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from diagnosis.residuals.small_mismatch.usual_errors import USUAL, value_at
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.judging import gain_of_noise
from diagnosis.verdict import Estimate, Found
from groundwalk.arrays import FloatArray

MOST_UNUSUAL = 3
"""Most joints with unusual friction that a search did not find, and most that are tried
for each."""

LITTLE = 0.03
"""Share of weak friction up to which friction that is found may be the error of the
simulation, which stops joints in steps."""


def sure_nuisance(
    both: Predictor, model: Model, least_gain: float
) -> tuple[tuple[Found, ...], tuple[Found, ...]]:
    """Errors without which the data would be far less likely: small and larger ones.

    `both` is calibrated at a model, with errors of the nominal model fitted beside it.
    Those are returned without which, all others and the model's values being fitted
    again, more energy than `least_gain` [nats] would be left, to first order. What a
    model states is a little wrong in all robots. Dry friction, which it leaves out, is
    missing and not small, unless it is `LITTLE`; viscous friction cannot be told from
    a servo's damping.
    """
    nuisance = both.nuisance
    if nuisance is None:
        return (), ()
    spread = _spread(both, nuisance, model)
    # what chance explains more than in independent noise widens intervals as well
    wider = np.sqrt(max(1.0, least_gain / gain_of_noise(len(spread))))
    taken, sizes = keys_within(model), nuisance.sizes
    small, larger = list[Found](), list[Found]()
    for key, group in itertools.groupby(range(len(sizes)), nuisance.key):
        own = list(group)
        part = spread[np.ix_(own, own)]
        gain = 0.5 * float(sizes[own] @ np.linalg.solve(part, sizes[own]))
        if key in taken or gain < least_gain:
            continue
        deviation = wider * np.sqrt(np.diag(spread)[own])
        unit = nuisance.units[own[0]]
        far = float(np.abs(sizes[own]).max())
        is_small = not effect(unit.name).jumps or far < LITTLE
        found = _found(both, nuisance, own, deviation, None if is_small else gain)
        (small if is_small else larger).append(found)
    return tuple(small), tuple(larger)


def with_unusual_ones(
    data: DataSets, model: Model, least_gain: float
) -> tuple[Model, Predictor, Predictor]:
    """A model with friction that is larger than usual, one joint after the other.

    It may be at more joints than a search has effects. What a model states and has very
    wrong is left to the search, whose selection data must agree. Also returns the
    predictors of learned and of held-out data, calibrated at the model.
    """
    found, sims = model, data.calibrated(model)
    for _ in range(MOST_UNUSUAL):
        larger = _with_unusual_one(sims[0], model, least_gain)
        if larger is None:
            break
        model = larger
    if model != found:
        sims = data.calibrated(model)
    return model, *sims


def _with_unusual_one(both: Predictor, model: Model, least_gain: float) -> Model | None:
    """The model with friction that gains most by being larger than usual, if any."""
    if both.nuisance is None:
        return None
    (left,) = both.without_tolerances().residuals([model])
    taken = keys_within(model)
    options = [
        (placed, gain)
        for placed, gain in both.nuisance.unusual(left)
        if placed.key not in taken
        and not effect(placed.name).tolerance(both.plant, placed.place)
    ]
    options.sort(key=lambda one: -one[1])
    for placed, gain in options[:MOST_UNUSUAL]:
        if gain < least_gain:
            break
        larger = (*model, placed)
        # others may have stood for it: what else is usual stays possible in the fit
        own = both.with_tolerances_beside(larger)
        fitted = fit_all(own, [larger])[0]
        if _is_unusual(own, fitted, placed.key):
            return fitted.model
    return None


def _is_unusual(both: Predictor, fitted: FittedModel, key: str) -> bool:
    """Whether the 80 % interval of one of an effect's values holds nothing usual."""
    coordinates = fitted.coordinates
    (own,) = (one for one in fitted.model if one.key == key)
    errors, x = standard_errors(both, fitted), coordinates.of(fitted.model)
    usual = USUAL * effect(own.name).spread(both.plant, own.place)
    for i in coordinates.columns_of([own])[: max(effect(own.name).components, 1)]:
        ends = [x[i] + side * Z_80 * errors[i] for side in (-1, 1)]
        at = [
            coordinates.scaled(i, value_at(coordinates.parameters[i], side * usual))
            for side in (-1, 1)
        ]
        if ends[0] > max(at) or ends[1] < min(at):
            return True
    return False


def _spread(both: Predictor, nuisance: Nuisance, model: Model) -> FloatArray:
    """(k, k) covariance of the errors' sizes, the model's values being uncertain."""
    changes = nuisance.changes
    count, products = len(changes), changes.products()
    if model:
        slopes = fit_all(both.without_tolerances(), [model], 1)[0].jacobian.T
        across = changes.on(slopes)
        products = np.block([[products, across.T], [across, slopes @ slopes.T]])
    known = np.diag((np.arange(len(products)) < count).astype(float))
    spread = np.linalg.pinv(products + known, hermitian=True)
    return np.asarray(spread[:count, :count])


def _found(
    both: Predictor,
    nuisance: Nuisance,
    own: list[int],
    deviation: FloatArray,
    gain: float | None,
) -> Found:
    """An error as an effect with intervals; `own` are the indices of its values.

    `deviation` (k,) are the standard deviations of its sizes, `gain` [nats] is what it
    explains.
    """
    unit = nuisance.units[own[0]]
    ends = [
        nuisance.at(nuisance.sizes + _at(own, side * Z_80 * deviation, nuisance))
        for side in (-1, 0, 1)
    ]
    low, value, high = (
        {one.key: one for one in end.beside(())}[unit.key].values for end in ends
    )
    kind = effect(unit.name)
    every = kind.parameters(both.plant, unit.place)
    parameters = {
        one.name: Estimate(
            value[i],
            min(low[i], value[i]),
            max(high[i], value[i]),
            both.plant.unit(one.unit, unit.place),
            one.neutral if np.isfinite(one.neutral) else None,
        )
        for i, one in enumerate(every)
    }
    return Found(
        name=unit.name,
        place=unit.place,
        parameters=parameters,
        probability=None if gain is None else probability(gain),
        confusable_with=kind.twins(both.plant, unit.place),
        native=kind.native,
    )


def _at(own: list[int], values: FloatArray, nuisance: Nuisance) -> FloatArray:
    """(k,) zeros, but values at some indices."""
    every = np.zeros(len(nuisance.sizes))
    every[own] = values
    return every

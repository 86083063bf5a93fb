"""Gives the effects that a search found their final times, and their simplest forms.

A search compares times and forms on a part of the data. Here all data count but those
held out.
"""

from dataclasses import replace

import numpy as np

from diagnosis.conclude.estimates import block_variance
from diagnosis.effects.library import effect
from diagnosis.residuals.bursts import BIN_S, push_intervals
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.judging import gain_of_noise

SHIFTS, FITTED = (-10, 3), 3
"""First and last shift, in bins of 50 ms, of the start of an effect that does not last,
and number of the best starts that are fitted: an event shows late, and a fit does not
find a moment from far away."""


def retimed(both: Predictor, model: Model) -> Model:
    """The effects, those that do not last at the times that suit all data best.

    A search sees a part of the data only, in which the moment itself may be missing.
    """
    for placed in model:
        if not effect(placed.name).timed:
            continue
        rest = tuple(one for one in model if one is not placed)
        options = [model]
        for when in push_intervals(both, both.residuals([rest])[0]):
            end_s = when.start_s + when.duration_s
            for start_s in when.start_s + BIN_S * np.arange(*SHIFTS):
                times = (float(start_s), end_s - float(start_s))
                other = replace(placed, values=(*placed.values[:-2], *times))
                if when.recording == placed.recording:
                    options.append((*rest, other))
        energies = (both.residuals(options) ** 2).sum(axis=1)
        best = [options[int(k)] for k in np.argsort(energies)[:FITTED]]
        model = min(fit_all(both, best), key=lambda fit: fit.energy).model
    return model


def simplified(both: Predictor, model: Model) -> Model:
    """The effects, in simpler forms where further values explain no more than chance.

    A search compared the forms on a part of the data, and beside other errors.
    """
    for placed in model:
        simpler = effect(placed.name).simpler(placed)
        others = tuple(one for one in model if one is not placed)
        taken = {one.key for one in others}
        if simpler.key in {placed.key, *taken} or placed.tied:
            continue
        whole, part = fit_all(both, [model, (*others, simpler)])
        fewer = len(placed.values) - len(simpler.values)
        if _nats(both, whole, part) < gain_of_noise(1, fewer):
            model = part.model
    return model


def _nats(both: Predictor, whole: FittedModel, part: FittedModel) -> float:
    """Evidence [nats] for a fit against one with fewer values.

    If nothing but noise is left, a gain of g nats has the variance 2 g. Where errors
    last, or simulations change at random as with play, it has more, as the gains in
    blocks of time show (Vuong 1989): then it tells as much as the gain of noise that
    is as many of its standard deviations.
    """
    gains = 0.5 * (part.residual**2 - whole.residual**2)
    gain = part.energy - whole.energy
    (variance,) = block_variance((gains - gains.mean())[:, None], both.block)
    if gain <= 0 or variance <= 2 * gain:
        return gain
    return float(2 * gain**2 / variance)

"""Gives the effects that a search found their final times, and their simplest forms.

A search compares times and forms on a part of the data. Here all data count but those
held out.
"""

from dataclasses import replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.bursts import BIN_S, push_intervals
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import number_of_values
from diagnosis.search.accept import simpler_models
from diagnosis.search.chance import in_standard_errors, independent_blocks
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
    while True:
        starts = [one for one in simpler_models(model) if _untied(model, one)]
        if not starts:
            return model
        whole, *parts = fit_all(both, [model, *starts])
        part = min(parts, key=lambda fit: fit.energy)
        fewer = number_of_values(model) - number_of_values(part.model)
        if _pays(both, whole, part, fewer):
            return model
        model = part.model


def _untied(model: Model, simpler: Model) -> bool:
    """Whether no value of what became simpler is shared with other joints."""
    kept = {one.key for one in simpler}
    return not any(one.tied for one in model if one.key not in kept)


def _pays(both: Predictor, whole: FittedModel, part: FittedModel, more: int) -> bool:
    """Whether a fit explains more, by its `more` values, than chance.

    Beside noise every row is evidence, and a gain of g nats has the variance 2 g. But
    errors may last, and simulations with play change at random: then some blocks of
    time gain and others lose. So the gain must be as many standard errors, as blocks
    show them, as the least gain that is more than chance beside noise.
    """
    blocks = independent_blocks(both, whole.residual)
    gained = 0.5 * (part.residual**2 - whole.residual**2)
    sure = in_standard_errors(np.bincount(blocks, gained).astype(float))
    least = gain_of_noise(1, more)
    return part.energy - whole.energy >= least and sure >= np.sqrt(least / 2)

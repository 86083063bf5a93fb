"""Computes errors on held-out recordings, and finds doubts that follow from them."""

import numpy as np

from diagnosis.conclude.confidence import alike
from diagnosis.conclude.controls import controls_of
from diagnosis.conclude.flexible_regression import flexible_regression_errors
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.result import SearchResult
from diagnosis.verdict import ChannelFit, Fit
from groundwalk.arrays import FloatArray

SURPRISE = 2.0
"""A verdict expresses a doubt if the rms error on held-out data is at least this
multiple of that on the data of the fit."""


def held_out_errors(
    nominal: tuple[Predictor, Predictor],
    both: Predictor,
    test: Predictor,
    searched: SearchResult,
    model: Model,
    seed: np.random.SeedSequence,
) -> Fit:
    """Errors on held-out data: of the nominal sim, a model and wrong models (controls).

    The held-out data are used only here, after effects are chosen and fitted.

    Args:
      nominal: predictors of the data used so far (fitting and selection) and of the
        held-out data, both calibrated at the nominal robot model.
      both: predictor of the data used so far, calibrated at `model`.
      test: predictor of the held-out data, calibrated at `model`.
      searched: the result of the search.
      model: the effects that are reported, fitted to `both`.
      seed: seed of the flexible regression and of the random choice of a control.
    """
    errors = {"nominal": _error(nominal[1], ()), "corrected": _error(test, model)}
    regression, lot = seed.spawn(2)
    if model:
        others = [alike(searched, both.plant, placed) for placed in model]
        keys = {f"{one.name}@{one.place}" for own in others for one in own}
        controls = controls_of(both, model, keys, np.random.default_rng(lot))
        for key, control in controls.items():
            if control is not None:
                errors[key] = _error(test, control)
    errors["ceiling"] = flexible_regression_errors(*nominal, regression)
    channels = {}
    names_noise = zip(test.channels.names, test.channels.noise, strict=True)
    for i, (name, noise) in enumerate(names_noise):
        own = {key: float(rms[i] * noise) for key, rms in errors.items()}
        unit = channel_unit(test.plant, name)
        channels[name] = ChannelFit(unit=unit, floor=float(noise), **own)
    every = {key: float(np.sqrt(np.mean(rms**2))) for key, rms in errors.items()}
    return Fit(floor=1.0, channels=channels, **every)


def _error(test: Predictor, model: Model) -> FloatArray:
    """(c,) rms error of a model on the held-out data, in units of noise."""
    return channel_rms(test, test.residuals([model])[0])


def channel_rms(predictor: Predictor, residual: FloatArray) -> FloatArray:
    """(c,) rms of each channel of an (N,) residual, both in units of noise."""
    c = len(predictor.channels.names)
    count = np.maximum(np.bincount(predictor.channel, predictor.scored, c), 1)
    return np.asarray(np.sqrt(np.bincount(predictor.channel, residual**2, c) / count))


def model_refuted(
    nominal: FloatArray, corrected: FloatArray, least_gain: float
) -> tuple[str, ...]:
    """A sentence for the limits if a model predicts held-out motions worse.

    `nominal` and `corrected` (N,) are residuals, in units of noise, of the nominal sim
    and of the sim with the effects found on the held-out data. `least_gain` [nats] is
    what an effect must gain to be reported.
    """
    if 0.5 * float(corrected @ corrected - nominal @ nominal) < least_gain:
        return ()
    return (
        "The effects found make the prediction of held-out motions worse: they explain "
        "a part of the error in the other recordings, but are not its cause.",
    )


def larger_than_learned(
    learned: Predictor, left: FloatArray, fit: Fit
) -> tuple[str, ...]:
    """A sentence for the limits if held-out errors are much larger than fitted ones.

    Args:
      learned: predictor of the data to which the model was fitted.
      left: (N,) residual of the model on these data, in units of noise.
      fit: errors on the held-out data.
    """
    before = max(float(np.sqrt(np.mean(channel_rms(learned, left) ** 2))), 1.0)
    if fit.corrected < SURPRISE * before:
        return ()
    errors = {name: one.corrected / one.floor for name, one in fit.channels.items()}
    name = max(errors, key=errors.__getitem__)
    return (
        f"The held-out recordings show more error than those that were fitted: "
        f"{fit.corrected:.2g} instead of {before:.2g} times the noise, most of it in "
        f"{name}. Something is missing that hardly shows in the other recordings.",
    )

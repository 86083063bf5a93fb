"""Computes errors on held-out recordings, and finds doubts that follow from them."""

import numpy as np

from diagnosis.conclude.confidence import confusable, twins
from diagnosis.conclude.controls import Controls
from diagnosis.conclude.flexible_regression import flexible_regression_errors
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.result import SearchResult
from diagnosis.verdict import ChannelFit, Fit
from groundwalk.arrays import FloatArray

SURPRISE = 2.0
"""A verdict expresses a doubt if the rms error on held-out data is at least this
multiple of that on the data of the fit."""


class HeldOutErrors:
    """Errors on held-out data: of the nominal sim, a model and wrong models (controls).

    The held-out data are used only here, after effects are chosen and fitted.
    """

    def __init__(
        self,
        nominal: tuple[Predictor, Predictor],
        both: Predictor,
        test: Predictor,
        searched: SearchResult,
        model: Model,
        seed: np.random.SeedSequence,
    ) -> None:
        """Compute all errors.

        Args:
          nominal: predictors of the data used so far (fitting and selection) and of the
            held-out data, both calibrated at the nominal robot model.
          both: predictor of the data used so far, calibrated at `model`.
          test: predictor of the held-out data, calibrated at `model`.
          searched: the result of the search.
          model: the effects that are reported, fitted to `both`.
          seed: seed of the flexible regression and of the random choice of a control.
        """
        self._test = test
        self._errors = {"nominal": _error(nominal[1], ())}
        self._errors["corrected"] = _error(test, model)
        regression, lot = seed.spawn(2)
        if model:
            alike = _alike(both, searched, model)
            controls = Controls.of(both, model, alike, np.random.default_rng(lot))
            for name, control in vars(controls).items():
                if control is not None:
                    self._errors[name] = _error(test, control)
        self._errors["ceiling"] = flexible_regression_errors(*nominal, regression)

    def fit(self) -> Fit:
        """The errors of each channel, and of all channels together, for the verdict."""
        channels = {
            name: ChannelFit(
                unit=channel_unit(self._test.plant, name),
                floor=float(noise),
                **{key: float(rms[i] * noise) for key, rms in self._errors.items()},
            )
            for i, (name, noise) in enumerate(
                zip(self._test.channels.names, self._test.channels.noise, strict=True)
            )
        }
        every = {
            key: float(np.sqrt(np.mean(rms**2))) for key, rms in self._errors.items()
        }
        return Fit(floor=1.0, channels=channels, **every)


def _alike(both: Predictor, searched: SearchResult, model: Model) -> set[str]:
    """Keys "effect@place" of effects that may be true instead of one in `model`."""
    return {
        f"{at.name}@{at.place}"
        for placed in model
        for at in (*confusable(searched, placed), *twins(both.plant, placed))
    }


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
    """A sentence if the model predicts held-out motions worse than the nominal sim.

    Args:
      nominal: (N,) residual of the nominal sim on the held-out data, in units of noise.
      corrected: (N,) residual of the sim with the effects found, on the same data.
      least_gain: log-likelihood [nats] that an effect must gain to be reported.

    Returns:
      One sentence for the verdict's limits, or nothing.
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
    """A sentence if the held-out error is much larger than that on the fitted data.

    Args:
      learned: predictor of the data to which the model was fitted.
      left: (N,) residual of the model on these data, in units of noise.
      fit: errors on the held-out data.

    Returns:
      One sentence for the verdict's limits, or nothing.
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

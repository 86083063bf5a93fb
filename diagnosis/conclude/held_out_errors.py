"""Errors on the recordings that were kept for the end."""

import numpy as np

from diagnosis.conclude.confidence import confusable, twins
from diagnosis.conclude.controls import Controls
from diagnosis.conclude.flexible_regression import ceiling_errors
from diagnosis.conclude.surprise import channel_rms
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.result import Found
from diagnosis.verdict.verdict import ChannelFit, Fit
from groundwalk.arrays import FloatArray


class FinalTest:
    """The test data, opened once: errors of the plant, the model and the controls."""

    def __init__(
        self,
        nominal: tuple[Predictor, Predictor],
        both: Predictor,
        test: Predictor,
        searched: Found,
        model: Model,
        seed: np.random.SeedSequence,
    ) -> None:
        """Work out all errors.

        Args:
          nominal: predictors of the data learned from and of the test data, calibrated
            at the plant alone.
          both: of the data learned from, calibrated at the model.
          test: of the test data, likewise.
          searched: what the search came to.
          model: that is believed, fitted to `both`.
          seed: of the flexible regression, and of the lot that draws a control.
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
        self._errors["ceiling"] = ceiling_errors(*nominal, regression)

    def fit(self) -> Fit:
        """For `Verdict.fit`."""
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


def _alike(both: Predictor, searched: Found, model: Model) -> set[str]:
    """Keys ("effect@place") of all that may be one of the model's."""
    return {
        f"{at.name}@{at.place}"
        for placed in model
        for at in (*confusable(searched, placed), *twins(both.plant, placed))
    }


def _error(test: Predictor, model: Model) -> FloatArray:
    """(c,) rms [noise] on the test data."""
    return channel_rms(test, test.residuals([model])[0])

"""Fits and takes the doubts of a predictor: what is no evidence in its residuals."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from typing import Any, Self

import numpy as np

from diagnosis.effects.library import keys_within
from diagnosis.plant.plant import Plant
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.doubts import Doubts
from diagnosis.residuals.replays import Model
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from diagnosis.residuals.small_mismatch.nuisance_fit import NuisanceFit
from diagnosis.residuals.tolerance import Tolerance
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray


class Doubted(ABC):
    """Something with residuals from which doubts are taken out, see `Doubts`.

    Attributes:
      plant: nominal robot model.
      traces: recordings.
      scored: (N,) whether an entry of a residual counts.
    """

    plant: Plant
    traces: list[Trace]
    scored: BoolArray
    _doubts: Doubts

    @abstractmethod
    def residuals(self, models: Sequence[Model], exactly: bool = False) -> FloatArray:
        """(n, N) measured less predicted values of n models, in units of noise."""

    @abstractmethod
    def correct(self, model: Model = ()) -> FloatArray:
        """Measure the integration error of a model, to be taken out of all residuals.

        Returns (c,) the rms, in units of noise, of that which remains in each channel.
        """

    @abstractmethod
    def _doubt_times(self, model: Model) -> None:
        """Find what commands that jump early or late change, and wrong start states."""

    def _with(self, **changes: Any) -> Self:
        """A copy that takes other things out of residuals, see `Doubts`."""
        some = copy(self)
        some._doubts = replace(self._doubts, **changes)
        return some

    @property
    def noise_energy(self) -> float:
        """Energy [nats] that a right model leaves on average.

        It is 1/2 for each entry that counts, less what whitening takes out of noise.
        """
        return 0.5 * float(self.scored.sum() - self._doubts.taken)

    @property
    def nuisance(self) -> Nuisance | None:
        """Small mismatch of the nominal model, which is in all simulations, if any."""
        return self._doubts.nuisance

    @property
    def fits_nuisance(self) -> bool:
        """Whether small mismatch is fitted, not known from the healthy robot."""
        return self.nuisance is not None and not self._doubts.is_known

    def evenly(self) -> Self:
        """A copy with residuals in one unit at all speeds; nothing is tolerated."""
        start = self._doubts.start
        start = start.evenly() if start else None
        return self._with(
            trust=None, clock=None, commands=None, start=start, tolerance=None
        )

    def nominal(self) -> Self:
        """A copy without small mismatch of the model, neither likely nor tolerated."""
        return self._with(nuisance=None, tolerance=None)

    def without_tolerances(self) -> Self:
        """A copy that has likely small mismatch, but does not tolerate more."""
        return self._with(tolerance=None)

    def with_tolerances_beside(self, model: Model) -> Self:
        """A copy whose tolerances are those of all but a model's effects."""
        tolerance = self._doubts.tolerance
        return self._with(tolerance=tolerance and tolerance.beside(keys_within(model)))

    def calibrate(self, model: Model = (), tolerances: bool = True) -> FloatArray:
        """Measure the integration error of a model, and what wrong start states change.

        Both are then taken out of the residuals of all models. Small mismatch that the
        nominal model may have are fitted, and what others would change is found.
        Returns (c,) the rms, in units of noise, of the integration error that remains
        in each channel. Without `tolerances` those stay that were found before.
        """
        error = self.correct(model)
        self.doubt(model, tolerances)
        return self.correct(model) if tolerances and self.nuisance else error

    def calibrate_with(self, model: Model) -> Model:
        """Calibrate at a model whose values are fitted together with small mismatch.

        Returns the model with these values. Together they predict a robot as well as
        they can, even if much is left.
        """
        self.correct(model)
        self._doubt_times(model)
        start = self.nuisance or no_nuisance(self)
        found, model = self.nuisance_fit(model).fitted_with_values(start)
        self._doubts = self._doubts.taking(found, self._beyond())
        self.correct(model)
        return model

    def settle(self, model: Model) -> Model:
        """Calibrate where a model's values and small mismatch are likeliest together.

        Returns the model with these values. `calibrate` keeps given values; fits of
        values take what small mismatch changes from there, to first order. Friction
        and play bend both ways, so that these in turn end far from the likeliest.
        """
        some = self._with(nuisance=None, tolerance=self._beyond())

        def measured(beside: Model) -> None:
            some.correct(beside)
            some._doubt_times(beside)

        fit = NuisanceFit(some.residuals, measured, model)
        found, model = fit.settled_with_values(self.nuisance or no_nuisance(self))
        self._doubts = self._doubts.taking(found, self._beyond())
        self.correct(model)
        self._doubt_times(model)
        return model

    def doubt(self, model: Model = (), tolerances: bool = True) -> None:
        """Find what wrong start states change, and small mismatch of the nominal model.

        Without `tolerances` the latter stays as it was found before.
        """
        self._doubt_times(model)
        if tolerances:
            self.fit_nuisance(model)

    def doubt_beside(self, errors: Nuisance | None, model: Model) -> None:
        """Find what wrong start states change; take small mismatch as it is given."""
        self._doubt_times(model)
        self.take_nuisance(errors, model)

    def fit_nuisance(self, model: Model) -> None:
        """Find the nominal model's small mismatch that is likeliest beside a model.

        Where recordings of the healthy robot tell it, it is taken as it is. The
        integration error is to be measured again after that.
        """
        if self._doubts.is_known:
            self.take_nuisance(no_nuisance(self), model)
        elif self.plant.base == "fixed":  # contacts outdo small mismatch by far
            start = self.nuisance or no_nuisance(self)
            found = self.nuisance_fit(model).fitted(start)
            self._doubts = self._doubts.taking(found, self._beyond())

    def take_nuisance(self, errors: Nuisance | None, model: Model) -> None:
        """Take small mismatch as it is given, and find what other sizes would change.

        So it is not fitted to traces that are held out.
        """
        if errors is not None:
            self._doubts = replace(self._doubts, old=self._of_found(model))
            own = self.nuisance or no_nuisance(self)
            found = self.nuisance_fit(model).seen(own.at(errors.sizes))
            self._doubts = self._doubts.taking(found, self._beyond())

    def _of_found(self, model: Model) -> FloatArray | None:
        """(p, N) changes of residuals by values of effects of the healthy robot.

        In scaled coordinates, of those whose values were free; None without such.
        """
        noise = self._doubts.noise
        if noise is None or not noise.found:
            return None
        rest = tuple(one for one in noise.model if one not in noise.found)
        bare = {"noise": replace(noise, model=rest), "nuisance": None}
        some = self._with(**bare, tolerance=self._beyond())
        coordinates = Coordinates(self.plant, noise.found)
        x = coordinates.of(noise.found)
        far = coordinates.steps_from(x)
        points = [x, *(x + np.diag(far))]
        seen = some.residuals([(*coordinates.model_at(at), *model) for at in points])
        return np.asarray((seen[1:] - seen[0]) / far[:, None])

    def doubt_as(self, other: "Doubted") -> None:
        """Take small mismatch, and what wrong starts change, from a predictor."""
        self._doubts = other._doubts

    def moved_to(self, model: Model) -> Self:
        """A copy with the small mismatch that is likeliest beside another model."""
        if self.nuisance is None or not self.fits_nuisance:
            return self
        return self._taking(self.nuisance_fit(model).moved(self.nuisance))

    def with_nuisance_of(self, other: "Doubted") -> Self:
        """A copy with the small mismatch that another predictor has."""
        if self.nuisance is None or other.nuisance is None:
            return self
        return self._taking(self.nuisance.at(other.nuisance.sizes))

    def _taking(self, nuisance: Nuisance) -> Self:
        some = copy(self)
        some._doubts = self._doubts.taking(nuisance, self._beyond())
        return some

    def nuisance_fit(self, model: Model) -> NuisanceFit:
        """Fits of small mismatch of the nominal model, beside a model."""
        some = self._with(nuisance=None, tolerance=self._beyond())
        return NuisanceFit(some.residuals, some.correct, model)

    def _beyond(self) -> Tolerance:
        """What is tolerated beside small mismatch of the nominal model: nothing."""
        return Tolerance(Changes.of(np.zeros((0, len(self.scored)))))


def no_nuisance(some: Doubted) -> Nuisance:
    """Small mismatch of a robot model, of size zero."""
    return Nuisance.of(some.plant, some.traces, len(some.scored))

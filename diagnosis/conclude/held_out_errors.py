"""Errors on held-out recordings: of a diagnosis, and of wrong models as controls.

A diagnosis is convincing if all controls predict held-out recordings worse.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from diagnosis.conclude.answer import alike
from diagnosis.conclude.flexible_regression import flexible_regression_errors
from diagnosis.effects.library import all_effects, effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import channel_unit
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.result import SearchResult
from diagnosis.search.ties import groups_of, without_each
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
    noise, floor = test.channels.noise, test.channels.floor
    for i, name in enumerate(test.channels.names):
        own = {key: float(rms[i] * noise[i]) for key, rms in errors.items()}
        unit = channel_unit(test.plant, name)
        channels[name] = ChannelFit(unit=unit, floor=float(floor[i]), **own)
    every = {
        key: float(np.sqrt(np.mean((rms * noise / floor) ** 2)))
        for key, rms in errors.items()
    }
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


def rms_above_floor(predictor: Predictor, residual: FloatArray) -> float:
    """Rms of an (N,) residual in the worst channel, in multiples of its noise floor."""
    channels = predictor.channels
    rms = channel_rms(predictor, residual) * channels.noise / channels.floor
    return float(rms.max())


def larger_than_learned(
    learned: tuple[Predictor, FloatArray], test: tuple[Predictor, FloatArray]
) -> tuple[str, ...]:
    """A sentence for the limits if held-out errors are much larger than fitted ones.

    Each argument is a predictor and the residual (N,) that the model leaves there, in
    units of noise: of the data that it was fitted to, and of those held out.
    """
    before, after = max(rms_above_floor(*learned), 1.0), rms_above_floor(*test)
    if after < SURPRISE * before:
        return ()
    rms = channel_rms(*test)
    name = test[0].channels.names[int(np.argmax(rms))]
    return (
        f"The held-out recordings show more error than those that were fitted: "
        f"{after:.2g} instead of {before:.2g} times the noise, most of it in "
        f"{name}. Something is missing that hardly shows in the other recordings.",
    )


MOST = 4
"""Number of wrong models that are fitted to find the best one: those with the smallest
errors before the fit."""

STEPS = 4
"""Most steps of the fit of a wrong model, enough for a comparison."""


def controls_of(
    predictor: Predictor, model: Model, alike: Collection[str], rng: np.random.Generator
) -> dict[str, Model | None]:
    """Fit models that differ from the one found in its main effect.

    The main effect is the one whose removal increases the error most.

    Effects `alike`, keys "effect@place", may be the truth as well and are no controls.

    Returns:
      "without": the other effects alone; "wrong_place": the main effect moved to the
      best other place; "wrong_effect": it is replaced by another one at the same place,
      chosen at random. None if there is no such model.
    """
    main, rest = _main(predictor, model)
    places = effect(main.name).places(predictor.plant, predictor.traces)
    own = {one.place for one in next(one for one in groups_of(model) if main in one)}
    moved = [replace(main, place=place) for place in places if place not in own]
    other = _by_lot(predictor, main, rest, alike, rng)
    return {
        "without": rest,
        "wrong_place": _best(predictor, rest, moved),
        "wrong_effect": _best(predictor, rest, other),
    }


def _main(predictor: Predictor, model: Model) -> tuple[PlacedEffect, Model]:
    """The effect whose removal increases the error most, and the others refitted."""
    if len(model) == 1:
        return model[0], ()
    smaller = without_each(model)
    (whole,) = fit_all(predictor, [model], 1)
    known = [whole.jacobian_of(one) for one in smaller]
    fits = fit_all(predictor, smaller, STEPS, followed=True, jacobians=known)
    worst = max(range(len(smaller)), key=lambda i: fits[i].energy)
    main = next(one for one in model if one not in smaller[worst])
    return main, fits[worst].model


def _by_lot(
    predictor: Predictor,
    main: PlacedEffect,
    rest: Model,
    alike: Collection[str],
    rng: np.random.Generator,
) -> list[PlacedEffect]:
    """An effect of typical size at the main effect's place, chosen at random, if any.

    Effects with as many values as the main one are preferred.
    """
    plant, traces = predictor.plant, predictor.traces
    barred = {main.key, *alike, *(one.key for one in rest)}
    others = []
    for name, kind in all_effects().items():
        if main.place in kind.places(plant, traces):
            typical = tuple(p.typical for p in kind.parameters(plant, main.place))
            one = PlacedEffect(name, main.place, typical)
            if not (one.key in barred or _contains(one, main) or _contains(main, one)):
                others.append(one)
    equal = [one for one in others if len(one.values) == len(main.values)]
    choice = equal or others
    return [choice[int(rng.integers(len(choice)))]] if choice else []


def _contains(one: PlacedEffect, other: PlacedEffect) -> bool:
    """Whether an effect is a more general form of another."""
    return one.key in (grown.key for grown in grown_from(other))


def _best(
    predictor: Predictor, rest: Model, options: list[PlacedEffect]
) -> Model | None:
    """The effects `rest` with the option that fits best; None without options."""
    taken = {placed.key for placed in rest}
    models = [(*rest, one) for one in options if one.key not in taken]
    if not models:
        return None
    energies = (predictor.residuals(models) ** 2).sum(axis=1)
    likely = [models[int(i)] for i in np.argsort(energies)[:MOST]]
    return min(_fitted(predictor, likely), key=lambda fit: fit.energy).model


def _fitted(predictor: Predictor, models: list[Model]) -> list[FittedModel]:
    """Models after a few steps of a fit, enough for a comparison."""
    return fit_all(predictor, models, STEPS, followed=True)

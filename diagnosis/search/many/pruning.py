"""Takes out of a model what it does not need: effects, values and general forms."""

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.ties import Level, groups_of, number_of_values, tied
from diagnosis.search.fitting import FittedModel
from diagnosis.search.many.fits import Fits
from diagnosis.search.result import Judged

CLEARLY = 20.0
"""Effects whose linear estimates exceed their price by more nats than this are not
tried without: odds of more than a million to one, which no nonlinearity undoes."""


def pruned(fits: Fits, best: Judged) -> Judged:
    """The model in its simplest forms, without effects that explain too little."""
    return _without_idle(fits, _simplified(fits, best))


def shared(fits: Fits, best: Judged) -> Judged:
    """The model with values that joints share, where these explain as much."""
    plant = fits.fit.plant
    levels: tuple[Level, ...] = ("all", "motor")
    joints = set(plant.joints)
    names = {one.name for one in best.model if effect(one.name).of_motor}
    apart = {one.name for one in best.model if one.place not in joints}
    for name in sorted(names - apart):
        for level in levels:
            own = [placed for placed in best.model if placed.name == name]
            common = tied(plant, own, level)
            if number_of_values(common) == number_of_values(tuple(own)):
                continue
            rest = tuple(one for one in best.model if one.name != name)
            (tried,) = fits.tried([(*rest, *common)], [None])
            if fits.ebic(best).prefers(tried, best):
                best = fits.fitted(tried.model)
                break
    return best


def _simplified(fits: Fits, best: Judged) -> Judged:
    """The model with simpler forms of its effects where these explain as much."""
    for group in groups_of(best.model):
        simpler = True
        while simpler:
            simpler = False
            for other, forms in _simpler(best.model, group):
                tried = fits.fitted(other)
                if fits.ebic(best).prefers(tried, best):
                    keys = {form.key for form in forms}
                    group = tuple(one for one in tried.model if one.key in keys)
                    best, simpler = tried, True
                    break
    return best


def _simpler(model: Model, group: Model) -> list[tuple[Model, Model]]:
    """Models with a group of one kind in simpler forms, and these forms."""
    found = []
    for forms in zip(*(effect(one.name).simpler(one) for one in group), strict=True):
        known = {one.key for one in model}
        if not known & {form.key for form in forms}:
            of = {one.key: form for one, form in zip(group, forms, strict=True)}
            found.append((tuple(of.get(one.key, one) for one in model), forms))
    return found


def _without_idle(fits: Fits, best: Judged) -> Judged:
    """The model without effects that explain too little.

    Linear estimates say what to try without, the likeliest first; a fit decides. What
    they cannot say, since no finite value stands for no effect, is tried first.
    """
    needed, size = set[str](), len(best.model)
    while True:
        ebic = fits.ebic(best)
        # what no finite value switches off is not known to be worth anything
        worth = {
            group: ebic.nats(gain if np.isfinite(gain) else 0.0, best)
            - ebic.price_within(best.model, group)
            for group, gain in gains_of_each(best.fit)
            if group[0].key not in needed
        }
        group = min(worth, key=lambda one: worth[one], default=())
        if not group or worth[group] > CLEARLY:
            return best if len(best.model) == size else fits.fitted(best.model)
        kept = tuple(one for one in best.model if one not in group)
        tried = fits.tried([kept], [best.fit.jacobian_of(kept)])[0]
        if ebic.prefers(tried, best):
            best = tried
        else:
            needed.add(group[0].key)


def gains_of_each(fit: FittedModel) -> list[tuple[Model, float]]:
    """Energies [nats] by which a fit gets worse without each effect, or tied effects.

    To first order, the other values being fitted again (Wald 1943). Infinite where no
    finite value stands for no effect.
    """
    coordinates, gains = fit.coordinates, list[tuple[Model, float]]()
    jacobian = fit.jacobian
    spread = np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)
    x = coordinates.of(fit.model)
    for group in groups_of(fit.model):
        own = coordinates.columns_of(group)
        own = own[: max(effect(group[0].name).components, 1)]
        neutral = [coordinates.parameters[i].neutral for i in own]
        if not np.isfinite(neutral).all():
            gains.append((group, np.inf))
            continue
        away = [
            x[i] - coordinates.scaled(i, value)
            for i, value in zip(own, neutral, strict=True)
        ]
        part = np.linalg.pinv(spread[np.ix_(own, own)], hermitian=True)
        gains.append((group, 0.5 * float(np.array(away) @ part @ np.array(away))))
    return gains

"""Takes out of a model what it does not need: effects, values and general forms."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.ties import Level, groups_of, number_of_values, tied
from diagnosis.search.many.ebic import Ebic
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.losses import Losses
from diagnosis.search.result import Judged

CLEARLY = 20.0
"""Effects whose linear estimates exceed their price by more nats than this are not
tried without: odds of more than a million to one, which no nonlinearity undoes."""


def pruned(fits: Fits, best: Judged) -> Judged:
    """The model in its simplest forms, without effects that explain too little.

    What is left may have simpler forms beside fewer effects and values.
    """
    while True:
        values = number_of_values(best.model)
        best = _lean(fits, _simplified(fits, best))
        if number_of_values(best.model) == values:
            return best


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
                if fits.ebic(best, repeats=False).prefers(tried, best):
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


def _lean(fits: Fits, best: Judged) -> Judged:
    """The model without effects and values that explain too little.

    Linear estimates say what to try without, the likeliest first; a fit decides. What
    they cannot say, since no finite value stands for no effect, is tried first. In the
    end, what was refused beside a larger model is tried again.
    """
    refused, size = dict[frozenset[str], Model](), number_of_values(best.model)
    while option := _next(fits, best, refused):
        known = best.fit.jacobian_of(option.model) if option.is_part else None
        (tried,) = fits.tried([option.model], [known])
        if fits.ebic(best, repeats=False).prefers(tried, best):
            best = tried
        else:
            refused[option.keys] = best.model
    is_as_before = number_of_values(best.model) == size
    return best if is_as_before else fits.fitted(best.model)


def _next(
    fits: Fits, best: Judged, refused: Mapping[frozenset[str], Model]
) -> "_Option | None":
    """The model to try next; None if all with fewer values are clearly worse."""
    ebic = fits.ebic(best, repeats=False)
    options = [(one.worth(ebic, best), one) for one in _leaner(fits, best)]
    new = [one for one in options if one[1].keys not in refused and one[0] < CLEARLY]
    again = [
        (worth, one)
        for worth, one in options
        if worth < 0 and refused.get(one.keys, best.model) != best.model
    ]
    return min(new or again, key=lambda one: one[0], default=(0.0, None))[1]


@dataclass(frozen=True)
class _Option:
    """A model with fewer values, and by a linear estimate what it loses [nats].

    Attributes:
      keys: "effect@place" of the effects that are left out, or whose values are shared.
      is_part: whether these are left out.
    """

    model: Model
    loss: float
    keys: frozenset[str]
    is_part: bool

    def worth(self, ebic: Ebic, best: Judged) -> float:
        """What the further values of the best model are worth, by an estimate."""
        # what no finite value switches off is not known to be worth anything
        loss = self.loss if np.isfinite(self.loss) else 0.0
        return ebic.nats(loss, best) - ebic.price(best.model) + ebic.price(self.model)


def _leaner(fits: Fits, best: Judged) -> Iterator[_Option]:
    """The model without each effect, and with values that joints share."""
    losses = Losses(best.fit)
    for group, loss in losses.without_each():
        keys = frozenset(placed.key for placed in group)
        rest = tuple(placed for placed in best.model if placed.key not in keys)
        yield _Option(rest, loss, keys, is_part=True)
    for shared, loss in losses.sharing(fits.fit.plant):
        of = {placed.key: placed for placed in shared}
        model = tuple(of.get(placed.key, placed) for placed in best.model)
        yield _Option(model, loss, frozenset(of), is_part=False)

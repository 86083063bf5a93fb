"""The guards that effects must pass before a verdict names them.

A search finds the effects that explain most. Whether anything is established is asked
here: an effect whose values might be those of no effect, or that ran into a bound, is
taken out; and what is left must predict held-out recordings better, better than the
same at a wrong place and than another effect, and much of what a regression without
physics could.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.conclude.between_recordings import scattered
from diagnosis.conclude.estimates import Z_80, largest_errors
from diagnosis.conclude.final_form import retimed, simplified
from diagnosis.conclude.held_out_errors import Judgement
from diagnosis.conclude.no_change import no_change
from diagnosis.conclude.usual_bursts import usual_event
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import (
    SECONDARY,
    FittedModel,
    fit_all,
    ran_into_bound,
)
from diagnosis.verdict import Errors, Fit

HALF = 0.5
"""Share of what could be explained that an answer must explain, and of what it explains
that a wrong answer must not reach: more than a coincidence, less than all."""

MOST_OF_IT = 8 / 9
"""Share of the squared error above the noise that an answer must take away: the error
falls to a third, so that what is left is half as large as what was found."""

SURELY = 2.33
"""Standard errors by which a control that explains much must still leave more than the
effects found: once in a hundred cases it does so by chance."""

NO_BETTER = "The effects found do not predict held-out motions better."
"""Sentence for the limits of a verdict."""


def established(
    both: Predictor, model: Model, healthy: Sequence[Predictor] = ()
) -> tuple[FittedModel | None, tuple[str, ...]]:
    """The effects of a model, refitted, without those that may be nothing.

    Effects are removed one at a time, those that may be nothing before those on a
    bound. Returns the effects fitted to the data of `both`, None if none is left, and
    sentences on those on a bound. `healthy` are predictors of the healthy robot, which
    show how much recordings of one robot differ.
    """
    said = list[str]()
    model = simplified(both, retimed(both.without_tolerances(), model))
    while model:
        fitted = fit_all(both, [model])[0]
        model = fitted.model
        doubtful = (
            _may_be_nothing(both, fitted)
            or _scattered(both, healthy, fitted)
            or usual_event(both, healthy, fitted)
            or _unchanged(both, healthy, fitted)
        )
        bound = [one for one in model if ran_into_bound(fitted, one)]
        if doubtful is None and not bound:
            return fitted, tuple(said)
        gone = doubtful if doubtful is not None else bound[0]
        if doubtful is None:
            name = effect(gone.name).words.label
            said.append(
                f"{name} at {gone.place} would fit best at the end of its possible "
                "range, so something else is behind it: it is not stated"
            )
        group = next(group for group in groups_of(model) if gone in group)
        model = tuple(one for one in model if one not in group)
    return None, tuple(said)


def _may_be_nothing(both: Predictor, fitted: FittedModel) -> PlacedEffect | None:
    """The effect with the least evidence among those whose values may be neutral.

    An effect may be nothing if the neutral value of each of its parameters that has one
    lies in its 80 % interval. Where that is infinite, as without a speed limit, it is
    the end of the possible values on that side. A motor that was off for a while may be
    nothing, too, if that may have been no time: it cannot have been more than off.
    """
    errors = largest_errors(both, fitted)
    x = fitted.coordinates.of(fitted.model)
    last_s = max(float(trace.time_s[-1]) for trace in both.traces)
    worst, least = None, 1.0
    for placed, own in zip(fitted.model, fitted.coordinates.columns, strict=True):
        sizes, lasted = dict[str, float](), np.inf
        for i in own:
            parameter = fitted.coordinates.parameters[i]
            nothing = np.clip(parameter.neutral, parameter.low, parameter.high)
            if not np.isfinite(nothing):
                continue
            neutral = fitted.coordinates.scaled(i, float(nothing))
            ratio = abs(x[i] - neutral) / (Z_80 * errors[i])
            if parameter.name not in SECONDARY:
                sizes[parameter.name] = ratio
            if parameter.name == "duration" and sum(placed.values[-2:]) < last_s:
                lasted = ratio
        every = effect(placed.name).parameters(both.plant, placed.place)
        if not all(one.full for one in every if one.name in sizes):
            lasted = np.inf  # what was stronger may have been as short as any
        sure = min(max(sizes.values(), default=1.0), lasted)
        if sure < least:
            worst, least = placed, sure
    return worst


def _scattered(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel
) -> PlacedEffect | None:
    """An effect that may be no more than differences between recordings, if any is.

    On a floating base recordings differ by chance, and each time block counts by
    itself.
    """
    if both.plant.base == "floating":
        return None
    found = scattered(both, healthy, fitted)
    return found[0][0] if found else None


def _unchanged(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel
) -> PlacedEffect | None:
    """An effect by which recordings of the healthy robot differ as much, if any."""
    if both.plant.base == "floating":
        return None
    found = no_change(both, healthy, fitted)
    return found[0] if found else None


def objections(judged: Judgement, timed: bool) -> tuple[str, ...]:
    """Sentences on why effects are not established, from errors on held-out data.

    `timed` says that they acted for a while only, perhaps not in the held-out data.
    Only channels in which the nominal sim is off count, if there are any, else those in
    which the effects show: in many others an effect at one joint would be lost. A
    control that explains half because the effect is real, such as the same mass one
    link further, says nothing against the effect.
    """
    hardly_more = judged.hardly_more
    fit = _telling(judged)
    gained = fit.nominal**2 - fit.corrected**2
    if timed and gained >= -(fit.floor**2):
        return ()
    if gained <= 0:
        return (NO_BETTER,)
    said = []
    possible = _possible(fit, hardly_more)
    share = gained / (fit.nominal**2 - fit.floor**2)
    much_left = fit.corrected**2 > (1 + hardly_more) * fit.floor**2
    if share < MOST_OF_IT and much_left:
        said.append(
            f"The effects found take away {share:.0%} of the squared error above the "
            "noise in held-out motions: something else is missing, too."
        )
    elif gained < HALF * possible:
        said.append(
            f"The effects found explain {gained / possible:.0%} of what could be "
            "explained of the error in held-out motions, less than half."
        )
    else:
        said += _unexplained_at_own_joints(judged)
    controls = {
        "wrong_place": "the same effect at another place",
        "wrong_effect": "another effect at the same place",
    }
    said += [
        f"In held-out motions {words} explains about as much."
        for key, words in controls.items()
        if judged.worse.get(key, 0.0) < SURELY
        and judged.follows.get(key, 0.0) <= HALF
        and getattr(fit, key) is not None
        and _does_as_well(fit, getattr(fit, key), hardly_more)
    ]
    return tuple(said)


def _unexplained_at_own_joints(judged: Judgement) -> tuple[str, ...]:
    """A sentence if at a joint effects are named that hardly explain its errors.

    Of all joints together they may explain most, and yet stand in for something else
    that shows at this joint.
    """
    least, where = HALF, ""
    for name in judged.own:
        one = judged.fit.channels[name]
        above = one.nominal**2 - one.floor**2
        gained = one.nominal**2 - one.corrected**2
        much_left = one.corrected**2 > (1 + judged.hardly_more) * one.floor**2
        share = gained / above if min(gained, above) > 0 else 0.0
        if much_left and share < least:
            least, where = share, name.partition(".")[2]
    if not where:
        return ()
    return (
        f"The effects found take away {least:.0%} of the squared error above the noise "
        f"at {where}, where some of them act: something else is missing, too.",
    )


def is_worse(measured: Fit, hardly_more: float) -> bool:
    """Whether held-out motions are predicted worse than by the nominal sim as it is.

    `measured` are errors as they are measured, while `objections` judges by errors
    beside wrong starts and small mismatch, which may hide that. Differences of
    `hardly_more`, a share of the squared noise, do not count.
    """
    worse = measured.corrected**2 - measured.nominal**2
    return worse > hardly_more * measured.floor**2


def _possible(fit: Errors, hardly_more: float) -> float:
    """How much of the squared error could be explained, if that is known; else 0.

    A regression without physics shows it, and so does the noise, unless hardly more is
    left: it is not known so well.
    """
    above, far = fit.nominal**2 - fit.floor**2, hardly_more * fit.floor**2
    options = [above] if above > far else []
    if fit.ceiling is not None and fit.ceiling < fit.nominal:
        options.append(fit.nominal**2 - fit.ceiling**2)
    return min(options, default=0.0)


def _telling(judged: Judgement) -> Errors:
    """The errors, by noise floors, over channels in which the nominal sim is off.

    If it is in none, over those in which effects change half as much as where most.
    """
    fit, most = judged.fit, max(judged.changed.values(), default=0.0)
    own = [
        one
        for one in fit.channels.values()
        if one.nominal**2 > (1 + judged.hardly_more) * one.floor**2
    ] or [
        one
        for name, one in fit.channels.items()
        if judged.changed.get(name, 0.0) > HALF * most
    ]
    if not own:
        return fit
    together = {}
    for name in Errors.__dataclass_fields__:
        errors = [getattr(one, name) for one in own]
        if None not in errors:
            shares = [error / one.floor for error, one in zip(errors, own, strict=True)]
            together[name] = float(np.sqrt(np.mean(np.square(shares))))
    return Errors(**together)


def _does_as_well(fit: Errors, control: float, hardly_more: float) -> bool:
    """Whether a control takes away half of the main effect's share, and leaves little.

    Similar effects explain much of each other; but the right one leaves far less.
    """
    alone = fit.nominal if fit.without is None else fit.without
    left = max(fit.corrected**2 / fit.floor**2 - 1, hardly_more)
    return bool(
        alone**2 - control**2 > HALF * (alone**2 - fit.corrected**2)
        and control**2 / fit.floor**2 - 1 < left / HALF
    )

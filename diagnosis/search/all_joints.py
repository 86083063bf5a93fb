"""Searches for physics that all joints of a model lack.

The search for one, two or three effects suits a robot whose model was right once. The
first model of a real robot lacks the same physics at every joint, in different amounts.
Here kinds of effects are added one by one, each at all joints where it improves the
fit.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import all_effects
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import signatures
from diagnosis.search.fitting import Nudges, fit_all
from diagnosis.search.judging import Judge
from diagnosis.search.result import Judged, SearchResult, without_each
from diagnosis.search.screening import Guess, Screen
from diagnosis.traces.usage import Usage
from groundwalk.arrays import BoolArray

MOST_KINDS = 6
"""Largest number of kinds of effects, each at many joints, in a model."""

TRIED = 4
"""Number of kinds of effects that are fitted in each round since they are estimated to
gain most, over all joints together."""

LEAN = 3
"""Number of further kinds of effects that are fitted in each round since they are
estimated to gain most for each fitted value."""

REPLAYS = 200
"""Rough number of simulations of the recordings in a round; only for the progress
display."""

LEAST_SHARE = 0.1
"""Share of the remaining energy (half the sum of squared residuals) above the noise
that a kind of effect at all joints must remove."""

PATIENCE = 2
"""Number of successive rounds without enough gain that end the search for kinds of
effects at all joints."""

MUCH_BETTER = 0.25
"""A model with effects at all joints is preferred to one of up to three effects if it
removes this share of the energy above the noise that the latter leaves."""


def all_joints(judge: Judge, result: SearchResult) -> SearchResult:
    """The model with effects at all joints if it fits much better, else `result`."""
    best = _grown(judge, result)
    if best is None:
        return result
    best = _without_idle(judge, best)
    left = result.winner.selected if result.winner else result.nothing
    if left - best.selected < max(
        MUCH_BETTER * (left - result.floor), judge.least_gain
    ):
        return result
    smaller = without_each(best.model)
    residuals = judge.fit.residuals(smaller)
    fits = [
        replace(best.fit, model=model, residual=residual)
        for model, residual in zip(smaller, residuals, strict=True)
    ]
    size = len(best.model)
    sizes = {size - 1: judge.ranked(judge.judge(fits)), size: [best]}
    return replace(result, best=sizes, chosen=size)


def _grown(judge: Judge, result: SearchResult) -> Judged | None:
    """Add kinds of effects at all joints, the best first, while they remove enough."""
    best: Judged | None = None
    model: Model = ()
    residual, energy = judge.fit.residuals([()])[0], result.nothing_fit + result.nothing
    floor, waited = result.floor_fit + result.floor, 0
    kinds, usage = servo_effects(), Usage.of(judge.fit.plant, judge.fit.traces)
    for number in range(MOST_KINDS):
        judge.hooks.stage(f"all joints, round {number + 1}", REPLAYS)
        signs = signatures(judge.fit, model, usage, (), kinds)
        guesses = Screen(judge.fit, signs).singles(residual)
        added = kinds_to_add(guesses, judge.least_gain, model)
        tried = _best(judge, [(*model, *more) for more in added])
        if tried is None:
            break
        model, residual = tried.model, tried.fit.residual
        if energy - tried.energy >= LEAST_SHARE * (energy - floor):
            best, energy, waited = tried, tried.energy, 0
        else:  # a kind may help only once another one has been added
            waited += 1
        if waited == PATIENCE:
            break
    return best


def servo_effects() -> tuple[str, ...]:
    """Names of the effects that an incomplete robot model may lack at every servo."""
    return tuple(
        name
        for name, kind in all_effects().items()
        if kind.on_every_servo and kind.place_kind in ("joint", "commands", "encoders")
    )


def _best(judge: Judge, starts: Sequence[Model]) -> Judged | None:
    """The best of some models; only that one is fitted to the end.

    Fitting and selection data are judged together: chance hardly improves the fit of
    these models, which have few values for much data, and some physics of a joint may
    show in one motion only.
    """

    def work() -> list[Judged]:
        steps = judge.rules.first_steps
        rough = fit_all(judge.fit, starts, steps, nudges_of=joint_wise)
        start = min(judge.judge(rough), key=lambda one: one.energy).model
        return judge.judge(fit_all(judge.fit, [start], nudges_of=joint_wise))

    return judge.saved(work)[0] if starts else None


def _without_idle(judge: Judge, best: Judged) -> Judged:
    """Remove effects from the joints where they do not improve the fit."""
    energies = judge.energies(without_each(best.model))
    needed = tuple(
        placed
        for placed, energy in zip(best.model, energies, strict=True)
        if energy - best.selected >= judge.least_gain
    )
    if not needed or len(needed) == len(best.model):
        return best
    lean = _best(judge, [needed])
    most = best.selected + LEAST_SHARE * (best.selected - judge.floor)
    return lean if lean is not None and lean.selected <= most else best


def kinds_to_add(guesses: Sequence[Guess], least: float, model: Model) -> list[Model]:
    """Kinds of effects worth a fit, each with the guessed effects at all joints.

    First come the kinds that gain most in total, then those that gain most for each
    value: a single delay may explain all fast motions, although friction at all joints
    gains more in the slow ones. Guesses of single effects that gain less than `least`
    [nats], or are in the `model` already, are left out.
    """
    known = {placed.key for placed in model}
    together: dict[str, tuple[float, Model]] = {}
    for guess in guesses:
        (placed,) = guess.model
        if guess.gain >= least and placed.key not in known:
            gain, every = together.get(placed.name, (0.0, ()))
            together[placed.name] = gain + guess.gain, (*every, placed)

    def for_each_value(kind: tuple[float, Model]) -> float:
        return kind[0] / sum(len(placed.values) for placed in kind[1])

    most = sorted(together.values(), key=lambda kind: -kind[0])[:TRIED]
    others = [kind for kind in together.values() if kind not in most]
    lean = sorted(others, key=lambda kind: -for_each_value(kind))[:LEAN]
    return [model for _, model in (*most, *lean)]


def joint_wise(predictor: Predictor, model: Model) -> Nudges:
    """Finite differences for `fit_all` that change a parameter at all joints at once.

    Servos are stiff, so that a change at one joint hardly moves the others: each
    joint's own channels are taken as its column of the Jacobian (columns without a
    common row need one difference only: Curtis, Powell and Reid 1974). The ignored
    coupling between joints only slows convergence; the result is unaffected.
    """
    groups: dict[tuple[str, int], list[int]] = {}
    rows: list[BoolArray] = []
    for placed in model:
        own = predictor.channels.of_joint(placed.place)
        is_joint = placed.place in predictor.plant.joints
        for k in range(len(placed.values)):
            groups.setdefault((placed.name, k), []).append(len(rows))
            rows.append(np.isin(predictor.channel, own) | (not is_joint))
    return Nudges(list(groups.values()), rows)

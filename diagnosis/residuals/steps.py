"""Finds the time steps of replays: as long as they are exact and show what they must.

The integration error is measured with short steps and taken out of replays with longer
ones, see `Predictor`. Of the model at which it was measured nothing is then wrong. What
other models change is wrong by a share that grows with the step.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import all_effects
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import STEPS_S, Model, Predictor
from diagnosis.residuals.timing.clock_at import clock_at
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.traces.split import shortened, thinned
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

MOST_WRONG = 0.25
"""Largest rms, in units of noise, of the integration error that a simulation may have
after correction; a larger error would be mistaken for missing physics."""

FINEST_S = 1.25e-4
"""Shortest step [s] with which the integration error is measured on a fixed base, where
longer ones are not enough: servos that follow a thousand commands a second, and
saturate, need it. Contacts of a floating base need far more than shorter steps."""

DISTORTED = 0.1
"""Largest error, relative to it, of what effects change in simulations whose steps are
long. Fits are repeated with the integration error of the model that they found, so that
the values that they end with do not have this error."""

STIFF = 3.0
"""Factor by which servos are stiffer than the model's in the choice of a time step."""

ROUNDS = 2
"""Times that the jitter of a clock is measured: the second time with that of whole rows
taken into account, as commands that jump early or late look like an error of the
model."""

PRECISE_S = 20.0
"""Most seconds of the recordings on which the error of the simulation is measured."""


def with_best_steps(whole: Predictor) -> Predictor:
    """The predictor with its integration error and steps as long as they may be."""
    return exact_steps(_showing_changes(whole))


def exact_steps(whole: Predictor, model: Model = ()) -> Predictor:
    """The predictor, with the integration error of a model and steps that are exact.

    The steps of its simulations stay as they are. Small mismatch of the nominal model
    is not fitted.
    """
    shortest_s = [step_s / 4 for step_s in STEPS_S[whole.plant.base]]
    if whole.plant.base == "fixed":
        shortest_s.append(FINEST_S)
    for finest_s in shortest_s:
        if finest_s < whole.finest_s:
            whole = whole.stepped(whole.step_s, finest_s)
        if finest_s == whole.finest_s and whole.correct(model).max() < MOST_WRONG:
            break
    whole.doubt(model, tolerances=False)
    return whole


def _showing_changes(whole: Predictor) -> Predictor:
    """The predictor with the longest steps with which effects change what they should.

    Effects that jump, such as dry friction, suffer most from long steps, and servos
    much stiffer than the model's oscillate with them: these are taken for all. The
    shortest step says what they should change. Steps are finer in recordings that need
    it, such as those in which servos saturate.
    """
    longest_s, *shorter_s = STEPS_S[whole.plant.base]
    if whole.by_torque or not shorter_s:
        return whole
    models = _demanding(whole)
    right = _changes(whole.stepped(shorter_s[-1]), models)
    finer = np.full(len(whole.traces), round(longest_s / shorter_s[-1]))
    for step_s in (*reversed(shorter_s[:-1]), longest_s):
        wrong = _changes(whole.stepped(step_s), models) - right
        for k in range(len(finer)):
            own = whole.trace == k
            size, error = (
                np.linalg.norm(one[:, own], axis=1) for one in (right, wrong)
            )
            usual = np.linalg.norm(right, axis=1) * np.sqrt(np.mean(own))
            if np.all(error < DISTORTED * np.maximum(size, usual)):
                finer[k] = round(longest_s / step_s)
    return whole.stepped(longest_s, finer=finer.tolist())


def _demanding(whole: Predictor) -> list[Model]:
    """Models that need short steps: dry friction, and stiff servos, everywhere."""
    plant, usage = whole.plant, Usage.of(whole.plant, whole.traces)
    rubbing = tuple(
        PlacedEffect(kind.name, place, values)
        for kind in all_effects().values()
        if kind.jumps
        for place in kind.places(plant, whole.traces)
        for values in kind.first_tries(plant, place, usage)[:1]
    )
    stiff = tuple(
        PlacedEffect(kind.name, place, (STIFF,))
        for kind in all_effects().values()
        if kind.stiffens
        for place in kind.places(plant, whole.traces)
    )
    return [one for one in (rubbing, stiff) if one]


def _changes(some: Predictor, models: Sequence[Model]) -> FloatArray:
    """(n, N) what n models change in the residual of a predictor."""
    nominal, *changed = some.residuals([(), *models])
    return np.asarray(np.array(changed).reshape(len(models), -1) - nominal)


def precise(
    plant: Plant, traces: Sequence[Trace], channels: Channels, threads: int = 1
) -> Channels:
    """The channels, whose noise includes the error of the simulation itself.

    That is what integration leaves at the shortest time step, see `Predictor`. The
    jitter of the clock is measured as well: that of whole rows at once, that of single
    channels unless it and small mismatch of the model leave much more than noise in
    most channels. Then fast errors are the model's, too.
    """
    some = thinned(plant, shortened(traces, PRECISE_S), len(channels.names))
    for step_s in STEPS_S[plant.base]:
        predictor = predictor_of(plant, some, channels, step_s, threads)
        error = predictor.correct()
        if error.max() < MOST_WRONG:
            break
    wider = np.hypot(1.0, error)
    noise, floor = channels.noise * wider, channels.floor * wider
    found = replace(channels, noise=noise, floor=floor)
    if predictor.by_torque or plant.base == "floating":
        return found
    given = found
    for _ in range(ROUNDS):
        predictor = predictor_of(plant, some, given, threads=threads)
        predictor.calibrate()
        timed, is_far_off = clock_at(predictor, (), found)
        if not (is_far_off and timed.jitter_s):
            break
        given = timed
    return timed
